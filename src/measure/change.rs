//! Comparison of two states of a mesh: displacements of vertices, and changes of element sizes.

use crate::error::MeshError;
use crate::measure::ranks::rank;
use crate::parallel::{collect, map_parts, map_ranges, ranges};
use crate::precision::Precision;
use crate::topology::Topology;

/// Difference between two states of a mesh, at its free vertices and at vertices that slid along lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Displacement of vertices, divided by the mean length of their edges before.
    pub moved: Distribution,
    /// Factor by which the element size at a vertex grew or shrank, always 1 or more. The element size is the square
    /// root of the geometric mean of the areas of the elements at the vertex.
    pub size: Distribution,
    /// Least altitude of a triangle, or of a corner triangle of a quadrilateral, before and after, in the unit of the points. The
    /// altitude bounds the time step of explicit solvers.
    pub least_altitude: [f64; 2],
}

/// Distribution of a number over vertices. Without vertices, all fields are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distribution {
    /// Median over the vertices: the least value that at least half of the values do not exceed.
    pub median: f64,
    /// 95th percentile over the vertices: the least value that at least 95 % of the values do not exceed.
    pub p95: f64,
    /// Largest value of a vertex.
    pub most: f64,
}

/// Sums over the elements around a vertex.
#[derive(Clone, Copy, Default)]
struct Around {
    /// Sum of the natural logarithms of the areas after, divided by the areas before.
    growth: f64,
    /// Sum of the lengths of the edges at the vertex before, once per element.
    lengths: f64,
    elements: u32,
}

/// An element with `N` vertices at two states of a mesh.
struct Changed<const N: usize> {
    vertices: [u32; N],
    /// Sum of the lengths of the two sides at each vertex before.
    lengths: [f64; N],
    /// Natural logarithm of the area after, divided by the area before.
    growth: f64,
    /// Least altitude before and after.
    altitudes: [f64; 2],
}

impl Change {
    /// Compares the mesh with its vertices at `before` and at `after`, both with one point per vertex in the same unit.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `before` or `after` does not have one entry per vertex.
    pub fn between(
        topology: &Topology<'_>,
        before: &[[f64; 2]],
        after: &[[f64; 2]],
    ) -> Result<Self, MeshError> {
        topology.check_count(before)?;
        topology.check_count(after)?;
        let (around, least_altitude) = around(topology, before, after);
        let is_free = |v: usize| topology.free()[v];
        // If a result is stored in single precision, even vertices that must stay get rounded coordinates.
        let is_rounded = |v: usize| before[v].map(|x| Precision::Single.rounded(x)) == after[v];
        let has_slid = |v: usize| before[v] != after[v] && !is_rounded(v) && around[v].elements > 0;
        let seen: Vec<usize> = (0..before.len()).filter(|&v| is_free(v) || has_slid(v)).collect();
        // If stars have been dropped, this line computes them again before several threads need them.
        if !seen.iter().all(|&v| is_free(v)) {
            topology.star(0);
        }
        let moved = |i: usize| {
            let v = seen[i];
            let ([x, y], [a, b]) = (before[v], after[v]);
            let [dx, dy] = [x - a, y - b];
            (dx * dx + dy * dy).sqrt() / mean_edge(topology, before, v, &around[v])
        };
        let size = |i: usize| {
            let v = seen[i];
            (0.5 * around[v].growth / f64::from(around[v].elements)).abs().exp()
        };
        let numbers = [collect(seen.len(), moved), collect(seen.len(), size)];
        let spreads = map_parts(numbers, |_, numbers| spread(numbers));
        let [moved, size] = [0, 1].map(|i| spreads[i]);
        Ok(Self { moved, size, least_altitude })
    }
}

/// Returns the mean length of the edges at each vertex; NaN for vertices that no element uses.
pub(crate) fn mean_edges(topology: &Topology<'_>, points: &[[f64; 2]]) -> Vec<f64> {
    let (around, _) = around(topology, points, points);
    around.iter().enumerate().map(|(v, around)| mean_edge(topology, points, v, around)).collect()
}

/// Returns the mean length of the edges at a vertex, each edge counted once.
fn mean_edge(topology: &Topology<'_>, points: &[[f64; 2]], v: usize, around: &Around) -> f64 {
    // At a free vertex, every edge belongs to two elements. At a boundary vertex, two edges belong to one element.
    if topology.free()[v] {
        return around.lengths / f64::from(2 * around.elements);
    }
    let corners = |&t: &u32| topology.corners()[t as usize];
    let mut ends: Vec<u32> = topology.star(v as u32).iter().flat_map(corners).collect();
    ends.sort_unstable();
    ends.dedup();
    let [x, y] = points[v];
    let length = |&end: &u32| {
        let [a, b] = points[end as usize];
        (x - a).hypot(y - b)
    };
    // `ends` contains the vertex itself, which adds a length of zero.
    ends.iter().map(length).sum::<f64>() / (ends.len() as f64 - 1.0)
}

