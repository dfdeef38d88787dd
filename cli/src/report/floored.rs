//! The report on the floor, which keeps the worst triangles of a default run from getting worse.

use gpu_smooth::outcome::Floored;
use serde::Serialize;

use crate::report::improved::cost;
use crate::terminal::numbers::sig6;

/// The work of the floor under the worst triangles. Values are those before the run, after the last sweep, and after the
/// run, of the triangles that can move.
#[derive(Serialize)]
pub(crate) struct FlooredReport {
    /// Number of vertices that the floor moved elsewhere.
    moved: usize,
    /// Number of vertices that went back to their positions before the run.
    returned: usize,
    /// Least angle in degrees.
    least_angle: [f64; 3],
    /// Largest inverse mean ratio.
    worst_imr: [f64; 3],
    /// f after the last sweep, and after the run.
    f: [f64; 2],
}

impl From<Floored> for FlooredReport {
    fn from(Floored { moved, returned, least_angle, worst_imr, f }: Floored) -> Self {
        Self { moved, returned, least_angle, worst_imr, f }
    }
}

impl FlooredReport {
    /// Describes in one sentence which shape the sweeps had made worse, how many vertices the floor moved, and its cost in
    /// f.
    pub(crate) fn sentence(&self) -> String {
        let Self { moved, returned, least_angle, worst_imr, f } = self;
        let (mut worse, mut ends) = (Vec::new(), Vec::new());
        let degrees = |digits: usize| least_angle.map(|angle| format!("{angle:.digits$}°"));
        let [before, swept, end] = told_apart([degrees(2), degrees(9)]);
        if least_angle[1] < least_angle[0] {
            worse.push(format!("a least angle of {swept} ({before} before)"));
            ends.push(end);
        }
        let [before, swept, end] =
            told_apart([worst_imr.map(sig6), worst_imr.map(|imr| format!("{imr:.12}"))]);
        if worst_imr[1] > worst_imr[0] {
            worse.push(format!("a worst imr of {swept} ({before} before)"));
            ends.push(end);
        }
        let vertices = |n: usize| if n == 1 { "1 vertex".into() } else { format!("{n} vertices") };
        let work = match (*moved, *returned) {
            (moved, 0) => format!("{} moved on", vertices(moved)),
            (0, returned) => format!("{} went back", vertices(returned)),
            (moved, returned) => format!("{} moved on and {returned} went back", vertices(moved)),
        };
        let cost = cost(*f);
        format!(
            "the sweeps left {}; {work} to end at {}, which {cost}",
            worse.join(" and "),
            ends.join(" and ")
        )
    }
}

/// Returns the shorter texts of three numbers, or the longer ones if the first two numbers differ in further digits alone.
fn told_apart([short, long]: [[String; 3]; 2]) -> [String; 3] {
    if short[0] == short[1] { long } else { short }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_names_the_shapes_that_were_worse_and_the_cost() {
        let report = FlooredReport {
            moved: 113,
            returned: 2,
            least_angle: [30.51, 20.9, 30.61],
            worst_imr: [1.599, 1.731, 1.591],
            f: [1.1, 1.101],
        };
        assert_eq!(
            report.sentence(),
            "the sweeps left a least angle of 20.90° (30.51° before) and a worst imr of 1.731000 (1.599000 before); \
             113 vertices moved on and 2 went back to end at 30.61° and 1.591000, which changed f by +0.09 %"
        );
        let report = FlooredReport {
            moved: 1,
            returned: 0,
            worst_imr: [1.599, 1.5, 1.591],
            f: [1.1; 2],
            ..report
        };
        assert_eq!(
            report.sentence(),
            "the sweeps left a least angle of 20.90° (30.51° before); 1 vertex moved on to end at 30.61°, \
             which changed f by less than 0.01 %"
        );
        let report = FlooredReport { moved: 0, returned: 7, ..report };
        assert!(report.sentence().contains("; 7 vertices went back to end at 30.61°"));
    }
}
