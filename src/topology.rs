//! What hangs together in a mesh: consistent windings, the boundary, one-rings.

use rayon::prelude::*;

use crate::error::MeshError;
use crate::groups::Groups;
use crate::mesh::Mesh;
use crate::validity;

/// The triangles of a mesh made counter-clockwise, and its free vertices.
#[derive(Clone, Debug)]
pub struct Topology {
    triangles: Vec<[u32; 3]>,
    free: Vec<bool>,
    /// The triangles at each vertex.
    stars: Groups,
}

/// No triangle lies across this edge.
const NONE: u32 = u32::MAX;

impl Topology {
    /// Checks the mesh and finds its windings, boundary and free vertices.
    ///
    /// Windings are made consistent across shared edges, and each edge-connected part
    /// counter-clockwise on the whole. A vertex is free unless it lies on the boundary, is listed
    /// in [`Mesh::fixed`], is used by no triangle, or joins two fans of triangles.
    ///
    /// # Errors
    /// What is no 2D triangle mesh at all: see [`MeshError`]. Whether it is feasible and has a free
    /// vertex is for [`check_smoothable`](Self::check_smoothable) to say.
    pub fn new(mesh: &Mesh) -> Result<Self, MeshError> {
        let Mesh { points, triangles, fixed } = mesh;
        check_indices(mesh)?;
        let mut stars = stars(points.len(), triangles);
        check_size(points, &stars)?;
        let mut free = vec![false; points.len()];
        // What most meshes are, all consistent and counter-clockwise, is seen from the stars alone.
        let triangles =
            if are_positive(points, triangles) && close(triangles, &mut stars, &mut free) {
                triangles.par_iter().copied().collect()
            } else {
                let wound = wind(points, triangles, &neighbors(triangles, &stars)?);
                close(&wound, &mut stars, &mut free);
                wound
            };
        for &v in fixed {
            free[v as usize] = false;
        }
        Ok(Self { triangles, free, stars })
    }

    /// Checks that there is something to smooth, and that smoothing can keep what it needs.
    ///
    /// # Errors
    /// [`MeshError::Infeasible`] if a triangle is inverted or flat at `points`,
    /// [`MeshError::NothingFree`] if no vertex is free.
    pub fn check_smoothable(&self, points: &[[f64; 2]]) -> Result<(), MeshError> {
        validity::check(points, &self.triangles)?;
        match self.free.contains(&true) {
            true => Ok(()),
            false => Err(MeshError::NothingFree { vertices: points.len() }),
        }
    }

    /// The triangles in the mesh's order, each counter-clockwise.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Whether each vertex is free to move.
    pub fn free(&self) -> &[bool] {
        &self.free
    }

    /// Number of free vertices.
    pub fn free_count(&self) -> usize {
        self.free.iter().filter(|&&f| f).count()
    }

    /// The triangles at a vertex: counter-clockwise around a free one, starting with the least.
    pub fn star(&self, vertex: u32) -> &[u32] {
        self.stars.of(vertex as usize)
    }

    /// The neighbors of a free vertex in counter-clockwise cyclic order, starting with the
    /// second corner of its first triangle. Each neighbor makes a
    /// triangle of the patch with the vertex and the neighbor after it.
    pub fn ring(&self, free_vertex: u32) -> Vec<u32> {
        self.ring_of(free_vertex).collect()
    }

    /// The same, without memory of its own.
    #[inline]
    pub(crate) fn ring_of(&self, free_vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let star = if self.free[free_vertex as usize] { self.star(free_vertex) } else { &[] };
        star.iter().map(move |&t| outer_edge(&self.triangles[t as usize], free_vertex).0)
    }
}

fn check_indices(mesh: &Mesh) -> Result<(), MeshError> {
    let Mesh { points, triangles, fixed } = mesh;
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    if points.len() >= NONE as usize || triangles.len() >= NONE as usize / 3 {
        return Err(MeshError::TooLarge { vertices: points.len(), triangles: triangles.len() });
    }
    let is_infinite = |p: &[f64; 2]| !(p[0].is_finite() & p[1].is_finite());
    if let Some(vertex) = first(points, is_infinite) {
        return Err(MeshError::NotFinite { vertex: vertex as u32 });
    }
    let count = points.len() as u32;
    let is_bad = |t: &[u32; 3]| {
        let outside = (t[0] >= count) | (t[1] >= count) | (t[2] >= count);
        outside | (t[0] == t[1]) | (t[1] == t[2]) | (t[2] == t[0])
    };
    if let Some(t) = first(triangles, is_bad) {
        let corners = &triangles[t];
        for (i, &vertex) in corners.iter().enumerate() {
            if vertex as usize >= points.len() {
                let vertices = points.len();
                return Err(MeshError::IndexOutOfRange { triangle: Some(t), vertex, vertices });
            }
            if vertex == corners[(i + 1) % 3] {
                return Err(MeshError::RepeatedVertex { triangle: t, vertex });
            }
        }
    }
    if let Some(&vertex) = fixed.iter().find(|&&v| v as usize >= points.len()) {
        let vertices = points.len();
        return Err(MeshError::IndexOutOfRange { triangle: None, vertex, vertices });
    }
    Ok(())
}

