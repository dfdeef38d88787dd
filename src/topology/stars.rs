//! Stars: the corners at each vertex, and whether their elements form a cycle around the vertex.

use crate::mesh::Element;
use crate::parallel::counting_sort::Groups;
use crate::parallel::map_parts;
use crate::topology::corners::Corners;

/// Returns the corners at each vertex as ascending indices: all triangles with the vertex, and the corners of quadrilaterals
/// with this first vertex.
pub(crate) fn stars(vertices: usize, corners: &Corners<'_>) -> Groups {
    let (all, triangles) = (corners.all(), corners.triangles().len());
    if all.len() == triangles {
        return Groups::new(triangles, vertices, |t| all[t]);
    }
    let keys = |corner: usize| {
        let count = if corner < triangles { 3 } else { 1 };
        all[corner].into_iter().take(count)
    };
    Groups::of_keys(all.len(), 2 * triangles + all.len(), vertices, keys)
}

/// Returns the elements at the edge between the vertices `a` and `b`, other than that with the first corner `element`, by
/// their first corners.
///
/// Searches the star of the vertex that has fewer elements. For all edges of a planar mesh this takes linear time,
/// however many elements some vertices have (Chiba & Nishizeki, SIAM J. Comput. 14, 1985).
pub(crate) fn others_at_edge<'a>(
    corners: &'a Corners<'_>,
    stars: &'a Groups,
    element: u32,
    [a, b]: [u32; 2],
) -> impl Iterator<Item = u32> + 'a {
    let (at_a, at_b) = (stars.of(a as usize), stars.of(b as usize));
    let (star, end) = if at_a.len() <= at_b.len() { (at_a, b) } else { (at_b, a) };
    let has_edge = move |&&corner: &&u32| corners.all()[corner as usize].contains(&end);
    let firsts = star.iter().filter(has_edge).map(|&corner| corners.first(corner));
    firsts.filter(move |&first| first != element)
}

/// Sets `closed` for the vertices around which the elements form one cycle, and sorts the stars of these vertices in
/// the order of the cycle. Returns false if two elements have an edge in the same direction: either windings are
/// inconsistent, or more than two elements share the edge. `closed` is then not valid. `triangles` are all corners.
pub(crate) fn close(triangles: &[[u32; 3]], stars: &mut Groups, closed: &mut [bool]) -> bool {
    const CHUNK: usize = 1 << 12;
    let parts = stars.chunks_mut(CHUNK).into_iter().zip(closed.chunks_mut(CHUNK));
    let consistent = map_parts(parts, |chunk, ((bounds, stars), closed)| {
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
                // Edges of a cycle always differ, so the test is needed only here.
                consistent &= are_different(&edges);
            }
        }
        consistent
    });
    !consistent.contains(&false)
}

/// Returns the first vertex inside a mesh with two elements alone, and these elements. Two triangles with two common edges have
/// opposite windings, so one of the elements is a quadrilateral.
pub(crate) fn doublet(
    corners: &Corners<'_>,
    stars: &Groups,
    closed: &[bool],
) -> Option<(u32, [Element; 2])> {
    if corners.of_quadrilaterals().is_empty() {
        return None;
    }
    let at = |vertex: usize| match stars.of(vertex) {
        &[one, other] if !closed[vertex] => {
            let edge = |corner: u32| outer_edge(&corners.all()[corner as usize], vertex as u32);
            let ((from, to), back) = (edge(one), edge(other));
            let elements = [one, other].map(|corner| corners.element(corner));
            (back == (to, from)).then_some((vertex as u32, elements))
        }
        _ => None,
    };
    (0..closed.len()).find_map(at)
}

/// The edge of a triangle opposite to one of its vertices, in the direction of the triangle's winding.
#[derive(Clone, Copy, Default)]
struct OuterEdge {
    from: u32,
    to: u32,
    triangle: u32,
}

/// Returns start and end of the edge of a triangle opposite to a vertex, in the direction of its winding. Computed
/// without branches, as a processor could not predict them.
#[inline]
pub(crate) fn outer_edge(corners: &[u32; 3], vertex: u32) -> (u32, u32) {
    let [is_a, is_b, is_c] = corners.map(|corner| usize::from(corner == vertex));
    (corners[is_a + 2 * is_b], corners[2 * is_a + is_c])
}

/// Replaces `edges` by the edges opposite to `vertex` in the triangles of `star`, in the order of `star`.
#[inline]
fn outer_edges(triangles: &[[u32; 3]], star: &[u32], vertex: u32, edges: &mut Vec<OuterEdge>) {
    edges.clear();
    edges.extend(star.iter().map(|&triangle| {
        let (from, to) = outer_edge(&triangles[triangle as usize], vertex);
        OuterEdge { from, to, triangle }
    }));
}

/// Sorts edges into one cycle of three or more, in which each edge starts where the previous edge ends. Returns false,
/// with the edges unsorted, if they do not form one cycle.
fn chain(edges: &mut [OuterEdge]) -> bool {
    match edges.len() {
        0..3 => false,
        3..=MAX_PAIRWISE => chain_few(edges),
        _ => chain_many(edges),
    }
}

/// Largest number of edges for which [`chain_few`] compares all pairs.
const MAX_PAIRWISE: usize = 8;

