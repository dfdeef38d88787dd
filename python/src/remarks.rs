//! Remarks on a mesh and a run, in words of Python's keywords.

use gpu_smooth::layers::{KeepLayers, Layers};
use gpu_smooth::options::WorstBy;
use gpu_smooth::outcome::{Floored, Improved, LargeAngles};
use gpu_smooth::targets::OutsideReport;
use gpu_smooth::topology::HangingNode;
use gpu_smooth::{Mesh, Metric, Outcome, Smoother};
use gpu_smooth_job::{
    Adapted, RiseReason, TargetFacts, WorstEffect, WorstRise, cost_in_percent, vertices_in_rows,
};

use crate::observer::RunObserver;

/// Collects the remarks on a mesh and a run. Remarks that a user must read are warnings too.
pub(crate) struct Remarks<'a> {
    observer: &'a RunObserver<'a>,
    texts: Vec<String>,
}

impl<'a> Remarks<'a> {
    pub(crate) fn new(observer: &'a RunObserver<'a>) -> Self {
        Self { observer, texts: Vec::new() }
    }

    /// Returns all remarks, also those that were warnings.
    pub(crate) fn into_texts(self) -> Vec<String> {
        self.texts
    }

    /// Returns the number of remarks so far.
    pub(crate) fn count(&self) -> usize {
        self.texts.len()
    }

    fn add(&mut self, text: String) {
        self.texts.push(text);
    }

    /// Adds a remark and issues it as a warning.
    pub(crate) fn warn(&mut self, text: String) {
        self.observer.warn(&text);
        self.texts.push(text);
    }

    /// Warns of pairs of `lines` that are no edges: `line` in the row `row`, and `others` further pairs.
    pub(crate) fn stray_lines(&mut self, row: usize, [a, b]: [u32; 2], others: usize) {
        let (further, vertices) = match others {
            0 => (String::new(), "Both vertices stay"),
            1 => (", and 1 more pair is no edge".to_owned(), "The vertices of both pairs stay"),
            n => (format!(", and {n} more pairs are no edges"), "The vertices of these pairs stay"),
        };
        self.warn(format!(
            "lines[{row}]: no edge of the mesh joins vertices {a} and {b}{further}. {vertices}, and do not slide along such a \
             line. Pass edges of elements"
        ));
    }

    /// Warns of pairs of `periodic` with a vertex that is on no line: the pair in the row `row` with `vertex`, and `others`
    /// further pairs.
    pub(crate) fn pairs_inside(&mut self, row: usize, vertex: u32, others: usize) {
        let further = match others {
            0 => "The pair does not slide",
            1 => "This pair and 1 more do not slide",
            n => &format!("This pair and {n} more do not slide"),
        };
        self.warn(format!(
            "periodic[{row}]: vertex {vertex} is inside the mesh, and on no line. {further}. Pass pairs of vertices on the \
             boundary, on lines or between regions"
        ));
    }

    /// Warns of vertices that could slide, `count` in number, but stay because of their pairs.
    pub(crate) fn stuck_pairs(&mut self, count: usize) {
        if count > 0 {
            let stay = numbered(count, "vertex stays", "vertices stay");
            self.warn(format!(
                "periodic: {stay} that could slide without pairs. Both vertices of a pair stay if one of them is a corner, \
                 fixed or in two pairs, or if their neighbors along the lines are no pairs"
            ));
        }
    }

    /// Remarks on vertices that are fixed because they lie between regions.
    pub(crate) fn interfaces(&mut self, count: usize) {
        if count > 0 {
            let stay =
                numbered(count, "vertex between regions stays", "vertices between regions stay");
            self.add(format!("regions: {stay}. Pass slide=True to let them slide, or no regions"));
        }
    }

    /// Remarks on bad elements of a mesh, `bad` in number, near which `free` of `of_all` free vertices move.
    pub(crate) fn only_bad(
        &mut self,
        limit: f64,
        bad: usize,
        [free, of_all]: [usize; 2],
        mesh: &Mesh,
    ) {
        let [one, many] = nouns(mesh);
        let are = numbered(bad, &format!("{one} is"), &format!("{many} are"));
        self.add(format!(
            "only_bad: {are} above an inverse mean ratio of {limit}, and {free} of {of_all} free vertices may move"
        ));
    }

    /// Remarks on boundary layers that stay.
    pub(crate) fn layers(&mut self, layers: &Layers, keep: KeepLayers) {
        if layers.vertices.is_empty() {
            return;
        }
        let place = match (keep, layers.rows) {
            (KeepLayers::Within(distance), _) => format!("within {distance} of walls"),
            (_, 1) => "in 1 row at walls".to_owned(),
            (_, rows) => format!("in {rows} rows at walls"),
        };
        let count = vertices_in_rows(layers);
        let (vertices, stay) = if count == 1 { ("vertex", "stays") } else { ("vertices", "stay") };
        self.add(format!(
            "keep_layers: {count} {vertices} {place} {stay}. Pass keep_layers=\"none\" to let them move"
        ));
    }

