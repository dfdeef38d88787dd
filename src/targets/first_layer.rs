//! The first layer of vertices at the boundary, whose distances from the boundary are the spacing at walls.

use crate::targets::keep::mean_at_corners;
use crate::targets::tensor::Tensor;
use crate::topology::Topology;

/// Inverse mean ratio under the targets above which a triangle may be an outlier. Among the triangles at the boundary of
/// meshes from mesh generators, 1 in 100 has a larger ratio.
const MAX_RATIO: f64 = 2.0;
/// Largest factor between the heights of a triangle and of its target, for a triangle that is no outlier.
const MAX_HEIGHT_FACTOR: f64 = 2.0;
/// Largest distance between the middle of the base and the foot of the height, for a triangle that is no outlier, in
/// lengths of the base. A right triangle has 0.5.
const MAX_SHIFT: f64 = 1.0;

/// Returns the free vertices opposite boundary edges, ascending, except outliers.
pub(super) fn vertices(topology: &Topology<'_>, points: &[[f64; 2]], maps: &[Tensor]) -> Vec<u32> {
    let triangles = topology.triangles();
    let mut edges = topology.boundary_edges();
    edges.sort_unstable();
    let mut is_boundary = vec![false; points.len()];
    edges.as_flattened().iter().for_each(|&v| is_boundary[v as usize] = true);
    let mut layer = vec![false; points.len()];
    let mut outliers = vec![false; points.len()];
    for triangle in triangles {
        for corner in 0..3 {
            let [apex, start, end] = [0, 1, 2].map(|k| triangle[(corner + k) % 3]);
            let ends_on_boundary = is_boundary[start as usize] && is_boundary[end as usize];
            if topology.free()[apex as usize]
                && ends_on_boundary
                && edges.binary_search(&[start, end]).is_ok()
            {
                layer[apex as usize] = true;
                let at = [apex, start, end].map(|v| points[v as usize]);
                outliers[apex as usize] |= is_outlier(at, mean_at_corners(maps, triangle));
            }
        }
    }
    let is_kept = |&v: &u32| layer[v as usize] && !outliers[v as usize];
    (0..points.len() as u32).filter(is_kept).collect()
}

/// Returns whether a triangle at the boundary is an outlier of its neighborhood, given its apex and the ends of its
/// boundary edge, the base. In a stretched layer along a curved boundary, the mean map of a triangle is turned against the
/// triangle, so that the ratio is large for good triangles too. The height and the foot of the height distinguish good
/// triangles from outliers there.
fn is_outlier([apex, start, end]: [[f64; 2]; 3], map: Tensor) -> bool {
    let base = [end[0] - start[0], end[1] - start[1]];
    let side = [apex[0] - start[0], apex[1] - start[1]];
    let [u, v] = [base, side].map(|edge| map.applied(edge));
    // With edges u and v, the sum of the squared edge lengths is 2 (u² + v² - uv), and twice the area is u × v.
    let lengths = 2.0 * (dot(u, u) + dot(v, v) - dot(u, v));
    let ratio = lengths / (2.0 * 3f64.sqrt() * cross(u, v));
    if ratio.is_nan() || ratio <= 0.0 {
        return true;
    }
    let squared = dot(base, base);
    let shift = (dot(side, base) / squared - 0.5).abs();
    let normal = [-base[1], base[0]].map(|x| x / squared.sqrt());
    let stretched = map.applied(normal);
    // An equilateral triangle with edges of length 1 has a height of √¾.
    let height = dot(side, normal);
    let factor = height * dot(stretched, stretched).sqrt() / 0.75f64.sqrt();
    let is_as_high = (1.0 / MAX_HEIGHT_FACTOR..=MAX_HEIGHT_FACTOR).contains(&factor);
    ratio > MAX_RATIO && !(is_as_high && shift <= MAX_SHIFT)
}

fn dot([a, b]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    a * x + b * y
}

fn cross([a, b]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    a * y - b * x
}
