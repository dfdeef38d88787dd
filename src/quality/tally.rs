//! Sums and extremes over elements, for [`Quality`](super::Quality).

use fearless_simd::prelude::*;

use crate::metric::{Corner, Ideal, Metric};
use crate::patch::lanes::{LANES, Lanes};
use crate::patch::{FourTriangles, dot};
use crate::topology::predicates;

/// Mean areas by which no formula of a triangle of usual size overflows or loses bits; see [`FourTriangles`].
pub(super) const USUAL_AREA: std::ops::Range<f64> = 1e-120..1e120;

/// Sums and extremes over a set of elements.
#[derive(Clone)]
pub(super) struct Tally {
    pub(super) sums: [f64; Metric::ALL.len()],
    /// Least and largest cotangent of an angle. A cotangent decreases as its angle grows, and its computation needs no
    /// arc function.
    pub(super) cotangents: [f64; 2],
    /// Largest inverse mean ratio, with the index of its corner.
    pub(super) worst: (f64, usize),
    pub(super) worst_movable: f64,
    pub(super) inverted: usize,
}

impl Tally {
    pub(super) const EMPTY: Self = Self {
        sums: [0.0; Metric::ALL.len()],
        cotangents: [f64::INFINITY, f64::NEG_INFINITY],
        worst: (0.0, 0),
        worst_movable: 0.0,
        inverted: 0,
    };

    pub(super) fn and(mut self, other: &Self) -> Self {
        for (sum, more) in self.sums.iter_mut().zip(other.sums) {
            *sum += more;
        }
        self.cotangents[0] = self.cotangents[0].min(other.cotangents[0]);
        self.cotangents[1] = self.cotangents[1].max(other.cotangents[1]);
        if other.worst.0 > self.worst.0 {
            self.worst = other.worst;
        }
        self.worst_movable = self.worst_movable.max(other.worst_movable);
        self.inverted += other.inverted;
        self
    }
}

/// The shape of a triangle, or of a corner of a quadrilateral.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    pub(super) corner: Corner<f64>,
    /// The cotangents of the three angles.
    cotangents: [f64; 3],
    /// Whether the exact area is positive.
    is_positive: bool,
}

impl Shape {
    #[inline(always)]
    pub(super) fn of(
        points: &[[f64; 2]],
        corners: &[u32; 3],
        lengths: [f64; 2],
        mean_area: f64,
    ) -> Self {
        let orientation = predicates::orientation(points, corners);
        let is_positive = orientation > 0.0 && orientation < f64::INFINITY;
        let Edges { a, b, c, unit } = Edges::of(points, corners, lengths, orientation);
        let corner = Corner { a, b, ideal: Ideal::of_area(mean_area / unit / unit) };
        let doubled = corner.doubled_area().abs();
        // NaN at two vertices of equal positions.
        let cotangent = |u: [f64; 2], v: [f64; 2]| (u[0] * v[0] + u[1] * v[1]) / doubled;
        let cotangents = [cotangent(a, b), -cotangent(a, c), cotangent(b, c)];
        Self { corner, cotangents, is_positive }
    }

    /// Returns the inverse mean ratio, infinite if the exact area is not positive.
    #[inline(always)]
    fn inverse_mean_ratio(&self) -> f64 {
        // The exact predicate decides, not the rounded area, so a ratio is infinite only if the triangle is inverted or
        // flat.
        match self.is_positive {
            true => self.corner.inverse_mean_ratio().min(f64::MAX),
            false => f64::INFINITY,
        }
    }

    /// Returns q² by a metric, given q² - ideal².
    #[inline(always)]
    pub(super) fn square(&self, excess: f64, metric: Metric) -> f64 {
        let square = excess + metric.ideal_squared();
        match (metric.properties().barrier, self.is_positive) {
            (false, _) => square,
            (true, true) => square.min(f64::MAX),
            (true, false) => f64::INFINITY,
        }
    }
}

impl Tally {
    /// Returns the tally of a corner of a quadrilateral.
    pub(super) fn of_right(shape: &Shape, index: usize, movable: bool) -> Self {
        let corner = shape.corner.of_right_angle();
        // The other two angles are between a side and a diagonal.
        let shape = Shape { corner, cotangents: [shape.cotangents[0]; 3], ..*shape };
        let mut tally = Self::EMPTY;
        let excesses = Metric::every_excess(&corner);
        for ((sum, excess), &metric) in tally.sums.iter_mut().zip(excesses).zip(Metric::ALL) {
            *sum += shape.square(excess, metric);
        }
        tally.add_extremes(&shape, index, movable);
        tally
    }

