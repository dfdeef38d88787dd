//! Lists of the worst elements before and after a run, with links that show each element in the mesh.

use crate::load::LoadedMesh;
use std::fmt::Write;

use gpu_smooth::Element;
use gpu_smooth::measure::{Measure, Measured};

use crate::load::{Place, as_in_file};
use crate::render::html::page::escape;
use crate::render::html::tables::{measure_name, wide};
use crate::terminal::numbers::{coordinate, fit8};

/// Largest number of elements in a list.
const LISTED: usize = 8;

/// Number of the worst elements among which movable ones are searched.
const CANDIDATES: usize = 10_000;

/// The lists: title, state (0 before the run, 1 after), and whether only movable elements are listed.
const LISTS: [(&str, usize, bool); 3] = [
    ("The worst before the run", 0, false),
    ("The worst after the run", 1, false),
    ("The worst after the run that have a free vertex", 1, true),
];

/// A triangle or quadrilateral of a list, with its values before and after the run.
pub(crate) struct WorstElement {
    pub(crate) element: Element,
    list: usize,
    /// State of the list: 0 before the run, 1 after.
    pub(crate) state: usize,
    /// The file's number or tag for the element. `place` is the element's location in the file.
    label: u64,
    place: String,
    /// Mean of the vertices in the drawn mesh, in `at_in_file` in coordinates of the file. `size` is the longest edge, in
    /// units of the mesh.
    pub(crate) at: [f64; 2],
    at_in_file: [f64; 2],
    pub(crate) size: f64,
    /// The ranking measure and the smallest angle in degrees, before and after the run.
    values: [[f64; 2]; 2],
    can_move: bool,
}

