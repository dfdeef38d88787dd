//! Finds the regions of free vertices that move while the worst triangles are improved.

use crate::layout::Problem;

/// Returns the free vertices among `seeds` and in `rings` rings around them. Each edge-connected region has its own list,
/// in ascending order.
pub(crate) fn around(
    problem: &Problem,
    seeds: impl IntoIterator<Item = u32>,
    rings: u32,
) -> Vec<Vec<u32>> {
    let free = problem.free_count() as u32;
    let mut found = Vec::new();
    let mut is_in = vec![false; free as usize];
    let mut add = |v: u32, found: &mut Vec<u32>| {
        if v < free && !std::mem::replace(&mut is_in[v as usize], true) {
            found.push(v);
        }
    };
    seeds.into_iter().for_each(|v| add(v, &mut found));
    let mut ring = 0..found.len();
    for _ in 0..rings {
        for at in ring.clone() {
            problem.companions(found[at]).for_each(|v| add(v, &mut found));
        }
        ring = ring.end..found.len();
    }
    found.sort_unstable();
    let mut regions = Vec::new();
    for start in found {
        if !std::mem::replace(&mut is_in[start as usize], false) {
            continue;
        }
        let (mut region, mut done) = (vec![start], 0);
        while let Some(&v) = region.get(done) {
            done += 1;
            for next in problem.companions(v) {
                if next < free && std::mem::replace(&mut is_in[next as usize], false) {
                    region.push(next);
                }
            }
        }
        region.sort_unstable();
        regions.push(region);
    }
    regions
}
