//! The rule by which one of the tried runs is the best.

use crate::report::Report;

/// Largest distance that 19 of 20 vertices move in a run that keeps the mesh, in mean lengths of the edges around each
/// vertex. A vertex that moves farther is nearer to the old position of a neighbor than to its own, so that refined
/// places move away from the coast or the wall for which they are refined.
pub(super) const MAX_MOVE: f64 = 0.5;
/// Largest factor by which 19 of 20 vertices change the size of the elements around them in a run that keeps the mesh.
pub(super) const MAX_SIZE_CHANGE: f64 = 1.25;
/// Two values of the worst imr within this factor count as equal.
const EQUAL: f64 = 1.01;
/// Share by which rounding may change the least angle or the worst imr of a mesh that keeps its worst element.
const ROUNDING: f64 = 1e-9;
/// If no run keeps the mesh, the best is one of the runs that move vertices at most this many times as far as any run.
pub(super) const ABOUT_LEAST: f64 = 1.1;

/// The best of the tried runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Best {
    /// Index of the run.
    pub(super) row: usize,
    /// Whether the best run keeps the mesh. False if no run keeps the mesh.
    pub(super) keeps_mesh: bool,
}

/// The values of a run on which the rule depends.
#[derive(Clone, Copy)]
pub(super) struct Gains {
    /// f by imr, before and after.
    f: [f64; 2],
    /// The least angle of the mesh before and after the run, in degrees.
    least_angle: [f64; 2],
    /// The worst inverse mean ratio of the triangles with a free vertex, before and after.
    worst_imr: [f64; 2],
    /// Values that 19 of 20 vertices do not exceed: the move in lengths of an edge, and the factor of sizes.
    moved: f64,
    size: f64,
    /// Numbers of parts of the mesh beyond limits that fail and that warn, before and after; `None` without a profile.
    beyond: Option<[[usize; 2]; 2]>,
}

impl From<&Report> for Gains {
    fn from(report: &Report) -> Self {
        Self {
            f: [report.before.f["imr"], report.after.f["imr"]],
            least_angle: [report.before.min_angle, report.after.min_angle],
            worst_imr: [report.before.worst_movable_imr, report.after.worst_movable_imr],
            moved: report.change.moved.p95,
            size: report.change.size.p95,
            beyond: (report.profile.as_ref())
                .map(|profile| [profile.before.beyond(), profile.after.beyond()]),
        }
    }
}

impl Gains {
    /// Returns whether the run has fewer parts of the mesh beyond limits, or makes the mesh better in some way and the worst
    /// element no worse: neither the least angle nor the worst imr.
    pub(super) fn helps(self) -> bool {
        let Self { f, least_angle: angle, worst_imr: imr, beyond, .. } = self;
        if beyond.is_some_and(|[before, after]| after < before) {
            return true;
        }
        let keeps_worst =
            angle[1] >= angle[0] * (1.0 - ROUNDING) && imr[1] <= imr[0] * (1.0 + ROUNDING);
        keeps_worst && (f[1] < f[0] || angle[1] > angle[0] || imr[1] < imr[0])
    }

    /// Returns whether the run lowers f, and leaves sizes and positions about as they are.
    pub(super) fn keeps_mesh(self) -> bool {
        let lowers = self.f[1] <= self.f[0];
        lowers && self.moved <= MAX_MOVE && self.size <= MAX_SIZE_CHANGE
    }
}

/// Leaves out the runs with more parts of the mesh beyond limits than others that help: the rest has the fewest that fail, and
/// of these runs about the fewest that warn (within 10 %). Leaves all runs without a profile.
pub(super) fn within_limits(runs: &[Option<Gains>]) -> Vec<Option<Gains>> {
    let helping = || runs.iter().flatten().filter(|gains| gains.helps());
    let beyond = || helping().filter_map(|gains| gains.beyond.map(|[_, after]| after));
    let fewest = beyond().map(|[failed, _]| failed).min();
    let of_fewest = beyond().filter(|[failed, _]| Some(*failed) == fewest);
    let warned = of_fewest.map(|[_, warned]| warned).min().unwrap_or_default() as f64;
    let is_left = |gains: &Gains| {
        gains.beyond.is_none_or(|[_, [failed, warns]]| {
            Some(failed) == fewest && warns as f64 <= ABOUT_LEAST * warned
        })
    };
    runs.iter().map(|gains| gains.filter(is_left)).collect()
}