    /// Remarks on walls at which layers may begin, and none was found.
    pub(crate) fn overlooked_layers(&mut self) {
        self.add(
            "keep_layers: the triangles at the boundary are flat like those of a boundary layer, but no layer was found. Pass \
             keep_layers=\"rows=N\" to keep the first N rows"
                .to_owned(),
        );
    }

    /// Warns that the points seem to be longitudes and latitudes.
    pub(crate) fn degrees(&mut self) {
        self.warn(
            "points: the coordinates look like degrees. Pass surface=\"sphere\" if they are longitude and latitude, or \
             surface=\"plane\" if they are lengths"
                .to_owned(),
        );
    }

    /// Warns of an adapted mesh, which the run will make less adapted.
    pub(crate) fn adapted(&mut self, adapted: Adapted) {
        self.warn(match adapted {
            Adapted::Stretched(stretching) => format!(
                "points: the mesh is adapted: around one vertex in twenty, elements are stretched {stretching:.1}-fold or \
                 more. They become equilateral or square unless target=\"keep-shape\" keeps their stretching and sizes"
            ),
            Adapted::Graded(gradation) => format!(
                "points: the mesh is graded: sizes differ {gradation:.0}-fold from fine to coarse parts. They become more \
                 even unless target=\"keep-size\" keeps them"
            ),
        });
    }

    /// Remarks on vertices outside of a background, and on the weight of sizes.
    pub(crate) fn targets(&mut self, facts: &TargetFacts) {
        if let Some(OutsideReport { count: count @ 1.., most }) = facts.outside {
            let are = numbered(count, "vertex is", "vertices are");
            self.add(format!(
                "target: {are} outside of the other mesh, by up to {most:.6}. These vertices take the target of the nearest \
                 point of that mesh"
            ));
        }
        if let Some(weight) = facts.size_weight.filter(|weight| *weight > 1.0) {
            self.add(format!(
                "target=\"keep-size\": the triangles are stretched, so that the metric's term of size has a weight of \
                 {weight:.2}, which keeps the sizes. target=\"keep-shape\" keeps the stretching too"
            ));
        }
    }

    /// Remarks on the vertices that may slide, `count` in number. Warns of pairs that stay, and of a boundary that stays
    /// because its pairs are lost.
    pub(crate) fn sliding(&mut self, smoother: &Smoother<'_>, count: usize, has_lost_pairs: bool) {
        let ([pairs, unlike], [together, alone]) = (smoother.pairs(), smoother.coincident());
        let mut text = match count {
            0 => "slide: no vertex can slide, as all on lines are corners or held".to_owned(),
            _ => {
                let may = numbered(count, "vertex", "vertices");
                format!("slide: {may} on the boundary and other lines may slide")
            }
        };
        let mut clause = |count: usize, one: &str, many: &str| {
            if count > 0 {
                text += &format!(", {} of them in {}", 2 * count, numbered(count, one, many));
            }
        };
        clause(pairs, "periodic pair", "periodic pairs");
        clause(together, "pair at the same place", "pairs at the same place");
        if alone > 0 {
            let stay = numbered(alone, "vertex", "vertices");
            text += &format!("; of vertices at one place, {stay} cannot slide");
        }
        self.add(text);
        if unlike > 0 {
            let stay = numbered(unlike, "pair stays", "pairs stay");
            self.warn(format!(
                "periodic: {stay}, as the translation or rotation of the other pairs does not take one vertex to the other"
            ));
        }
        if has_lost_pairs {
            self.warn(
                "slide: the boundary stays, as the model is periodic and the pairs of vertices are unknown. Pass them as \
                 periodic"
                    .to_owned(),
            );
        }
    }

    /// Remarks on the end of a run: vertices that were held back, worst triangles that were made better again, and a device
    /// that failed.
    pub(crate) fn outcome(&mut self, outcome: &Outcome, mesh: &Mesh) {
        if outcome.held_back > 0 {
            let held = numbered(outcome.held_back, "vertex", "vertices");
            self.add(format!("a guard keeps {held} from moving on"));
        }
        if let Some(Floored { moved, returned, least_angle, worst_imr, f }) = outcome.floored {
            let (mut worse, mut ends) = (Vec::new(), Vec::new());
            let [before, swept, end] = least_angle;
            if swept < before {
                worse.push(format!("a least angle of {swept:.2}° ({before:.2}° before)"));
                ends.push(format!("{end:.2}°"));
            }
            let [before, swept, end] = worst_imr;
            if swept > before {
                worse.push(format!("a worst imr of {swept:.6} ({before:.6} before)"));
                ends.push(format!("{end:.6}"));
            }
            let vertices = numbered(moved + returned, "vertex", "vertices");
            self.add(format!(
                "the sweeps left {}. {vertices} moved on or went back, to end at {}, which {}",
                worse.join(" and "),
                ends.join(" and "),
                cost(f)
            ));
        }
        if let Some(LargeAngles { moved, triangles, obtuse: [were, are], f, .. }) =
            outcome.large_angles
        {
            let [before, after] = triangles;
            let (triangles, cost) = (numbered(before, "triangle", "triangles"), cost(f));
            let vertices = numbered(moved, "vertex", "vertices");
            self.add(format!(
                "the sweeps left {triangles} with an angle above 87.1°, {were} of them obtuse. {vertices} moved on to \
                 end with {after}, {are} of them obtuse, which {cost}"
            ));
        }
        if let Some(improved) = &outcome.improved {
            self.add(worst_improved(improved, mesh));
        }
        if let Some(fault) = &outcome.device_fault {
            let (sweep, error) = (fault.sweep, &fault.error);
            self.add(format!(
                "the GPU failed after sweep {sweep}, and the run continued on the CPU: {error}"
            ));
        }
    }
}