/// Returns the sums around each vertex, and the least altitudes before and after.
fn around(
    topology: &Topology<'_>,
    before: &[[f64; 2]],
    after: &[[f64; 2]],
) -> (Vec<Around>, [f64; 2]) {
    let mut sums =
        Sums { around: vec![Around::default(); before.len()], least: [f64::INFINITY; 2] };
    let triangles = topology.triangles();
    sums.add(triangles.len(), |t| {
        let corners = &triangles[t];
        let ([a, b, c], doubled) = lengths_and_area(before, corners);
        let (after, doubled_after) = longest_and_area(after, corners);
        Changed {
            vertices: *corners,
            lengths: [a + b, a + c, b + c],
            growth: growth(doubled, doubled_after),
            altitudes: [altitude(doubled, a.max(b).max(c)), altitude(doubled_after, after)],
        }
    });
    let quadrilaterals = topology.corner_list().of_quadrilaterals().as_chunks::<4>().0;
    sums.add(quadrilaterals.len(), |q| {
        let corners = quadrilaterals[q].each_ref();
        let was = corners.map(|corner| lengths_and_area(before, corner));
        let is = corners.map(|corner| longest_and_area(after, corner));
        // Each point of a convex quadrilateral is in two of its corner triangles.
        let doubled = 0.5 * was.iter().map(|(_, doubled)| doubled).sum::<f64>();
        let doubled_after = 0.5 * is.iter().map(|(_, doubled)| doubled).sum::<f64>();
        let altitudes = was.iter().map(|([a, b, c], own)| altitude(*own, a.max(*b).max(*c)));
        let altitudes_after = is.iter().map(|(longest, own)| altitude(*own, *longest));
        Changed {
            vertices: corners.map(|corner| corner[0]),
            lengths: was.map(|([a, b, _], _)| a + b),
            growth: growth(doubled, doubled_after),
            altitudes: [
                altitudes.fold(f64::INFINITY, f64::min),
                altitudes_after.fold(f64::INFINITY, f64::min),
            ],
        }
    });
    (sums.around, sums.least)
}

struct Sums {
    around: Vec<Around>,
    least: [f64; 2],
}

impl Sums {
    /// Adds `count` elements. The elements are measured on all threads, and added in their order.
    fn add<const N: usize>(&mut self, count: usize, element: impl Fn(usize) -> Changed<N> + Sync) {
        /// Number of elements that one task measures, and number of elements that wait to be added.
        const CHUNK: usize = 1 << 12;
        const BLOCK: usize = 1 << 16;
        for block in ranges(count, BLOCK) {
            let measured = map_ranges(block.len(), CHUNK, |range| {
                range.map(|i| element(block.start + i)).collect::<Vec<_>>()
            });
            for Changed { vertices, lengths, growth, altitudes } in measured.into_iter().flatten() {
                for (vertex, length) in vertices.into_iter().zip(lengths) {
                    let at = &mut self.around[vertex as usize];
                    at.growth += growth;
                    at.lengths += length;
                    at.elements += 1;
                }
                let [before, after] = altitudes;
                self.least = [self.least[0].min(before), self.least[1].min(after)];
            }
        }
    }
}

/// Returns the least altitude of a triangle, given twice its signed area and its longest edge: 0 for a triangle at one place.
fn altitude(doubled: f64, longest: f64) -> f64 {
    if longest == 0.0 { 0.0 } else { doubled.abs() / longest }
}

/// Returns the natural logarithm of an area divided by another, given twice the signed areas; 0 if an area is 0, which no factor
/// changes.
fn growth(before: f64, after: f64) -> f64 {
    if before == 0.0 || after == 0.0 {
        return 0.0;
    }
    let area = |doubled: f64| (0.5 * doubled.abs()).max(f64::MIN_POSITIVE);
    (area(after) / area(before)).ln()
}

/// Returns the edges of a corner triangle from its first vertex to the second, from the first to the third, and from the second to
/// the third.
#[inline]
fn edges(points: &[[f64; 2]], corner: &[u32; 3]) -> [[f64; 2]; 3] {
    let [p, q, r] = corner.map(|v| points[v as usize]);
    let edge = |p: [f64; 2], q: [f64; 2]| [q[0] - p[0], q[1] - p[1]];
    [edge(p, q), edge(p, r), edge(q, r)]
}

/// Returns the lengths of the [`edges`] of a corner triangle, and twice its signed area.
#[inline]
fn lengths_and_area(points: &[[f64; 2]], corner: &[u32; 3]) -> ([f64; 3], f64) {
    let edges = edges(points, corner);
    let [a, b, _] = edges;
    (edges.map(|[x, y]| (x * x + y * y).sqrt()), a[0] * b[1] - a[1] * b[0])
}

/// Returns the length of the longest edge of a corner triangle, and twice its signed area.
#[inline]
fn longest_and_area(points: &[[f64; 2]], corner: &[u32; 3]) -> (f64, f64) {
    let edges = edges(points, corner);
    let [a, b, _] = edges;
    let squares = edges.map(|[x, y]| x * x + y * y);
    (squares.into_iter().fold(0.0, f64::max).sqrt(), a[0] * b[1] - a[1] * b[0])
}