/// Sorts at most [`MAX_PAIRWISE`] edges into a cycle; see [`chain`].
fn chain_few(edges: &mut [OuterEdge]) -> bool {
    // Unused entries hold a number that no vertex has.
    let mut from = [u32::MAX; MAX_PAIRWISE];
    for (from, edge) in from.iter_mut().zip(&*edges) {
        *from = edge.from;
    }
    // For the edges that start where `edge` ends: `MAX_PAIRWISE` times their number, plus the sum of their indices.
    let after = |edge: &OuterEdge| {
        let found = |k: usize| if from[k] == edge.to { MAX_PAIRWISE + k } else { 0 };
        (0..MAX_PAIRWISE).map(|k| found(k) as u32).sum::<u32>()
    };
    let mut next = [0; MAX_PAIRWISE];
    let mut single = true;
    for (next, edge) in next.iter_mut().zip(&*edges) {
        let after = after(edge);
        single &= after / MAX_PAIRWISE as u32 == 1;
        *next = after as usize % MAX_PAIRWISE;
    }
    if !single {
        return false;
    }
    let mut sorted = [OuterEdge::default(); MAX_PAIRWISE];
    let mut at = 0;
    for (i, to) in sorted[..edges.len()].iter_mut().enumerate() {
        // The path has returned to the first edge before all edges were visited.
        if i > 0 && at == 0 {
            return false;
        }
        *to = edges[at];
        at = next[at];
    }
    edges.copy_from_slice(&sorted[..edges.len()]);
    at == 0
}

/// Sorts any number of edges into a cycle; see [`chain`].
fn chain_many(edges: &mut [OuterEdge]) -> bool {
    let mut by_start = edges.to_vec();
    by_start.sort_unstable_by_key(|edge| edge.from);
    if by_start.windows(2).any(|pair| pair[0].from == pair[1].from) {
        return false;
    }
    let first = edges[0].from;
    let mut chained = Vec::with_capacity(edges.len());
    let mut at = first;
    while let Ok(i) = by_start.binary_search_by_key(&at, |edge| edge.from) {
        chained.push(by_start[i]);
        at = by_start[i].to;
        // The path has returned to the first vertex, or runs in a cycle that does not contain this vertex.
        if at == first || chained.len() == edges.len() {
            break;
        }
    }
    if at != first || chained.len() < edges.len() {
        return false;
    }
    edges.copy_from_slice(&chained);
    true
}

/// Returns whether all edges have different start vertices and different end vertices.
fn are_different(edges: &[OuterEdge]) -> bool {
    if edges.len() <= MAX_PAIRWISE {
        let alike = |a: &OuterEdge, b: &OuterEdge| a.from == b.from || a.to == b.to;
        return edges.iter().enumerate().all(|(i, a)| edges[i + 1..].iter().all(|b| !alike(a, b)));
    }
    [|edge: &OuterEdge| edge.from, |edge: &OuterEdge| edge.to].into_iter().all(|end| {
        let mut ends: Vec<u32> = edges.iter().map(end).collect();
        ends.sort_unstable();
        ends.windows(2).all(|pair| pair[0] != pair[1])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    #[test]
    fn a_vertex_joining_two_fans_stays() {
        // Two closed fans around one vertex cannot lie flat without overlap, but their topology must not make a ring of
        // either half.
        let ring_of = |triangles: &[[u32; 3]]| {
            let mut edges = Vec::new();
            let mesh = Mesh { triangles: triangles.to_vec(), ..Mesh::default() };
            outer_edges(triangles, stars(7, &Corners::of(&mesh)).of(0), 0, &mut edges);
            chain(&mut edges).then(|| edges.iter().map(|e| e.from).collect::<Vec<_>>())
        };
        let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [0, 4, 5], [0, 5, 6], [0, 6, 4]];
        assert_eq!(ring_of(&triangles), None);
        assert_eq!(ring_of(&triangles[..3]), Some(vec![1, 2, 3]));
    }

    #[test]
    fn many_edges_are_chained_as_few_are() {
        let edge = |(triangle, (from, to))| OuterEdge { from, to, triangle };
        let edges = |pairs: &[(u32, u32)]| (0..).zip(pairs.iter().copied()).map(edge).collect();
        let cycle: Vec<(u32, u32)> = (0..20).map(|i| (i * 7 % 20, (i * 7 + 1) % 20)).collect();
        let mut chained: Vec<OuterEdge> = edges(&cycle);
        assert!(chain(&mut chained));
        assert!(chained.iter().map(|e| (e.from, e.to)).eq((0..20).map(|i| (i, (i + 1) % 20))));
        assert!(chained.iter().all(|e| cycle[e.triangle as usize] == (e.from, e.to)));

        // Edges that do not form a cycle keep all their values, in any order.
        let mut open = cycle.clone();
        open.retain(|edge| edge.0 != 7);
        let mut two = cycle.clone();
        two.iter_mut().for_each(|(_, to)| *to = if *to % 10 == 0 { (*to + 10) % 20 } else { *to });
        let mut tail = cycle.clone();
        tail.iter_mut().filter(|edge| edge.0 == 19).for_each(|edge| edge.1 = 5);
        let mut twice = cycle.clone();
        twice.push((3, 4));
        for (pairs, different) in [(open, true), (two, true), (tail, false), (twice, false)] {
            let mut kept: Vec<OuterEdge> = edges(&pairs);
            assert!(!chain(&mut kept), "{pairs:?}");
            kept.sort_unstable_by_key(|e| e.triangle);
            assert!(kept.iter().map(|e| (e.from, e.to)).eq(pairs.iter().copied()), "{pairs:?}");
            assert_eq!(are_different(&kept), different, "{pairs:?}");
        }
    }
}