/// Returns the best of the runs that help, or `None` if no run helps. A run that failed is `None` in the list. Of the runs
/// that keep the mesh, or of those that move vertices about as little as any, the best has the least worst imr, and if
/// several are within 1 % of it, the least f.
pub(super) fn best(runs: &[Option<Gains>]) -> Option<Best> {
    let helping = |(row, gains): (usize, &Option<Gains>)| {
        gains.filter(|gains| gains.helps()).map(|gains| (row, gains))
    };
    let helping: Vec<(usize, Gains)> = runs.iter().enumerate().filter_map(helping).collect();
    let keeps_mesh = helping.iter().any(|(_, gains)| gains.keeps_mesh());
    let least_move = least(helping.iter().map(|(_, gains)| gains.moved));
    let is_candidate = |gains: &Gains| match keeps_mesh {
        true => gains.keeps_mesh(),
        false => gains.moved <= ABOUT_LEAST * least_move,
    };
    let candidates = || helping.iter().filter(|(_, gains)| is_candidate(gains));
    let least_imr = least(candidates().map(|(_, gains)| gains.worst_imr[1]));
    let equal = candidates().filter(|(_, gains)| gains.worst_imr[1] <= EQUAL * least_imr);
    let (row, _) = equal.min_by(|(_, a), (_, b)| a.f[1].total_cmp(&b.f[1]))?;
    Some(Best { row: *row, keeps_mesh })
}

fn least(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gains(f: f64, worst_imr: f64, moved: f64, size: f64) -> Option<Gains> {
        let worst_imr = [2.0, worst_imr];
        Some(Gains { f: [1.3, f], least_angle: [20.0; 2], worst_imr, moved, size, beyond: None })
    }

    fn row(runs: &[Option<Gains>]) -> Option<(usize, bool)> {
        best(runs).map(|best| (best.row, best.keeps_mesh))
    }

    #[test]
    fn the_best_run_has_the_least_worst_imr_of_those_that_keep_the_mesh() {
        let far = gains(1.1, 1.2, 0.7, 1.1);
        let coarse = gains(1.1, 1.2, 0.3, 1.3);
        let rising = gains(1.4, 1.2, 0.3, 1.1);
        let (good, better) = (gains(1.20, 1.500, 0.2, 1.1), gains(1.21, 1.490, 0.2, 1.1));
        assert_eq!(row(&[far, coarse, rising, good]), Some((3, true)));
        // The values of imr are within 1 %, so f decides.
        assert_eq!(row(&[far, better, good]), Some((2, true)));
        assert_eq!(row(&[gains(1.20, 1.6, 0.2, 1.1), better, None]), Some((1, true)));
        // The first of equal rows has the fewest options.
        assert_eq!(row(&[good, good]), Some((0, true)));
    }

    #[test]
    fn a_run_that_moves_vertices_little_is_best_if_none_keeps_the_mesh() {
        let far = gains(1.1, 1.2, 6.0, 1.3);
        let (near, nearly) = (gains(1.2, 1.4, 0.60, 1.2), gains(1.2, 1.3, 0.65, 1.2));
        assert_eq!(row(&[None, far, near]), Some((2, false)));
        assert_eq!(row(&[far, near, nearly]), Some((2, false)));
        assert_eq!(row(&[None, None]), None);
    }

    #[test]
    fn the_best_run_for_a_solver_has_the_fewest_parts_beyond_its_limits() {
        let with = |gains: Option<Gains>, beyond| {
            gains.map(|g| Gains { beyond: Some([[9, 9], beyond]), ..g })
        };
        let (good, better) = (gains(1.2, 1.5, 0.2, 1.1), gains(1.2, 1.4, 0.2, 1.1));
        let chosen = |runs: &[Option<Gains>]| row(&within_limits(runs)).map(|best| best.0);
        assert_eq!(chosen(&[with(better, [1, 0]), with(good, [0, 90]), None]), Some(1));
        assert_eq!(chosen(&[with(better, [0, 12]), with(good, [0, 10])]), Some(1));
        assert_eq!(chosen(&[with(good, [0, 10]), with(better, [0, 11])]), Some(1));
        // A run with fewer parts beyond limits helps, though its worst element is worse.
        assert_eq!(
            chosen(&[with(gains(1.2, 2.5, 0.2, 1.1), [0, 3]), with(better, [1, 3])]),
            Some(0)
        );
        // A run that does not help sets no bound.
        let unlike = with(gains(1.3, 2.1, 0.1, 1.0), [9, 9]);
        assert_eq!(chosen(&[unlike, with(good, [9, 9])]), Some(1));
        assert_eq!(chosen(&[good, better]), Some(1));
    }

    #[test]
    fn a_run_with_a_worse_element_is_never_the_best() {
        let sharp = |gains: Option<Gains>| gains.map(|g| Gains { least_angle: [45.0, 39.0], ..g });
        let good = gains(1.2, 1.5, 0.2, 1.1);
        assert_eq!(row(&[sharp(good), gains(1.25, 1.9, 0.2, 1.1)]), Some((1, true)));
        assert_eq!(row(&[sharp(good), gains(1.1, 2.1, 0.2, 1.1)]), None);
        // A mesh that comes back as it was is no better.
        assert_eq!(row(&[gains(1.3, 2.0, 0.0, 1.0), sharp(good)]), None);
        assert_eq!(row(&[gains(1.29, 2.0, 0.1, 1.0), sharp(good)]), Some((0, true)));
    }
}
