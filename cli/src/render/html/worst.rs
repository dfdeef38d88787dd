//! Lists of the worst triangles before and after a run, with links that show each triangle in the mesh.

use crate::load::LoadedMesh;
use std::fmt::Write;

use gpu_smooth::Element;
use gpu_smooth::measure::{Measure, Measured};

use crate::load::as_in_file;
use crate::render::html::page::escape;
use crate::render::html::tables::{measure_name, wide};
use crate::terminal::numbers::{coordinate, fit8};

/// Largest number of triangles in a list.
const LISTED: usize = 8;

/// Number of the worst triangles among which movable ones are searched.
const CANDIDATES: usize = 10_000;

/// The lists: title, state (0 before the run, 1 after), and whether only movable triangles are listed.
const LISTS: [(&str, usize, bool); 3] = [
    ("The worst before the run", 0, false),
    ("The worst after the run", 1, false),
    ("The worst after the run that have a free vertex", 1, true),
];

/// A triangle in one of the lists, measured before or after the run.
pub(crate) struct WorstTriangle {
    /// Index of the triangle in the mesh.
    pub(crate) triangle: usize,
    list: usize,
    /// State of the list: 0 before the run, 1 after.
    pub(crate) state: usize,
    /// The file's number or tag for the triangle. `place` is the triangle's location in the file.
    label: u64,
    place: String,
    /// Centroid of the triangle in the drawn mesh, in `at_in_file` in coordinates of the file. `size` is the longest
    /// edge, in units of the mesh.
    pub(crate) at: [f64; 2],
    at_in_file: [f64; 2],
    pub(crate) size: f64,
    /// The ranking measure and the smallest angle in degrees, before and after the run.
    values: [[f64; 2]; 2],
    can_move: bool,
}