/// Finds the worst elements by shape. Movable elements have a list of their own if the overall list also has fixed
/// ones.
pub(crate) fn spots(file: &LoadedMesh, states: [&Measured<'_>; 2]) -> Vec<WorstElement> {
    let topology = states[0].topology();
    let mut listed = Vec::new();
    for (list, &(_, state, only_movable)) in LISTS.iter().enumerate() {
        let most = if only_movable { CANDIDATES } else { LISTED };
        let found = states[state].worst(Measure::Shape, most).into_iter().map(|found| found.0);
        let found = found.map(|index| states[state].element(index));
        let found: Vec<Element> = found
            .filter(|&element| !only_movable || topology.can_move(element))
            .take(LISTED)
            .collect();
        let is_new = listed.iter().all(|(_, known)| *known != found || !only_movable);
        if is_new {
            listed.push((list, found));
        }
    }
    let listed: Vec<(usize, Element)> =
        listed.iter().flat_map(|(list, found)| found.iter().map(|&e| (*list, e))).collect();
    located(file, states, Measure::Shape, &listed)
}

/// Finds the worst elements of one mesh by a measure.
pub(crate) fn spots_of_mesh(
    file: &LoadedMesh,
    measured: &Measured<'_>,
    measure: Measure,
    count: usize,
) -> Vec<WorstElement> {
    let found = measured.worst(measure, count).into_iter();
    let listed: Vec<(usize, Element)> =
        found.map(|(index, _)| (0, measured.element(index))).collect();
    located(file, [measured; 2], measure, &listed)
}

/// Measures and locates elements, each given with the index of its list.
fn located(
    file: &LoadedMesh,
    states: [&Measured<'_>; 2],
    measure: Measure,
    listed: &[(usize, Element)],
) -> Vec<WorstElement> {
    let topology = states[0].topology();
    let elements: Vec<Element> = listed.iter().map(|(_, element)| *element).collect();
    let places = Place::of_elements(&file.source, &elements);
    let spot = |(&(list, element), place): (&(usize, Element), Place)| {
        let state = LISTS[list].1;
        let corners = file.corners(element);
        let points: Vec<[f64; 2]> =
            corners.iter().map(|&v| states[state].points()[v as usize]).collect();
        let length = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
        let ends = points.iter().zip(points.iter().cycle().skip(1));
        let measures = [measure, Measure::MinAngle];
        let place = place.location();
        let count = points.len() as f64;
        let at = [0, 1].map(|axis| points.iter().map(|point| point[axis] / count).sum());
        let index = topology.place(element);
        WorstElement {
            element,
            list,
            state,
            label: place.id,
            place: place.to_string(),
            at,
            at_in_file: as_in_file(file, at),
            size: ends.map(|(&p, &q)| length(p, q)).fold(0.0, f64::max),
            values: states.map(|state| measures.map(|measure| state.value(measure, index))),
            can_move: topology.can_move(element),
        }
    };
    listed.iter().zip(places).map(spot).collect()
}

/// The words for the elements of a list.
struct Words {
    /// The heading of the column of numbers.
    one: &'static str,
    several: &'static str,
    /// Whether a table writes the kind beside each number, since the list has both kinds.
    names_kinds: bool,
}

impl Words {
    fn of(spots: &[WorstElement]) -> Self {
        let is_triangle = |spot: &WorstElement| matches!(spot.element, Element::Triangle(_));
        match (spots.iter().all(is_triangle), spots.iter().any(is_triangle)) {
            (true, _) => Self { one: "triangle", several: "Triangles", names_kinds: false },
            (_, false) => {
                Self { one: "quadrilateral", several: "Quadrilaterals", names_kinds: false }
            }
            _ => Self { one: "element", several: "Elements", names_kinds: true },
        }
    }

    /// Returns the name of an element in a table.
    fn label(&self, spot: &WorstElement) -> String {
        match spot.element {
            _ if !self.names_kinds => spot.label.to_string(),
            Element::Triangle(_) => format!("triangle {}", spot.label),
            Element::Quadrilateral(_) => format!("quadrilateral {}", spot.label),
        }
    }
}

/// Returns the title of the lists.
pub(crate) fn title(spots: &[WorstElement]) -> String {
    format!("Worst {}", Words::of(spots).several.to_lowercase())
}

/// Writes the worst elements of one mesh, found by `measure`, as an HTML table. `axes` are the names of the coordinates.
/// With `links`, each element has a link that shows it in the viewer.
pub(crate) fn list_of_mesh(
    spots: &[WorstElement],
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
    let words = Words::of(spots);
    let mut text = format!(
        "<div class=\"lists\">{}<table><caption>The worst by {measure}</caption><thead><tr><th>{}</th>",
        wide(&format!("the worst by {measure}")),
        words.one
    );
    for measure in &measures[..shown] {
        let _ = write!(text, "<th>{}</th>", escape(&measure_name(*measure)));
    }
    let _ = write!(text, "<th>{a}</th><th>{b}</th></tr></thead><tbody>");
    for (i, spot) in spots.iter().enumerate() {
        let WorstElement { place, at_in_file, size, can_move, .. } = spot;
        let label = words.label(spot);
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
    let Words { one, several, .. } = words;
    let _ = write!(
        text,
        "</tbody></table></div></div><p>{several} marked as fixed have no vertex that may move."
    );
    if links {
        let _ = write!(text, " Click {} {one} to see it in the mesh.", article(one));
    }
    text + "</p>"
}

/// Writes the lists as HTML tables. `axes` are the names of the coordinates.
pub(crate) fn lists(spots: &[WorstElement], [a, b]: [&str; 2]) -> String {
    let words = Words::of(spots);
    let mut text = String::from("<div class=\"lists\">");
    for (list, (title, ..)) in LISTS.iter().enumerate() {
        let of_list = || spots.iter().enumerate().filter(|(_, spot)| spot.list == list);
        if of_list().next().is_none() {
            continue;
        }
        let _ = write!(
            text,
            "{}<table><caption>{title}</caption><thead><tr><th>{}</th>\
             <th colspan=\"2\">shape</th><th colspan=\"2\">min angle</th><th>{a}</th><th>{b}</th></tr></thead><tbody>",
            wide(title),
            words.one
        );
        for (i, spot) in of_list() {
            let WorstElement { place, at_in_file: [x, y], can_move, .. } = spot;
            let label = words.label(spot);
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
    let Words { one, several, .. } = words;
    let _ = write!(
        text,
        "</div><p>Click {} {one} to see it in the mesh. {several} marked as fixed have no vertex that may move.</p>",
        article(one)
    );
    text
}

/// Returns the indefinite article of a word for an element.
fn article(word: &str) -> &'static str {
    if word.starts_with('e') { "an" } else { "a" }
}
