//! The numbers of vertices and elements in a `Problem`.

use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

use crate::layout::{Coloring, UNCOLORED};
use crate::parallel::counting_sort::{atomics, place, plain, running_sum, split};
use crate::parallel::{collect, for_each_chunk, for_each_part, map_ranges};
use crate::topology::{Corners, Topology};

/// Marks the vertex of a one-ring that is opposite to the visited vertex in a quadrilateral.
pub(crate) const OPPOSITE: u32 = 1 << 31;
/// Number of vertices or elements that one task handles.
const CHUNK: usize = 1 << 12;
/// Number of vertices in a block. Blocks are sorted by degree, so that vertices visited at once have equally many
/// neighbors and elements of the same kinds. Larger blocks let more vertices meet others of equal degree; smaller blocks keep vertices closer
/// together.
pub(crate) const DEGREE_BLOCK: usize = 512;
/// Number of vertices per task when vertices are sorted by color. Larger than [`CHUNK`], as every task has a counter
/// for each color.
const LONG: usize = 1 << 14;

/// Returns the one-rings of the free `vertices`, by new indices, in compressed rows: the start of each row with the
/// total length at the end, and all rows; see [`Problem::ring`](super::Problem::ring).
pub(super) fn rings(
    topology: &Topology<'_>,
    vertices: &[u32],
    curve: &[u32],
    number: &[u32],
) -> (Vec<u32>, Vec<u32>) {
    let length = |i| vertices.get(i).map_or(0, |&v: &u32| key(topology, v).0 as u32);
    let mut start = collect(vertices.len() + 1, length);
    let end = running_sum(&mut start, |start| start);
    let ring = atomics(end as usize, 0);
    let has_quadrilaterals = topology.corner_list().quadrilateral_count() > 0;
    // Rows are filled along the curve: most elements around a vertex are also around the vertices before it, so they
    // are in the cache. No two tasks write the same entry; entries are atomic only because the rows of a task are
    // scattered.
    for_each_part(curve.chunks(CHUNK), |_, chunk| {
        for &v in chunk.iter().filter(|&&v| topology.free()[v as usize]) {
            let row = &ring[start[number[v as usize] as usize] as usize..];
            if has_quadrilaterals {
                for (to, (from, is_opposite)) in row.iter().zip(turned(topology, v)) {
                    let mark = if is_opposite { OPPOSITE } else { 0 };
                    to.store(number[from as usize] | mark, Relaxed);
                }
                continue;
            }
            for (to, from) in row.iter().zip(topology.ring_of(v)) {
                to.store(number[from as usize], Relaxed);
            }
        }
    });
    (start, plain(ring))
}

/// Returns the vertices around a free vertex, with marks of opposite vertices, from the neighbor at which the pattern of marks is
/// least. Vertices of equal elements in another order then have equal patterns.
fn turned(topology: &Topology<'_>, vertex: u32) -> Vec<(u32, bool)> {
    let mut around: Vec<(u32, bool)> = topology.around(vertex).collect();
    // The least pattern begins without a mark, and so at a neighbor.
    let least = least_turn(&around, |&(_, is_opposite)| is_opposite);
    around.rotate_left(least);
    around
}

/// Returns the first place from which the marks of a ring are least, in a time proportional to the length of the ring (after
/// Shiloach, Fast canonization of circular strings, J. Algorithms 2, 1981).
fn least_turn<X>(ring: &[X], mark: impl Fn(&X) -> bool) -> usize {
    let count = ring.len();
    let at = |turn: usize, k: usize| mark(&ring[(turn + k) % count]);
    // No place before either candidate, but for the other, is the first least.
    let (mut one, mut other, mut equal) = (0, 1, 0);
    while one < count && other < count && equal < count {
        match (at(one, equal), at(other, equal)) {
            (true, false) => one += equal + 1,
            (false, true) => other += equal + 1,
            _ => {
                equal += 1;
                continue;
            }
        }
        other += usize::from(one == other);
        equal = 0;
    }
    one.min(other)
}

/// Returns the length of the list of a free vertex in the rings, and its pattern: a bit for each of its first 64 entries, 1 for
/// an opposite vertex. Only the number of elements counts for other vertices.
fn key(topology: &Topology<'_>, vertex: u32) -> (usize, u64) {
    let degree = topology.star(vertex).len();
    if topology.corner_list().quadrilateral_count() == 0 || !topology.free()[vertex as usize] {
        return (degree, 0);
    }
    let around = turned(topology, vertex);
    let bits = around.iter().take(64).map(|&(_, is_opposite)| u64::from(is_opposite));
    (around.len(), bits.fold(0, |pattern, bit| pattern << 1 | bit))
}

