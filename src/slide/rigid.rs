//! Rigid motions of the plane, fitted to pairs of points.

use glam::DVec2;

use crate::periodic::Motion;

/// Tolerance within which the columns of a given matrix must be orthonormal.
const RIGID: f64 = 1e-6;
/// Largest number of pairs from which candidate motions are made.
const SAMPLES: usize = 16;

/// A translation or a rotation of the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rigid {
    /// Cosine and sine of the rotation angle.
    turn: DVec2,
    from: DVec2,
    /// Image of the point `from`.
    to: DVec2,
}

impl Rigid {
    /// The motion that leaves every point at its place, to the last bit.
    pub(crate) const IDENTITY: Self = Self { turn: DVec2::X, from: DVec2::ZERO, to: DVec2::ZERO };

    fn translation([from, to]: [DVec2; 2]) -> Self {
        Self { turn: DVec2::X, from, to }
    }

    /// Returns the motion that maps `a` to `b` and `c` to `d`. `None` if the distance from `a` to `c` differs from that
    /// of their images by more than the tolerance.
    fn through([a, b]: [DVec2; 2], [c, d]: [DVec2; 2], tolerance: f64) -> Option<Self> {
        let (before, after) = (c - a, d - b);
        let is_rigid = (before.length() - after.length()).abs() <= tolerance;
        // Quotient of the two vectors as complex numbers.
        let turn = DVec2::new(before.dot(after), before.perp_dot(after)).try_normalize()?;
        is_rigid.then_some(Self { turn, from: a, to: b })
    }

    /// Converts a matrix. `None` if the matrix is not finite, or not a translation or rotation within [`RIGID`].
    pub(crate) fn of([x, y]: Motion) -> Option<Self> {
        let [first, second] = [0, 1].map(|k| DVec2::new(x[k], y[k]));
        let is_rigid =
            (first.length() - 1.0).abs() <= RIGID && second.distance(first.perp()) <= RIGID;
        let to = DVec2::new(x[2], y[2]);
        (is_rigid && to.is_finite()).then(|| Self {
            turn: first.normalize(),
            from: DVec2::ZERO,
            to,
        })
    }

    /// Returns the image of a point.
    pub(crate) fn at(self, point: DVec2) -> DVec2 {
        self.to + self.turn.rotate(point - self.from)
    }

    /// Returns the inverse motion.
    pub(crate) fn inverse(self) -> Self {
        Self { turn: DVec2::new(self.turn.x, -self.turn.y), from: self.to, to: self.from }
    }

    /// Returns the motion that fits most pairs: it maps the first point to the second within the tolerance of the pair.
    /// Candidates are the given motion, translations by single pairs, and motions through two pairs. The first of
    /// several equally good candidates wins. `None` without candidates.
    pub(crate) fn of_pairs(given: Option<Motion>, pairs: &[([DVec2; 2], f64)]) -> Option<Self> {
        let count = pairs.len();
        let step = count.div_ceil(SAMPLES).max(1);
        let samples = || (0..count).step_by(step);
        let translations = samples().map(|i| Self::translation(pairs[i].0));
        let turned = samples().filter_map(|i| {
            let (first, tolerance) = pairs[i];
            Self::through(first, pairs[(i + count.div_ceil(2)) % count].0, tolerance)
        });
        let mut best = None;
        for motion in given.and_then(Self::of).into_iter().chain(translations).chain(turned) {
            let agree =
                pairs.iter().filter(|(pair, tolerance)| motion.takes(*pair, *tolerance)).count();
            if best.is_none_or(|(most, _)| agree > most) {
                best = Some((agree, motion));
            }
            if agree == count {
                break;
            }
        }
        best.map(|(_, motion)| motion)
    }

    /// Returns whether the motion maps the first point of a pair to the second within a distance of `tolerance`.
    pub(crate) fn takes(self, pair: [DVec2; 2], tolerance: f64) -> bool {
        let [from, to] = pair;
        self.at(from).distance(to) <= tolerance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_motion_of_most_pairs_is_found() {
        let (sin, cos) = 0.7_f64.sin_cos();
        let matrix = [[cos, -sin, 3.0], [sin, cos, -1.0]];
        let there = Rigid::of(matrix).unwrap();
        let points = (0..40).map(|k| DVec2::new(f64::from(k), f64::from(k % 7)));
        let mut pairs: Vec<_> = points.map(|p| ([p, there.at(p)], 1e-9)).collect();
        // Three of forty pairs do not fit, among them the first pair.
        for k in [0, 16, 21] {
            pairs[k].0[1] += DVec2::new(0.1, 0.0);
        }
        for given in [None, Some(matrix), Some([[1.0, 0.0, 5.0], [0.0, 1.0, 0.0]])] {
            let found = Rigid::of_pairs(given, &pairs).unwrap();
            assert_eq!(
                pairs.iter().filter(|(pair, tolerance)| found.takes(*pair, *tolerance)).count(),
                37,
                "{given:?}"
            );
            let p = DVec2::new(-2.0, 9.0);
            assert!(found.inverse().at(found.at(p)).distance(p) < 1e-12);
        }
        assert!(Rigid::of([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]).is_none());
        assert!(Rigid::of([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]).is_none(), "a reflection");
        assert!(Rigid::of([[f64::NAN; 3]; 2]).is_none() && Rigid::of_pairs(None, &[]).is_none());
    }
}