/// The first of the items that is bad.
fn first<T: Sync>(items: &[T], is_bad: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    const CHUNK: usize = 1 << 14;
    // Looking at all of a chunk goes without branches.
    let any = |chunk: &[T]| chunk.iter().fold(false, |any, item| any | is_bad(item));
    let chunk = items.par_chunks(CHUNK).position_first(any)?;
    items.iter().skip(chunk * CHUNK).position(is_bad).map(|i| chunk * CHUNK + i)
}

/// Checks that coordinates are of a size to compute with. Vertices in no triangle may be anywhere.
fn check_size(points: &[[f64; 2]], stars: &Groups) -> Result<(), MeshError> {
    let size = |(v, p): (usize, &[f64; 2])| match stars.of(v) {
        [] => 0.0,
        _ => p[0].abs().max(p[1].abs()),
    };
    let size = points.par_iter().enumerate().map(size).reduce(|| 0.0, f64::max);
    match size {
        1e-100..=1e100 => Ok(()),
        _ => Err(MeshError::OutOfRange { size }),
    }
}

/// The triangle across each edge (corner i to corner i + 1) of each triangle, or `NONE`.
fn neighbors(triangles: &[[u32; 3]], stars: &Groups) -> Result<Vec<[u32; 3]>, MeshError> {
    let across = |(t, corners): (usize, &[u32; 3])| {
        let mut found = [NONE; 3];
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let at_edge = |&&o: &&u32| o as usize != t && triangles[o as usize].contains(&b);
            let mut others = stars.of(a as usize).iter().filter(at_edge);
            if let Some(&other) = others.next() {
                found[i] = other;
                if others.next().is_some() {
                    let all = stars.of(a as usize).iter().map(|&o| o as usize);
                    let mut triangles: Vec<_> =
                        all.filter(|&o| triangles[o].contains(&b)).collect();
                    triangles.sort_unstable();
                    return Err(MeshError::EdgeOfThree { edge: [a, b], triangles });
                }
            }
        }
        Ok(found)
    };
    triangles.par_iter().enumerate().map(across).collect()
}

/// Whether a triangle's corners run from a to b somewhere.
fn runs(corners: &[u32; 3], a: u32, b: u32) -> bool {
    (0..3).any(|i| corners[i] == a && corners[(i + 1) % 3] == b)
}

/// The triangles with windings made consistent across edges, each edge-connected part
/// counter-clockwise on the whole.
fn wind(points: &[[f64; 2]], triangles: &[[u32; 3]], across: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut wound = triangles.to_vec();
    let mut seen = vec![false; triangles.len()];
    let mut part = Vec::new();
    for seed in 0..triangles.len() {
        if seen[seed] {
            continue;
        }
        seen[seed] = true;
        part.clear();
        part.push(seed as u32);
        let mut doubled_area = 0.0;
        let mut next = 0;
        while let Some(&t) = part.get(next) {
            next += 1;
            let corners = wound[t as usize];
            doubled_area += validity::doubled_area(points, &corners);
            // `across` belongs to the corners as given; a swap of the last two reverses its order.
            let given = triangles[t as usize];
            for (i, &other) in across[t as usize].iter().enumerate() {
                if other == NONE || seen[other as usize] {
                    continue;
                }
                let (mut a, mut b) = (given[i], given[(i + 1) % 3]);
                if corners != given {
                    (a, b) = (b, a);
                }
                if runs(&wound[other as usize], a, b) {
                    wound[other as usize].swap(1, 2);
                }
                seen[other as usize] = true;
                part.push(other);
            }
        }
        if doubled_area < 0.0 {
            for &t in &part {
                wound[t as usize].swap(1, 2);
            }
        }
    }
    wound
}

