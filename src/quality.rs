//! How good a mesh is, in numbers.

use crate::metric::{Corner, Metric};
use crate::parallel::map_parts;
use crate::topology::Topology;
use crate::topology::predicates;

/// Statistics of a mesh in double precision, inversions counted by exact predicates.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    f: [f64; Metric::ALL.len()],
    /// Smallest angle of any triangle, in degrees; of an inverted one as if mirrored.
    pub min_angle: f64,
    /// Largest angle of any triangle, in degrees.
    pub max_angle: f64,
    /// Largest inverse mean ratio, infinite if a triangle is inverted or flat.
    pub worst_imr: f64,
    /// The triangle that has it.
    pub worst_triangle: usize,
    /// Largest inverse mean ratio among triangles with a free vertex: what smoothing can mend.
    pub worst_movable_imr: f64,
    /// Number of triangles that are inverted or flat.
    pub inverted: usize,
}

/// What one pass over some triangles gathers.
#[derive(Clone)]
struct Tally {
    sums: [f64; Metric::ALL.len()],
    /// Cotangents: they fall as angles grow, and need no arc functions.
    cotangents: [f64; 2],
    worst: (f64, usize),
    worst_movable: f64,
}

impl Tally {
    const EMPTY: Self = Self {
        sums: [0.0; Metric::ALL.len()],
        cotangents: [f64::INFINITY, f64::NEG_INFINITY],
        worst: (0.0, 0),
        worst_movable: 0.0,
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
        self
    }
}

impl Quality {
    /// Measures `points` with the triangles of `topology`.
    pub fn of(points: &[[f64; 2]], topology: &Topology<'_>) -> Self {
        let triangles = topology.triangles();
        let areas = map_parts(triangles.chunks(1024), |_, chunk| {
            chunk.iter().map(|t| predicates::doubled_area(points, t)).sum::<f64>()
        });
        let mean_area = 0.5 * areas.iter().sum::<f64>() / triangles.len() as f64;
        let inverted = predicates::infeasible(points, triangles);

        let tallies = map_parts(triangles.chunks(1024), |chunk, part| {
            let add = |tally: Tally, (t, corners): (usize, &[u32; 3])| {
                let movable = corners.iter().any(|&v| topology.free()[v as usize]);
                tally.and(&one(points, corners, mean_area, chunk * 1024 + t, movable))
            };
            part.iter().enumerate().fold(Tally::EMPTY, add)
        });
        let total = tallies.iter().fold(Tally::EMPTY, Tally::and);

        let angle = |cotangent: f64| 1f64.atan2(cotangent).to_degrees();
        let mut quality = Self {
            f: std::array::from_fn(|i| total.sums[i] / triangles.len() as f64),
            min_angle: angle(total.cotangents[1]),
            max_angle: angle(total.cotangents[0]),
            worst_imr: total.worst.0,
            worst_triangle: total.worst.1,
            worst_movable_imr: total.worst_movable,
            inverted: inverted.len(),
        };
        // The exact predicate has the last word over the rounded areas.
        if let Some(&first) = inverted.first() {
            quality.worst_imr = f64::INFINITY;
            quality.worst_triangle = first as usize;
            for metric in Metric::ALL.iter().filter(|m| m.properties().barrier) {
                quality.f[*metric as usize] = f64::INFINITY;
            }
        }
        quality
    }

    /// The objective f = (1/n) Σ q² of a metric (Park & Shontz, equation 1).
    pub fn f(&self, metric: Metric) -> f64 {
        self.f[metric as usize]
    }
}

fn one(
    points: &[[f64; 2]],
    corners: &[u32; 3],
    mean_area: f64,
    triangle: usize,
    movable: bool,
) -> Tally {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    let to = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
    let corner = Corner { a: to(p, q), b: to(p, r), mean_area };
    let sums = std::array::from_fn(|i| {
        let quality = Metric::ALL[i].quality(&corner);
        quality * quality
    });
    let doubled = corner.doubled_area().abs();
    let cotangent = |u: [f64; 2], v: [f64; 2]| (u[0] * v[0] + u[1] * v[1]) / doubled;
    let cotangents = [
        cotangent(corner.a, corner.b),
        cotangent(to(q, r), to(q, p)),
        cotangent(to(r, p), to(r, q)),
    ];
    let imr = corner.inverse_mean_ratio();
    Tally {
        sums,
        cotangents: [
            cotangents.into_iter().fold(f64::INFINITY, f64::min),
            cotangents.into_iter().fold(f64::NEG_INFINITY, f64::max),
        ],
        worst: (imr, triangle),
        worst_movable: if movable { imr } else { 0.0 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    fn quality(points: &[[f64; 2]]) -> Quality {
        let mesh = Mesh { points: points.to_vec(), triangles: vec![[0, 1, 2]], fixed: vec![] };
        Quality::of(points, &Topology::new(&mesh).unwrap())
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

    #[test]
    fn a_flat_triangle_counts_as_inverted() {
        let q = quality(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]);
        assert_eq!((q.inverted, q.worst_imr), (1, f64::INFINITY));
        assert_eq!(q.f(Metric::Imr), f64::INFINITY);
        assert!(q.f(Metric::Edge).is_finite());
    }
}
