//! Quality statistics of a mesh.

use fearless_simd::prelude::*;

use crate::error::MeshError;
use crate::mesh::Element;
use crate::metric::{Corner, Ideal, Metric, opposite_angles};
use crate::parallel::pace::now;
use crate::parallel::paced;
use crate::patch::FourTriangles;
use crate::patch::lanes::{LANES, Lanes, Points, with_instructions};
use crate::targets::Surface;
use crate::topology::Topology;
use crate::topology::predicates;

/// Quality statistics of a mesh, in double precision. Exact predicates decide which elements are inverted or flat.
///
/// A quadrilateral is measured by its four corners. An element with an infinite or NaN coordinate counts as inverted.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    f: [f64; Metric::ALL.len()],
    /// Smallest angle of any element, in degrees. An inverted corner counts as its mirror image.
    pub min_angle: f64,
    /// Largest angle of any element, in degrees. An inverted corner counts as its mirror image.
    pub max_angle: f64,
    /// Largest inverse mean ratio of a triangle or of a corner of a quadrilateral: 1 at best, infinite if an element is inverted
    /// or flat.
    pub worst_imr: f64,
    /// The element with the largest inverse mean ratio.
    pub worst: Element,
    /// Largest inverse mean ratio among the elements with a free vertex, which smoothing can improve; 0 if there is no
    /// free vertex.
    pub worst_movable_imr: f64,
    /// Number of elements that are inverted or flat, or not convex.
    pub inverted: usize,
}

/// Mean areas by which no formula of a triangle of usual size overflows or loses bits; see [`FourTriangles`].
const USUAL_AREA: std::ops::Range<f64> = 1e-120..1e120;

/// Sums and extremes over a set of elements.
#[derive(Clone)]
struct Tally {
    sums: [f64; Metric::ALL.len()],
    /// Least and largest cotangent of an angle. A cotangent decreases as its angle grows, and its computation needs no
    /// arc function.
    cotangents: [f64; 2],
    /// Largest inverse mean ratio, with the index of its corner.
    worst: (f64, usize),
    worst_movable: f64,
    inverted: usize,
}

impl Tally {
    const EMPTY: Self = Self {
        sums: [0.0; Metric::ALL.len()],
        cotangents: [f64::INFINITY, f64::NEG_INFINITY],
        worst: (0.0, 0),
        worst_movable: 0.0,
        inverted: 0,
    };

    fn and(mut self, other: &Self) -> Self {
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

impl Quality {
    /// Measures the elements of `topology` with vertices at `points`, one plane point per vertex of the mesh, in any
    /// unit.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn of(points: &[[f64; 2]], topology: &Topology<'_>) -> Result<Self, MeshError> {
        Self::on(Surface::Plane, points, topology)
    }

    /// Measures the elements of `topology` with vertices at `points`, given as coordinates on `surface`. Lengths and
    /// angles are measured on the surface, by its metric at the center of each corner.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn on(
        surface: Surface,
        points: &[[f64; 2]],
        topology: &Topology<'_>,
    ) -> Result<Self, MeshError> {
        now(Self::with_pauses(surface, points, topology))
    }