/// Whether every triangle is counter-clockwise, to rounding.
fn are_positive(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> bool {
    triangles.par_iter().with_min_len(1 << 12).all(|t| validity::doubled_area(points, t) > 0.0)
}

/// The triangles at each vertex, in ascending order.
fn stars(vertices: usize, triangles: &[[u32; 3]]) -> Groups {
    Groups::new(triangles.len(), vertices, |t| triangles[t])
}

/// Notes in `closed` around which vertices the triangles close one cycle, and sorts those of each by it. False, with
/// notes of no use, if two triangles run along one edge in the same direction: then windings differ, or more than
/// two triangles meet.
fn close(triangles: &[[u32; 3]], stars: &mut Groups, closed: &mut [bool]) -> bool {
    const CHUNK: usize = 1 << 12;
    let stars = stars.chunks_mut(CHUNK).into_par_iter();
    stars
        .zip(closed.par_chunks_mut(CHUNK))
        .enumerate()
        .map(|(chunk, ((bounds, stars), closed))| {
            let mut edges = Vec::new();
            let mut consistent = true;
            for (i, closed) in closed.iter_mut().enumerate() {
                let vertex = (chunk * CHUNK + i) as u32;
                let star = (bounds[i] - bounds[0]) as usize..(bounds[i + 1] - bounds[0]) as usize;
                let star = &mut stars[star];
                outer_edges(triangles, star, vertex, &mut edges);
                *closed = chain(&mut edges);
                if *closed {
                    for (t, edge) in star.iter_mut().zip(&edges) {
                        *t = edge.triangle;
                    }
                } else {
                    // Those of a cycle are all different.
                    consistent &= are_different(&edges);
                }
            }
            consistent
        })
        .reduce(|| true, |a, b| a && b)
}

/// The edge of a triangle that does not touch one of its vertices.
#[derive(Clone, Copy, Default)]
struct OuterEdge {
    from: u32,
    to: u32,
    triangle: u32,
}

/// The ends of a triangle's edge that does not touch the vertex. Without branches: which corner it is nobody foretells.
#[inline]
fn outer_edge(corners: &[u32; 3], vertex: u32) -> (u32, u32) {
    let [is_a, is_b, is_c] = corners.map(|corner| usize::from(corner == vertex));
    (corners[is_a + 2 * is_b], corners[2 * is_a + is_c])
}

/// The edges of a vertex's triangles that do not touch it, in the order of the triangles.
#[inline]
fn outer_edges(triangles: &[[u32; 3]], star: &[u32], vertex: u32, edges: &mut Vec<OuterEdge>) {
    edges.clear();
    edges.extend(star.iter().map(|&triangle| {
        let (from, to) = outer_edge(&triangles[triangle as usize], vertex);
        OuterEdge { from, to, triangle }
    }));
}

/// Sorts edges into one cycle of three or more, each from where the one before it ends; false if they
/// make none.
fn chain(edges: &mut [OuterEdge]) -> bool {
    match edges.len() {
        0..3 => false,
        3..=FEW => chain_few(edges),
        _ => chain_many(edges),
    }
}

/// Edges that are compared all at once.
const FEW: usize = 8;

fn chain_few(edges: &mut [OuterEdge]) -> bool {
    let mut from = [NONE; FEW];
    for (from, edge) in from.iter_mut().zip(&*edges) {
        *from = edge.from;
    }
    // Of the edges that start where another ends: their number times FEW, and the sum of their places.
    let after = |edge: &OuterEdge| {
        let found = |k: usize| if from[k] == edge.to { FEW + k } else { 0 };
        (0..FEW).map(|k| found(k) as u32).sum::<u32>()
    };
    let mut next = [0; FEW];
    let mut single = true;
    for (next, edge) in next.iter_mut().zip(&*edges) {
        let after = after(edge);
        single &= after / FEW as u32 == 1;
        *next = after as usize % FEW;
    }
    if !single {
        return false;
    }
    let mut sorted = [OuterEdge::default(); FEW];
    let mut at = 0;
    for (i, to) in sorted[..edges.len()].iter_mut().enumerate() {
        // Back at the first before all were met.
        if i > 0 && at == 0 {
            return false;
        }
        *to = edges[at];
        at = next[at];
    }
    edges.copy_from_slice(&sorted[..edges.len()]);
    at == 0
}

fn chain_many(edges: &mut [OuterEdge]) -> bool {
    let first = edges[0].from;
    for next in 1..edges.len() {
        let at = edges[next - 1].to;
        let Some(found) = edges[next..].iter().position(|e| e.from == at) else {
            return false;
        };
        edges.swap(next, next + found);
        let again = edges[next + 1..].iter().any(|e| e.from == at);
        if again || at == first {
            return false;
        }
    }
    edges[edges.len() - 1].to == first
}

/// Whether no two edges start at one vertex, nor end at one.
fn are_different(edges: &[OuterEdge]) -> bool {
    let alike = |a: &OuterEdge, b: &OuterEdge| a.from == b.from || a.to == b.to;
    edges.iter().enumerate().all(|(i, a)| edges[i + 1..].iter().all(|b| !alike(a, b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square with its center, counter-clockwise but for the third triangle.
    fn fan() -> Mesh {
        Mesh {
            points: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.9]],
            triangles: vec![[0, 1, 4], [1, 2, 4], [2, 4, 3], [3, 0, 4]],
            fixed: vec![],
        }
    }

    #[test]
    fn mixed_windings_are_normalized() {
        let mut mesh = fan();
        let topology = Topology::new(&mesh).unwrap();
        assert_eq!(topology.triangles()[2], [2, 3, 4]);
        assert_eq!(topology.free(), [false, false, false, false, true]);
        assert_eq!(topology.ring(4), [0, 1, 2, 3]);
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let clockwise = Topology::new(&mesh).unwrap();
        assert!(validity::check(&mesh.points, clockwise.triangles()).is_ok());
    }

    #[test]
    fn constraint_vertices_are_not_free() {
        let mesh = Mesh { fixed: vec![4], ..fan() };
        let topology = Topology::new(&mesh).unwrap();
        let error = topology.check_smoothable(&mesh.points).unwrap_err();
        assert_eq!(error, MeshError::NothingFree { vertices: 5 });
    }

    #[test]
    fn folds_and_flat_triangles_are_refused() {
        let mut mesh = fan();
        let refusal =
            |mesh: &Mesh| Topology::new(mesh).unwrap().check_smoothable(&mesh.points).unwrap_err();
        mesh.points[4] = [1.0, -0.5];
        let error = refusal(&mesh);
        let vertices = [0, 1, 4];
        assert_eq!(error, MeshError::Infeasible { count: 1, first: 0, vertices, flat: false });
        mesh.points[4] = [1.0, 0.0];
        let error = refusal(&mesh);
        assert_eq!(error, MeshError::Infeasible { count: 1, first: 0, vertices, flat: true });
    }

    #[test]
    fn an_edge_of_three_triangles_is_refused() {
        let mut mesh = fan();
        mesh.triangles.push([0, 4, 2]);
        let error = Topology::new(&mesh).unwrap_err();
        assert!(
            matches!(error, MeshError::EdgeOfThree { ref triangles, .. } if triangles.len() == 3)
        );
    }

    #[test]
    fn bad_indices_are_refused() {
        let mut mesh = fan();
        mesh.triangles[1][2] = 9;
        let error = Topology::new(&mesh).unwrap_err();
        let expected = MeshError::IndexOutOfRange { triangle: Some(1), vertex: 9, vertices: 5 };
        assert_eq!(error, expected);
        mesh.triangles[1] = [1, 2, 1];
        let error = Topology::new(&mesh).unwrap_err();
        assert_eq!(error, MeshError::RepeatedVertex { triangle: 1, vertex: 1 });
        mesh = fan();
        mesh.points[3][1] = 1e200;
        assert_eq!(Topology::new(&mesh).unwrap_err(), MeshError::OutOfRange { size: 1e200 });
        mesh.points[3][1] = f64::NAN;
        assert_eq!(Topology::new(&mesh).unwrap_err(), MeshError::NotFinite { vertex: 3 });
    }

    #[test]
    fn a_vertex_joining_two_fans_stays() {
        // Two closed fans around one vertex cannot lie flat without overlap, but their topology
        // must not make a ring of either half.
        let ring_of = |triangles: &[[u32; 3]]| {
            let mut edges = Vec::new();
            outer_edges(triangles, stars(7, triangles).of(0), 0, &mut edges);
            chain(&mut edges).then(|| edges.iter().map(|e| e.from).collect::<Vec<_>>())
        };
        let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [0, 4, 5], [0, 5, 6], [0, 6, 4]];
        assert_eq!(ring_of(&triangles), None);
        assert_eq!(ring_of(&triangles[..3]), Some(vec![1, 2, 3]));
    }
}