    /// Adds four triangles with the bits of [`add_alone`](Self::add_alone), for which no unit need be changed.
    #[inline(always)]
    pub(super) fn add_usual<S: Simd>(
        &mut self,
        four: &FourTriangles<S>,
        mean_area: f64,
        triangles: &[[u32; 3]],
        first: usize,
        movable: impl Fn(&[u32; 3]) -> bool,
    ) {
        let &FourTriangles { a, b, c, .. } = four;
        let corner = Corner { a, b, ideal: Ideal::of_area(mean_area) };
        let excesses = Metric::every_excess(&corner);
        for (k, &metric) in Metric::ALL.iter().enumerate() {
            let square = excesses[k] + metric.ideal_squared();
            let has_barrier = metric.properties().barrier;
            let most = if has_barrier { square.min(f64::MAX) } else { square };
            add_in_order(&mut self.sums[k], most);
        }
        let doubled = corner.doubled_area();
        // Cotangents of the three angles.
        let (u, v, w) = (dot(a, b) / doubled, -(dot(a, c) / doubled), dot(b, c) / doubled);
        let ratios = corner.squared_length_sum() * (3f64.sqrt() / 6.0) / doubled;
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let mut lane = 0;
        while lane < LANES {
            self.cotangents[0] = self.cotangents[0].min(least[lane]);
            self.cotangents[1] = self.cotangents[1].max(most[lane]);
            let ratio = ratios[lane].min(f64::MAX);
            if ratio > self.worst.0 {
                self.worst = (ratio, first + lane);
            }
            if ratio > self.worst_movable && movable(&triangles[lane]) {
                self.worst_movable = ratio;
            }
            lane += 1;
        }
    }

    /// Adds a triangle.
    #[inline(never)]
    pub(super) fn add_alone(&mut self, shape: &Shape, index: usize, movable: bool) {
        self.add_extremes(shape, index, movable);
        let excesses = Metric::every_excess(&shape.corner);
        for ((sum, excess), &metric) in self.sums.iter_mut().zip(excesses).zip(Metric::ALL) {
            *sum += shape.square(excess, metric);
        }
    }

    /// Adds the angles, the inverse mean ratio and the orientation of an element.
    #[inline(always)]
    pub(super) fn add_extremes(&mut self, shape: &Shape, index: usize, movable: bool) {
        let [a, b, c] = shape.cotangents;
        self.cotangents[0] = self.cotangents[0].min(a).min(b).min(c);
        self.cotangents[1] = self.cotangents[1].max(a).max(b).max(c);
        if a.is_nan() || b.is_nan() || c.is_nan() {
            // An angle at vertices of equal positions may have any size.
            self.cotangents = [f64::NEG_INFINITY, f64::INFINITY];
        }
        let ratio = shape.inverse_mean_ratio();
        if ratio > self.worst.0 {
            self.worst = (ratio, index);
        }
        if movable {
            self.worst_movable = self.worst_movable.max(ratio);
        }
        self.inverted += usize::from(!shape.is_positive);
    }
}

/// Adds four numbers to a sum, one after another.
#[inline(always)]
pub(super) fn add_in_order<S: Simd>(sum: &mut f64, four: Lanes<S>) {
    *sum = *sum + four[0] + four[1] + four[2] + four[3];
}

/// Edges of a triangle, divided by `unit` so that no product of edges overflows and the longest edge does not vanish.
struct Edges {
    /// From the first corner to the second.
    a: [f64; 2],
    /// From the first corner to the third.
    b: [f64; 2],
    /// From the second corner to the third.
    c: [f64; 2],
    /// A power of two near the size of the triangle.
    unit: f64,
}

impl Edges {
    /// Computes the edges of a triangle whose exact orientation is given. `lengths` are the lengths on the surface of a
    /// unit of each coordinate.
    fn of(points: &[[f64; 2]], corners: &[u32; 3], lengths: [f64; 2], orientation: f64) -> Self {
        const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
        let [p, q, r] = corners.map(|v| points[v as usize]);
        let to = |from: [f64; 2], to: [f64; 2]| {
            [(to[0] - from[0]) * lengths[0], (to[1] - from[1]) * lengths[1]]
        };
        let orientation = orientation * lengths[0] * lengths[1];
        let edges = [to(p, q), to(p, r), to(q, r)];
        let size = edges.as_flattened().iter().fold(f64::MIN_POSITIVE, |most, x| most.max(x.abs()));
        // Edges without a length have no unit.
        let has_length = size > f64::MIN_POSITIVE;
        let unit = if has_length { f64::from_bits(size.to_bits() & EXPONENT) } else { 1.0 };
        // The unit is a power of two, so multiplication by its inverse rounds nothing. Divisions would take several
        // times as long.
        let inverse = 1.0 / unit;
        let [a, b, c] = edges.map(|edge| edge.map(|x| x * inverse));
        let exact = orientation * inverse * inverse;
        let rounded = a[0] * b[1] - a[1] * b[0];
        if (exact > 0.0) == (rounded > 0.0) {
            return Self { a, b, c, unit };
        }
        // Rounding has changed the sign of the area. With axes along and across the first edge, a single coordinate
        // determines the sign, and is set from the exact area.
        let length = a[0].hypot(a[1]);
        let turned = |edge: [f64; 2]| [(a[0] * edge[0] + a[1] * edge[1]) / length, exact / length];
        Self { a: [length, 0.0], b: turned(b), c: turned(c), unit }
    }
}