/// Finds the worst triangles by shape. Movable triangles have a list of their own if the overall list also has fixed
/// ones.
pub(crate) fn spots(file: &LoadedMesh, states: [&Measured<'_>; 2]) -> Vec<WorstTriangle> {
    let topology = states[0].topology();
    let mut listed = Vec::new();
    for (list, &(_, state, only_movable)) in LISTS.iter().enumerate() {
        let most = if only_movable { CANDIDATES } else { LISTED };
        let found = states[state].worst(Measure::Shape, most).into_iter().map(|found| found.0);
        let found = found.filter(|&index| index < topology.triangles().len());
        let found: Vec<usize> = found
            .filter(|&t| !only_movable || topology.can_move(Element::Triangle(t)))
            .take(LISTED)
            .collect();
        let is_new = listed.iter().all(|(_, known)| *known != found || !only_movable);
        if is_new {
            listed.push((list, found));
        }
    }
    let listed: Vec<(usize, usize)> =
        listed.iter().flat_map(|(list, found)| found.iter().map(|&t| (*list, t))).collect();
    located(file, states, Measure::Shape, &listed)
}

/// Finds the worst triangles of one mesh by a measure.
pub(crate) fn spots_of_mesh(
    file: &LoadedMesh,
    measured: &Measured<'_>,
    measure: Measure,
    count: usize,
) -> Vec<WorstTriangle> {
    let mut found = measured.worst(measure, count);
    found.retain(|&(index, _)| index < measured.topology().triangles().len());
    let listed: Vec<(usize, usize)> = found.into_iter().map(|(t, _)| (0, t)).collect();
    located(file, [measured; 2], measure, &listed)
}

/// Measures and locates triangles, each given with the index of its list.
fn located(
    file: &LoadedMesh,
    states: [&Measured<'_>; 2],
    measure: Measure,
    listed: &[(usize, usize)],
) -> Vec<WorstTriangle> {
    let topology = states[0].topology();
    let places = file.source.triangle_locations(listed.iter().map(|(_, triangle)| *triangle));
    let spot = |&(list, triangle): &(usize, usize)| {
        let state = LISTS[list].1;
        let corners = topology.triangles()[triangle];
        let [p, q, r] = corners.map(|v| states[state].points()[v as usize]);
        let length = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
        let measures = [measure, Measure::MinAngle];
        let place = &places[&triangle];
        let at = [0, 1].map(|axis| p[axis] / 3.0 + q[axis] / 3.0 + r[axis] / 3.0);
        WorstTriangle {
            triangle,
            list,
            state,
            label: place.id,
            place: place.to_string(),
            at,
            at_in_file: as_in_file(file, at),
            size: length(p, q).max(length(q, r)).max(length(r, p)),
            values: states.map(|state| measures.map(|measure| state.value(measure, triangle))),
            can_move: topology.can_move(Element::Triangle(triangle)),
        }
    };
    listed.iter().map(spot).collect()
}

/// Writes the worst triangles of one mesh, found by `measure`, as an HTML table. `axes` are the names of the coordinates.
/// With `links`, each triangle has a link that shows it in the viewer.
pub(crate) fn list_of_mesh(
    spots: &[WorstTriangle],
    measure: Measure,
    [a, b]: [&str; 2],
    links: bool,
) -> String {
    if spots.is_empty() {
        return String::new();
    }
    let measures = [measure, Measure::MinAngle];
    // The least angle is not listed twice.
    let shown = if measure == Measure::MinAngle { 1 } else { 2 };
    let mut text = format!(
        "<div class=\"lists\">{}<table><caption>The worst by {measure}</caption><thead><tr><th>triangle</th>",
        wide(&format!("the worst by {measure}"))
    );
    for measure in &measures[..shown] {
        let _ = write!(text, "<th>{}</th>", escape(&measure_name(*measure)));
    }
    let _ = write!(text, "<th>{a}</th><th>{b}</th></tr></thead><tbody>");
    for (i, spot) in spots.iter().enumerate() {
        let WorstTriangle { label, place, at_in_file, size, can_move, .. } = spot;
        let held = if *can_move { "" } else { " (fixed)" };
        let title = escape(place);
        let _ = match links {
            true => write!(
                text,
                "<tr><td><a href=\"#spot-{i}\" title=\"{title}\">{label}</a>{held}</td>"
            ),
            false => write!(text, "<tr><td><span title=\"{title}\">{label}</span>{held}</td>"),
        };
        let numbers = spot.values[0][..shown].iter().map(|value| fit8(*value));
        for number in numbers.chain(at_in_file.iter().map(|x| coordinate(*x, *size))) {
            let _ = write!(text, "<td>{number}</td>");
        }
        text += "</tr>";
    }
    text +=
        "</tbody></table></div></div><p>Triangles marked as fixed have no vertex that may move.";
    text + if links { " Click a triangle to see it in the mesh.</p>" } else { "</p>" }
}

/// Writes the lists as HTML tables. `axes` are the names of the coordinates.
pub(crate) fn lists(spots: &[WorstTriangle], [a, b]: [&str; 2]) -> String {
    let mut text = String::from("<div class=\"lists\">");
    for (list, (title, ..)) in LISTS.iter().enumerate() {
        let of_list = || spots.iter().enumerate().filter(|(_, spot)| spot.list == list);
        if of_list().next().is_none() {
            continue;
        }
        let _ = write!(
            text,
            "{}<table><caption>{title}</caption><thead><tr><th>triangle</th>\
             <th colspan=\"2\">shape</th><th colspan=\"2\">min angle</th><th>{a}</th><th>{b}</th></tr></thead><tbody>",
            wide(title)
        );
        for (i, spot) in of_list() {
            let WorstTriangle { label, place, at_in_file: [x, y], can_move, .. } = spot;
            let [before, after] = spot.values;
            let held = if *can_move { "" } else { " (fixed)" };
            let _ = write!(
                text,
                "<tr><td><a href=\"#spot-{i}\" title=\"{}\">{label}</a>{held}</td><td>{}</td><td>→ {}</td><td>{}°</td><td>→ {}°</td><td>{}</td><td>{}</td></tr>",
                escape(place),
                fit8(before[0]),
                fit8(after[0]),
                fit8(before[1]),
                fit8(after[1]),
                coordinate(*x, spot.size),
                coordinate(*y, spot.size),
            );
        }
        text += "</tbody></table></div>";
    }
    text + "</div><p>Click a triangle to see it in the mesh. Triangles marked as fixed have no vertex that may move.</p>"
}
