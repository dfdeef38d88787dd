//! Targets from the mesh itself: sizes or shapes of its elements, averaged over neighbors.

use crate::metric::of_right_angle;
use crate::parallel::collect;
use crate::targets::surface::Surface;
use crate::targets::tensor::Tensor;
use crate::topology::Topology;

/// 1/√3. The equilateral triangle W has the inverse W⁻¹ = [[1, -1/√3], [0, 2/√3]].
const W: f64 = 0.577_350_269_189_625_8;

/// Returns the target maps of equilateral triangles and squares with the sizes of the mesh's elements on a surface.
pub(super) fn sizes(
    topology: &Topology<'_>,
    points: &[[f64; 2]],
    surface: Surface,
    rings: u32,
) -> Vec<Tensor> {
    // The logarithm of a size is half the logarithm of the area.
    let triangles = topology.corners();
    let of = |index: usize| {
        let [a, b] = edges(topology, index, points);
        let [x, y] = surface.lengths_in(points, &triangles[index]);
        let area = ((a[0] * b[1] - a[1] * b[0]) * x * y).abs().max(f64::MIN_POSITIVE);
        Tensor::isotropic(-0.5 * area.ln())
    };
    let of_triangles: Vec<Tensor> = collect(triangles.len(), of);
    let at = averaged(triangles, points.len(), rings, &of_triangles, |_| true);
    // The average flattens gradation, above all at the boundary. Its difference from the sizes of the triangles,
    // averaged and added, restores most of the gradation (twicing; Tukey, Exploratory Data Analysis, 1977).
    let rest = |t: usize| of_triangles[t].plus(mean_at_corners(&at, &triangles[t]).times(-1.0));
    let rest: Vec<Tensor> = collect(triangles.len(), rest);
    let rest = averaged(triangles, points.len(), rings, &rest, |_| true);
    collect(points.len(), |v| at[v].plus(rest[v]).exp())
}

/// Stretching up to which sizes have the weight 1.
const UNWEIGHTED: f64 = 2.5;

/// Returns the weight of sizes for targets that keep the sizes of a mesh. `stretching` is that of
/// [`Adaptation`](super::Adaptation).
///
/// The term of shapes, μ₂ = |T|² / 2τ - 1, of a triangle stretched s-fold is (s + 1/s) / 2 - 1, nearly linear in s. The
/// term of sizes does not depend on s. So a weight that is linear in s keeps the balance of the terms, and the change of
/// sizes, from a mesh stretched 3-fold to a mesh stretched 1,000-fold.
pub(super) fn size_weight(stretching: f64) -> f64 {
    1.0 + 0.5 * (stretching - UNWEIGHTED).max(0.0)
}

/// Returns the maps under which the elements of the mesh are equilateral or square, and of equal size. Elements without a free
/// vertex, such as those of a kept boundary layer, do not count at the vertices of other triangles, so that the first
/// triangles beyond a layer are not stretched like the layer.
pub(super) fn shapes(topology: &Topology<'_>, points: &[[f64; 2]], rings: u32) -> Vec<Tensor> {
    let triangles = topology.corners();
    let of = |index: usize| shape_logarithm(topology, index, points, [1.0; 2]);
    let of_triangles: Vec<Tensor> = collect(triangles.len(), of);
    let at = averaged(triangles, points.len(), rings, &of_triangles, |t| {
        topology.can_move(topology.element(t as u32))
    });
    collect(points.len(), |v| at[v].exp())
}

/// Returns the logarithm of the map under which a corner is that of an equilateral triangle, or of a square, with edges of
/// length 1. `lengths` are the lengths of a unit of each coordinate.
pub(super) fn shape_logarithm(
    topology: &Topology<'_>,
    corner: usize,
    points: &[[f64; 2]],
    lengths: [f64; 2],
) -> Tensor {
    let edges = edges(topology, corner, points);
    shape_logarithm_of(edges.map(|[x, y]| [x * lengths[0], y * lengths[1]]))
}

/// Returns the logarithm of the map under which a triangle is equilateral with edges of length 1, given the two edges
/// that start at its first corner.
#[inline(always)]
pub(crate) fn shape_logarithm_of([a, b]: [[f64; 2]; 2]) -> Tensor {
    // A W⁻¹ maps the equilateral triangle to the given triangle, so the target map is (A W⁻¹ W⁻ᵗ Aᵀ)^-½.
    let second = [(2.0 * b[0] - a[0]) * W, (2.0 * b[1] - a[1]) * W];
    let square = Tensor::of_columns([a, second]);
    match square.is_positive() {
        true => square.ln().times(-0.5),
        // The triangle is flat except for rounding, and only its length is known.
        false => Tensor::isotropic(-0.5 * square.eigenvalues()[1].max(f64::MIN_POSITIVE).ln()),
    }
}

/// Returns the two edges of a corner that start at its first vertex, sheared if the corner is of a quadrilateral.
fn edges(topology: &Topology<'_>, corner: usize, points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let [p, q, r] = topology.corners()[corner].map(|v| points[v as usize]);
    let edges = [[q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]];
    match topology.corner_list().is_triangle(corner as u32) {
        true => edges,
        false => of_right_angle(edges),
    }
}

/// Averages the values of triangles at each vertex. Then, `rings` times, averages vertex values in each triangle and
/// triangle values at each vertex. A vertex averages its triangles for which `counts` returns true, or all its triangles if
/// there are none.
fn averaged(
    triangles: &[[u32; 3]],
    vertices: usize,
    rings: u32,
    of_triangles: &[Tensor],
    counts: impl Fn(usize) -> bool,
) -> Vec<Tensor> {
    let mut has_counting = vec![false; vertices];
    for (_, triangle) in triangles.iter().enumerate().filter(|(t, _)| counts(*t)) {
        triangle.iter().for_each(|&v| has_counting[v as usize] = true);
    }
    let counts = |t: usize, v: u32| counts(t) || !has_counting[v as usize];
    let mut at = at_vertices(triangles, vertices, of_triangles, counts);
    for _ in 0..rings {
        let of_triangles: Vec<Tensor> =
            collect(triangles.len(), |t| mean_at_corners(&at, &triangles[t]));
        at = at_vertices(triangles, vertices, &of_triangles, counts);
    }
    at
}

/// Returns the mean of vertex values at the corners of a triangle.
pub(super) fn mean_at_corners(at: &[Tensor], triangle: &[u32; 3]) -> Tensor {
    let [p, q, r] = triangle.map(|v| at[v as usize]);
    p.plus(q).plus(r).times(1.0 / 3.0)
}

/// Returns the mean of the values of each vertex's triangles; zero for a vertex without triangles. `counts` takes a
/// triangle and a vertex, and returns whether the triangle counts at the vertex.
fn at_vertices(
    triangles: &[[u32; 3]],
    vertices: usize,
    of: &[Tensor],
    counts: impl Fn(usize, u32) -> bool,
) -> Vec<Tensor> {
    let mut sums = vec![(Tensor::default(), 0u32); vertices];
    for (t, (triangle, &value)) in triangles.iter().zip(of).enumerate() {
        for &v in triangle.iter().filter(|v| counts(t, **v)) {
            let (sum, count) = &mut sums[v as usize];
            *sum = sum.plus(value);
            *count += 1;
        }
    }
    collect(vertices, |v| {
        let (sum, count) = sums[v];
        sum.times(1.0 / f64::from(count.max(1)))
    })
}
