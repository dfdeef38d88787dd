//! The report on large angles after the sweeps of a run by ACUTE.

use gpu_smooth::outcome::LargeAngles;
use serde::Serialize;

use crate::report::improved::cost;

/// The work on large angles. Pairs hold numbers after the last sweep and at the end of the run.
#[derive(Serialize)]
pub(crate) struct LargeAnglesReport {
    /// Number of vertices that moved after the sweeps.
    moved: usize,
    /// Number of triangles that can move and have an angle above 87.1 degrees.
    triangles: [usize; 2],
    /// Number of these triangles that are obtuse.
    obtuse: [usize; 2],
    f: [f64; 2],
}

impl From<LargeAngles> for LargeAnglesReport {
    fn from(LargeAngles { moved, triangles, obtuse, f, .. }: LargeAngles) -> Self {
        Self { moved, triangles, obtuse, f }
    }
}

impl LargeAnglesReport {
    /// Describes in one sentence how many triangles had a large angle, how many vertices moved, and the cost in f.
    pub(crate) fn sentence(&self) -> String {
        let Self { moved, triangles: [before, after], obtuse: [were, are], f } = *self;
        let triangles = if before == 1 { "triangle" } else { "triangles" };
        let vertices = if moved == 1 { "vertex" } else { "vertices" };
        let cost = cost(f);
        format!(
            "the sweeps left {before} {triangles} with an angle above 87.1°, {were} of them obtuse; {moved} {vertices} \
             moved on to end with {after}, {are} of them obtuse, which {cost}"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_counts_triangles_and_vertices() {
        let report =
            LargeAnglesReport { moved: 240, triangles: [31, 1], obtuse: [12, 0], f: [1.1, 1.101] };
        assert_eq!(
            report.sentence(),
            "the sweeps left 31 triangles with an angle above 87.1°, 12 of them obtuse; 240 vertices moved on to end \
             with 1, 0 of them obtuse, which changed f by +0.09 %"
        );
    }
}