    /// Does the work of [`Self::on`], with pauses.
    pub(crate) async fn with_pauses(
        surface: Surface,
        points: &[[f64; 2]],
        topology: &Topology<'_>,
    ) -> Result<Self, MeshError> {
        topology.check_count(points)?;
        let corners = topology.corner_list();
        let (triangles, right) = (corners.triangles(), corners.of_quadrilaterals());
        // Areas are absolute, as signed areas may cancel if large triangles are inverted.
        let area = |t: &[u32; 3]| {
            let [x, y] = surface.lengths_in(points, t);
            0.5 * predicates::orientation(points, t).abs() * x * y
        };
        let areas = |_, chunk: &[[u32; 3]]| chunk.iter().map(area).sum::<f64>();
        let areas_by_four = |_, chunk: &[[u32; 3]]| {
            with_instructions!(simd => {
                let (fours, rest) = chunk.as_chunks();
                let mut sum = 0.0;
                for four in fours {
                    match FourTriangles::of(simd, surface, points, four) {
                        Some(four) => add_in_order(&mut sum, four.doubled_area * 0.5),
                        None => four.iter().for_each(|t| sum += area(t)),
                    }
                }
                rest.iter().for_each(|t| sum += area(t));
                sum
            }, alone => chunk.iter().map(area).sum::<f64>())
        };
        let mut total_area =
            paced::map_parts(triangles.chunks(1024), areas_by_four).await.iter().sum::<f64>();
        if !right.is_empty() {
            let areas = paced::map_parts(right.chunks(1024), areas).await;
            total_area += 0.5 * areas.iter().sum::<f64>();
        }
        let mean_area = total_area / corners.equivalent_triangles();

        let shape = |corner: &[u32; 3]| {
            Shape::of(points, corner, surface.lengths_in(points, corner), mean_area)
        };
        let is_usual = USUAL_AREA.contains(&mean_area);
        let movable = |t: &[u32; 3]| t.iter().any(|&v| topology.free()[v as usize]);
        let tallies = paced::map_parts(triangles.chunks(1024), |chunk, part| {
            let mut tally = Tally::EMPTY;
            let first = chunk * 1024;
            let alone = |tally: &mut Tally, triangles: &[[u32; 3]], first: usize| {
                for (index, t) in (first..).zip(triangles) {
                    tally.add_alone(&shape(t), index, movable(t));
                }
            };
            with_instructions!(simd => {
                let (fours, rest) = part.as_chunks();
                for (k, four) in fours.iter().enumerate() {
                    let at = first + LANES * k;
                    let usual = match is_usual {
                        true => FourTriangles::of(simd, surface, points, four),
                        false => None,
                    };
                    match usual {
                        Some(usual) => tally.add_usual(&usual, mean_area, four, at, movable),
                        None => alone(&mut tally, four, at),
                    }
                }
                alone(&mut tally, rest, first + part.len() - rest.len());
            }, alone => alone(&mut tally, part, first));
            tally
        });
        let mut total = tallies.await.iter().fold(Tally::EMPTY, Tally::and);
        let right_corner = |corner: &[u32; 3], index: usize| {
            let movable = topology.can_move(corners.element(index as u32));
            let lengths = surface.lengths_in(points, corner);
            Tally::of_right(&Shape::of(points, corner, lengths, mean_area), index, movable)
        };
        let tallies = paced::map_parts(right.chunks(1024), |chunk, part| {
            let first = triangles.len() + chunk * 1024;
            let element = |(k, four): (usize, &[[u32; 3]])| {
                let at = |c: usize| right_corner(&four[c], first + 4 * k + c);
                let parts = [0, 1, 2, 3].map(at);
                let mut tally = parts.iter().fold(Tally::EMPTY, |a, b| a.and(b));
                tally.sums.iter_mut().for_each(|sum| *sum *= 0.25);
                let joined =
                    opposite_angles::of_cotangents(parts.each_ref().map(|part| part.cotangents[0]));
                for (sum, metric) in tally.sums.iter_mut().zip(Metric::ALL) {
                    if metric.joins_opposite_angles() && sum.is_finite() {
                        *sum = (*sum + joined).min(f64::MAX);
                    }
                }
                tally.inverted = tally.inverted.min(1);
                tally
            };
            let elements = part.chunks(4).enumerate().map(element);
            elements.fold(Tally::EMPTY, |a, b| a.and(&b))
        });
        total = tallies.await.iter().fold(total, Tally::and);

        let count = topology.element_count() as f64;
        let angle = |cotangent: f64| 1f64.atan2(cotangent).to_degrees();
        let mean = |sum: f64| if sum.is_nan() { f64::INFINITY } else { sum / count };
        Ok(Self {
            f: total.sums.map(mean),
            min_angle: angle(total.cotangents[1]),
            max_angle: angle(total.cotangents[0]),
            worst_imr: total.worst.0,
            worst: corners.element(total.worst.1 as u32),
            worst_movable_imr: total.worst_movable,
            inverted: total.inverted,
        })
    }

    /// Returns the objective f = (1/n) Σ q² over all n elements (Park & Shontz, equation 1), with q² of a
    /// quadrilateral the mean over its corners, to which ACUTE and ACUTE-SIZE add the term of opposite angles. Infinite if an
    /// element is inverted or flat and the metric has a barrier.
    pub fn f(&self, metric: Metric) -> f64 {
        self.f[metric as usize]
    }
}

/// The shape of a triangle, or of a corner of a quadrilateral.
#[derive(Clone, Copy)]
struct Shape {
    corner: Corner<f64>,
    /// The cotangents of the three angles.
    cotangents: [f64; 3],
    /// Whether the exact area is positive.
    is_positive: bool,
}

