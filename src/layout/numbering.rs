//! The numbers of vertices and triangles in a `Problem`.

use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

use crate::layout::{Coloring, UNCOLORED};
use crate::parallel::counting_sort::{atomics, place, plain, running_sum, split};
use crate::parallel::{collect, for_each_chunk, for_each_part, map_ranges};
use crate::topology::Topology;

/// Number of vertices or triangles that one task handles.
const CHUNK: usize = 1 << 12;
/// Number of vertices in a block. Blocks are sorted by degree, so that vertices visited at once have equally many
/// neighbors. Larger blocks let more vertices meet others of equal degree; smaller blocks keep vertices closer
/// together.
pub(crate) const DEGREE_BLOCK: usize = 512;
/// Number of vertices per task when vertices are sorted by color. Larger than [`CHUNK`], as every task has a counter
/// for each color.
const LONG: usize = 1 << 14;

/// Returns the one-rings of the free `vertices`, by new indices, in compressed rows: the start of each row with the
/// total length at the end, and the neighbors of all rows.
pub(super) fn rings(
    topology: &Topology<'_>,
    vertices: &[u32],
    curve: &[u32],
    number: &[u32],
) -> (Vec<u32>, Vec<u32>) {
    let length = |i| vertices.get(i).map_or(0, |&v: &u32| topology.star(v).len() as u32);
    let mut start = collect(vertices.len() + 1, length);
    let end = running_sum(&mut start, |start| start);
    let ring = atomics(end as usize, 0);
    // Rows are filled along the curve: most triangles around a vertex are also around the vertices before it, so they
    // are in the cache. No two tasks write the same entry; entries are atomic only because the rows of a task are
    // scattered.
    for_each_part(curve.chunks(CHUNK), |_, chunk| {
        for &v in chunk.iter().filter(|&&v| topology.free()[v as usize]) {
            let row = &ring[start[number[v as usize] as usize] as usize..];
            for (to, from) in row.iter().zip(topology.ring_of(v)) {
                to.store(number[from as usize], Relaxed);
            }
        }
    });
    (start, plain(ring))
}

/// Returns all triangles by the new indices of their `vertices` vertices, sorted by their least corner. Triangles so
/// follow the vertices along the curve, which keeps reads for the objective in the cache, and their order does not
/// depend on that of the mesh.
pub(super) fn triangles(topology: &Topology<'_>, vertices: usize, number: &[u32]) -> Vec<[u32; 3]> {
    let given = topology.triangles();
    let renumbered = |t: usize| given[t].map(|v| number[v as usize]);
    let least = |t: &[u32; 3]| t[0].min(t[1]).min(t[2]);
    let all = atomics(3 * given.len(), 0);
    let keys = |t| [least(&renumbered(t))];
    place(given.len(), vertices, keys, |t, at| {
        for (corner, to) in renumbered(t).into_iter().zip(&all[3 * at..]) {
            to.store(corner, Relaxed);
        }
    });
    let mut all = collect(given.len(), |t| [0, 1, 2].map(|i| all[3 * t + i].load(Relaxed)));
    // The list is cut into chunks whose triangles are then sorted. No chunk ends between two triangles with equal least
    // corners.
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
            let mut keyed = [(0, 0); DEGREE_BLOCK];
            let keyed = &mut keyed[..block.len()];
            for (keyed, &v) in keyed.iter_mut().zip(&*block) {
                *keyed = (topology.star(v).len(), v);
            }
            keyed.sort_by_key(|&(degree, _)| degree);
            for (vertex, &(_, v)) in block.iter_mut().zip(&*keyed) {
                *vertex = v;
            }
        });
    }
    ranges.truncate(colors);
    (vertices, ranges)
}