/// Returns a remark on vertices that hang on edges of other triangles; `None` without hanging nodes. `owner` returns the
/// vertex of the call.
pub(crate) fn hanging(nodes: &[HangingNode], owner: impl Fn(u32) -> u32) -> Option<String> {
    let HangingNode { vertex, edge } = *nodes.first()?;
    let [a, b] = edge.map(&owner);
    let (such, nodes) = match nodes.len() {
        1 => ("", "1 hanging node".to_owned()),
        n => ("such as ", format!("{n} hanging nodes")),
    };
    Some(format!(
        "points: {nodes}: {such}vertex {} is inside the edge between vertices {} and {}. The mesh is open there, and both \
         sides stay as boundary. Cut the triangles at such edges in two",
        owner(vertex),
        a.min(b),
        a.max(b)
    ))
}

/// Returns a remark on the worst element of a mesh, which a run by the base metric `base` made worse.
pub(crate) fn worst_rise(rise: WorstRise, base: Metric, mesh: &Mesh) -> String {
    let [before, after] = rise.worst;
    let [one, many] = nouns(mesh);
    let mean = format!("f is a mean, which may fall as one {one} gets worse.");
    let remedy = match rise.reason {
        RiseReason::JudgesNoShape => {
            let base = base.name();
            format!("{base} does not judge shapes. scheme=\"imr\" and scheme=\"{base}+imr\" do")
        }
        RiseReason::GuardsTargets => {
            format!("{mean} guard=\"worst\" bounds {many} as the target transforms them")
        }
        RiseReason::GuardsUnrounded => format!(
            "{mean} guard=\"worst\" bounds {many} before points are rounded to the type of their array"
        ),
        _ => format!("{mean} Pass guard=\"worst\" to prevent it"),
    };
    format!("worst imr of movable {many} rose from {before:.6} to {after:.6}: {remedy}")
}

/// Returns a remark on the improvement of the worst elements of a mesh.
fn worst_improved(improved: &Improved, mesh: &Mesh) -> String {
    let [one, many] = nouns(mesh);
    let Improved { by, vertices, worst, stuck, f } = *improved;
    let name = match by {
        WorstBy::Imr => "worst imr".to_owned(),
        by => format!("least {}", by.name().trim_start_matches("min-")),
    };
    let [before, after] = worst.map(|value| match by {
        WorstBy::MinAngle => format!("{value:.2}°"),
        _ => format!("{value:.6}"),
    });
    let (moved, cost) = (numbered(vertices, "vertex", "vertices"), cost(f));
    let text = match WorstEffect::of(vertices, worst) {
        WorstEffect::Nothing => {
            format!("the {name} of movable {many}, {after}, could not be improved")
        }
        WorstEffect::Worst => format!(
            "the {name} of movable {many} was improved from {before} to {after} by {moved}, which {cost}"
        ),
        WorstEffect::Others => format!(
            "the {name} of movable {many} stays {after}. Others were improved by {moved}, which {cost}"
        ),
    };
    let worse = match stuck {
        0 => String::new(),
        1 => format!(". 1 {one} is worse, and all its corners are fixed"),
        n => format!(". {n} {many} are worse, and all their corners are fixed"),
    };
    format!("improve_worst: {text}{worse}")
}

/// Returns the words for one and for several elements of a mesh.
fn nouns(mesh: &Mesh) -> [&'static str; 2] {
    match mesh.quadrilaterals.is_empty() {
        true => ["triangle", "triangles"],
        false => ["element", "elements"],
    }
}

/// Describes the change of f, as the end of a sentence.
fn cost(f: [f64; 2]) -> String {
    match cost_in_percent(f) {
        None => "changed f by less than 0.01 %".to_owned(),
        Some(change) => format!("changed f by {change:+.2} %"),
    }
}

/// Formats a count with words in the singular or plural.
fn numbered(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