impl Shape {
    #[inline(always)]
    fn of(points: &[[f64; 2]], corners: &[u32; 3], lengths: [f64; 2], mean_area: f64) -> Self {
        let orientation = predicates::orientation(points, corners);
        let is_positive = orientation > 0.0 && orientation < f64::INFINITY;
        let Edges { a, b, c, unit } = Edges::of(points, corners, lengths, orientation);
        let corner = Corner { a, b, ideal: Ideal::of_area(mean_area / unit / unit) };
        let doubled = corner.doubled_area().abs();
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
    fn square(&self, excess: f64, metric: Metric) -> f64 {
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
    fn of_right(shape: &Shape, index: usize, movable: bool) -> Self {
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
    fn add_usual<S: Simd>(
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
        let (u, v) = (cotangent(a, b, doubled), -cotangent(a, c, doubled));
        let w = cotangent(b, c, doubled);
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
    fn add_alone(&mut self, shape: &Shape, index: usize, movable: bool) {
        self.add_extremes(shape, index, movable);
        let excesses = Metric::every_excess(&shape.corner);
        for ((sum, excess), &metric) in self.sums.iter_mut().zip(excesses).zip(Metric::ALL) {
            *sum += shape.square(excess, metric);
        }
    }

    /// Adds the angles, the inverse mean ratio and the orientation of an element.
    #[inline(always)]
    fn add_extremes(&mut self, shape: &Shape, index: usize, movable: bool) {
        let [a, b, c] = shape.cotangents;
        self.cotangents[0] = self.cotangents[0].min(a).min(b).min(c);
        self.cotangents[1] = self.cotangents[1].max(a).max(b).max(c);
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

/// Returns the cotangents of the angles between edges, given twice the areas.
#[inline(always)]
fn cotangent<S: Simd>(u: Points<S>, v: Points<S>, doubled: Lanes<S>) -> Lanes<S> {
    (u[0] * v[0] + u[1] * v[1]) / doubled
}

/// Adds four numbers to a sum, one after another.
#[inline(always)]
fn add_in_order<S: Simd>(sum: &mut f64, four: Lanes<S>) {
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
        let unit = f64::from_bits(size.to_bits() & EXPONENT);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    fn quality(points: &[[f64; 2]]) -> Quality {
        let mesh = Mesh { points: points.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
        Quality::of(points, &Topology::new(&mesh).unwrap()).unwrap()
    }

    #[test]
    fn a_right_triangle_by_hand() {
        // Legs 1 and 1: edge ratio √2, IMR = (1 + 1 + 2) / (4√3 · ½) = 2/√3.
        let q = quality(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        assert!((q.min_angle - 45.0).abs() < 1e-12 && (q.max_angle - 90.0).abs() < 1e-12);
        assert!((q.worst_imr - 2.0 / 3f64.sqrt()).abs() < 1e-15);
        assert!((q.f(Metric::Imr) - 4.0 / 3.0).abs() < 1e-15);
        assert!((q.f(Metric::Edge) - 2.0).abs() < 1e-15);
        assert!((q.f(Metric::Rms) - 2.0 / 3f64.sqrt()).abs() < 1e-15);
        assert_eq!(q.f(Metric::Area), 0.0);
        assert_eq!(q.inverted, 0);
        assert_eq!(q.worst_movable_imr, 0.0);
    }

    /// Triangles are measured four at a time, with the bits that each has alone.
    #[test]
    fn triangles_measured_together_have_the_sums_of_triangles_measured_alone() {
        let mut state = 5_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        for spread in [0, 3, 90] {
            let mut mesh = Mesh::default();
            for k in 0..501 {
                let size = 10f64.powi(if spread == 0 { 0 } else { k % spread - spread / 2 });
                let first = mesh.points.len() as u32;
                mesh.triangles.push([first, first + 1, first + 2]);
                mesh.points.extend([(); 3].map(|()| [size * random(), size * random()]));
            }
            let topology = Topology::new(&mesh).unwrap();
            let mut points = mesh.points.clone();
            let found = Quality::of(&points, &topology).unwrap();
            let area = |t: &[u32; 3]| 0.5 * predicates::orientation(&points, t).abs();
            let mean = topology.triangles().iter().map(area).sum::<f64>() / 501.0;
            for &metric in Metric::ALL.iter() {
                let mut sum = 0.0;
                for corners in topology.triangles() {
                    let shape = Shape::of(&points, corners, [1.0; 2], mean);
                    let excess = Metric::every_excess(&shape.corner)[metric as usize];
                    sum += shape.square(excess, metric);
                }
                assert_eq!(found.f(metric), sum / 501.0, "{metric}, {spread}");
            }
            let mut extremes = Tally::EMPTY;
            for (index, corners) in topology.triangles().iter().enumerate() {
                extremes.add_extremes(&Shape::of(&points, corners, [1.0; 2], mean), index, true);
            }
            let angles = extremes.cotangents.map(|cotangent| 1f64.atan2(cotangent).to_degrees());
            assert_eq!([found.max_angle, found.min_angle], angles, "{spread}");
            assert_eq!(found.worst_imr, extremes.worst.0, "{spread}");
            assert_eq!(found.worst, Element::Triangle(extremes.worst.1), "{spread}");
            assert_eq!(found.inverted, extremes.inverted, "{spread}");
            points[7][0] = f64::INFINITY;
            let broken = Quality::of(&points, &topology).unwrap();
            assert_eq!(
                (broken.f(Metric::Imr), broken.inverted),
                (f64::INFINITY, found.inverted + 1)
            );
        }
    }

    #[test]
    fn a_flat_triangle_counts_as_inverted() {
        let q = quality(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]);
        assert_eq!((q.inverted, q.worst_imr), (1, f64::INFINITY));
        assert_eq!(q.f(Metric::Imr), f64::INFINITY);
        assert!(q.f(Metric::Edge).is_finite());
    }
}