/// Returns all elements by the new indices of their `vertices` vertices, each kind sorted by the least vertex. Elements so
/// follow the vertices along the curve, which keeps reads for the objective in the cache, and their order does not
/// depend on that of the mesh.
pub(super) fn elements(
    topology: &Topology<'_>,
    vertices: usize,
    number: &[u32],
) -> Corners<'static> {
    let triangles = topology.triangles();
    let triangles = sorted(triangles.len(), vertices, |t| triangles[t].map(|v| number[v as usize]));
    let corners = topology.corner_list();
    let quadrilateral = |index| {
        let mut quadrilateral = corners.quadrilateral(index).map(|v| number[v as usize]);
        let least = (0..4).min_by_key(|&k| quadrilateral[k]).unwrap_or(0);
        quadrilateral.rotate_left(least);
        quadrilateral
    };
    let count = corners.quadrilateral_count();
    Corners::of_lists(triangles, &sorted(count, vertices, quadrilateral))
}

/// Returns `count` elements sorted by their least vertex. `vertices` is an upper limit of vertex numbers, exclusive.
fn sorted<const N: usize>(
    count: usize,
    vertices: usize,
    element: impl Fn(usize) -> [u32; N] + Sync,
) -> Vec<[u32; N]> {
    let least = |element: &[u32; N]| element[1..].iter().fold(element[0], |a, &b| a.min(b));
    let all = atomics(N * count, 0);
    let keys = |t| [least(&element(t))];
    place(count, vertices, keys, |t, at| {
        for (corner, to) in element(t).into_iter().zip(&all[N * at..]) {
            to.store(corner, Relaxed);
        }
    });
    let given = all;
    let mut all = vec![[0; N]; count];
    for_each_chunk(&mut all, CHUNK, |first, chunk| {
        for (element, from) in chunk.iter_mut().zip(given[N * first..].chunks_exact(N)) {
            *element = std::array::from_fn(|i| from[i].load(Relaxed));
        }
    });
    // The list is cut into chunks whose elements are then sorted. No chunk ends between two elements with equal least
    // vertices.
    let mut rest = &mut all[..];
    let runs = std::iter::from_fn(|| {
        let mut end = rest.len().min(CHUNK);
        while end > 0 && end < rest.len() && least(&rest[end - 1]) == least(&rest[end]) {
            end += 1;
        }
        rest.split_off_mut(..end).filter(|runs| !runs.is_empty())
    });
    for_each_part(runs, |_, runs| {
        runs.chunk_by_mut(|a, b| least(a) == least(b)).for_each(<[_]>::sort_unstable);
    });
    all
}

/// Returns the vertices in the order that `Problem` documents, and the range of each color.
pub(super) fn order(
    topology: &Topology<'_>,
    coloring: &Coloring,
    curve: &[u32],
) -> (Vec<u32>, Vec<Range<u32>>) {
    let colors = coloring.count() as usize;
    // Fixed vertices have no color and come last.
    let slot = |v: u32| match coloring.colors()[v as usize] {
        UNCOLORED => colors,
        color => color as usize,
    };
    let counts: Vec<Vec<usize>> = map_ranges(curve.len(), LONG, |range| {
        let mut counts = vec![0; colors + 1];
        curve[range].iter().for_each(|&v| counts[slot(v)] += 1);
        counts
    });
    // Within a color, the vertices of each chunk follow the vertices of the previous chunk.
    let mut vertices = vec![0; curve.len()];
    let lengths = (0..=colors).flat_map(|color| counts.iter().map(move |counts| counts[color]));
    let mut targets: Vec<Vec<&mut [u32]>> = counts.iter().map(|_| Vec::new()).collect();
    for (i, part) in split(&mut vertices, lengths).into_iter().enumerate() {
        targets[i % counts.len()].push(part);
    }
    for_each_part(curve.chunks(LONG).zip(targets), |_, (chunk, mut targets)| {
        for &v in chunk {
            if let Some(to) = targets[slot(v)].split_off_first_mut() {
                *to = v;
            }
        }
    });
    let mut rest = &mut vertices[..];
    let mut ranges = Vec::new();
    let mut end = 0;
    for color in 0..=colors {
        let length = counts.iter().map(|counts| counts[color]).sum();
        ranges.push(end..end + length as u32);
        end += length as u32;
        let color = rest.split_off_mut(..length).unwrap_or_default();
        for_each_chunk(color, DEGREE_BLOCK, |_, block| {
            let mut keyed = [((0, 0), 0); DEGREE_BLOCK];
            let keyed = &mut keyed[..block.len()];
            for (keyed, &v) in keyed.iter_mut().zip(&*block) {
                *keyed = (key(topology, v), v);
            }
            keyed.sort_by_key(|&(key, _)| key);
            for (vertex, &(_, v)) in block.iter_mut().zip(&*keyed) {
                *vertex = v;
            }
        });
    }
    ranges.truncate(colors);
    (vertices, ranges)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_turn_is_the_first_of_all_turns_that_are_least() {
        for count in 1..14 {
            for pattern in 0..1_u32 << count {
                let ring: Vec<bool> = (0..count).map(|k| pattern >> k & 1 == 1).collect();
                let turned = |turn: usize| {
                    let (before, after) = ring.split_at(turn);
                    [after, before].concat()
                };
                let expected = (0..ring.len()).min_by_key(|&turn| turned(turn));
                assert_eq!(Some(least_turn(&ring, |&mark| mark)), expected, "{ring:?}");
            }
        }
    }
}