fn spread(mut numbers: Vec<f64>) -> Distribution {
    if numbers.is_empty() {
        return Distribution::default();
    }
    let mut at = |share: f64| {
        let rank = rank(share, numbers.len());
        *numbers.select_nth_unstable_by(rank, f64::total_cmp).1
    };
    Distribution { median: at(0.5), p95: at(0.95), most: at(1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    #[test]
    fn a_vertex_moved_by_a_third_of_an_edge() {
        // The inner vertex of a square with side 2 moves from the center by half of 1.
        let points = vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, 0.0]];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = Mesh { points, triangles, ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        let mut after = mesh.points.clone();
        after[4] = [0.5, 0.0];
        let change = Change::between(&topology, &mesh.points, &after).unwrap();
        assert!((change.moved.most - 0.5 / 2f64.sqrt()).abs() < 1e-15, "{change:?}");
        assert_eq!((change.moved.median, change.moved.p95), (change.moved.most, change.moved.most));
        // Areas of 1 become 1, 1, 0.5 and 1.5.
        assert!((change.size.most - 0.75f64.powf(-0.125)).abs() < 1e-15, "{change:?}");
        assert_eq!(change.least_altitude, [1.0, 0.5]);
        assert!(Change::between(&topology, &mesh.points, &after[1..]).is_err());
    }

    #[test]
    fn percentiles_are_values_that_enough_others_do_not_exceed() {
        for (count, p95) in [(1, 1), (2, 2), (19, 19), (20, 19), (21, 20), (40, 38), (41, 39)] {
            let found = spread((1..=count).rev().map(f64::from).collect());
            let expected = Distribution {
                median: f64::from((count + 1) / 2),
                p95: f64::from(p95),
                most: f64::from(count),
            };
            assert_eq!(found, expected, "{count}");
        }
        assert_eq!(spread(Vec::new()), Distribution::default());
    }

    #[test]
    fn a_vertex_that_slid_along_the_boundary_counts_with_each_edge_once() {
        // The middle vertex of the lower side has three edges, of lengths 1, 1 and 2; the two along the side belong to
        // one triangle each.
        let points = vec![[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 2.0]];
        let mesh = Mesh { points, triangles: vec![[0, 1, 3], [1, 2, 3]], ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        let mut after = mesh.points.clone();
        assert_eq!(Change::between(&topology, &mesh.points, &after).unwrap().moved.most, 0.0);
        after[1] = [0.5, 0.0];
        let change = Change::between(&topology, &mesh.points, &after).unwrap();
        assert!((change.moved.most - 0.5 / (4.0 / 3.0)).abs() < 1e-15, "{change:?}");
        assert_eq!(change.moved.median, change.moved.most, "those that must stay do not count");
        // Areas of 1 become 1.5 and 0.5.
        assert!((change.size.most - 0.75f64.powf(-0.25)).abs() < 1e-15, "{change:?}");
        // A vertex whose position was only rounded has not slid.
        let third = |x: f64| vec![[-1.0, 0.0], [x, 0.0], [1.0, 0.0], [0.0, 2.0]];
        let rounded = third(f64::from((1.0 / 3.0) as f32));
        assert_eq!(
            Change::between(&topology, &third(1.0 / 3.0), &rounded).unwrap().moved.most,
            0.0
        );
        let edges = mean_edges(&topology, &mesh.points);
        assert!((edges[1] - 4.0 / 3.0).abs() < 1e-15, "{edges:?}");
    }

    #[test]
    fn quadrilaterals_at_a_vertex_count_with_their_areas() {
        // A square with side 2 in four squares, one of which is two triangles. The vertex at the center moves by 0.5.
        let points = (0..9).map(|v| [f64::from(v % 3), f64::from(v / 3)]).collect();
        let mesh = Mesh {
            points,
            triangles: vec![[4, 5, 8], [4, 8, 7]],
            quadrilaterals: vec![[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6]],
            ..Mesh::default()
        };
        let topology = Topology::new(&mesh).unwrap();
        let mut after = mesh.points.clone();
        after[4] = [1.5, 1.0];
        let change = Change::between(&topology, &mesh.points, &after).unwrap();
        // The center has four edges of length 1 and the diagonal.
        let mean = (4.0 + 2f64.sqrt()) / 5.0;
        assert!((change.moved.most - 0.5 / mean).abs() < 1e-15, "{change:?}");
        // The areas of the quadrilaterals, 1, become 1.25, 0.75 and 1.25. Those of the triangles, 0.5, become 0.25 and 0.5.
        let factor = (1.25f64 * 0.75 * 1.25 * 0.5).powf(0.1);
        assert!((change.size.most - factor.max(1.0 / factor)).abs() < 1e-15, "{change:?}");
        // Before, all corner triangles are halves of a square. After, the least altitude is that of the corner triangle of the
        // second quadrilateral at the center, with an area of 0.25 and a longest edge from (1, 0) to (2, 1).
        let least = [0.5f64.sqrt(), 0.5f64.sqrt() / 2.0];
        for (found, expected) in change.least_altitude.iter().zip(least) {
            assert!((found - expected).abs() < 1e-15, "{change:?}");
        }
    }
}
