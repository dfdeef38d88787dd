//! Chains of lines, such as boundaries and node strings.

use std::collections::{HashMap, VecDeque};

/// Joins lines to chains, as long as possible and in either direction. Chains are sorted by the index of their first
/// line in `lines`.
pub(super) fn chains(lines: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut at: HashMap<u32, Vec<usize>> = HashMap::new();
    // Lines are popped from the end of these lists, so the first line comes first.
    for (index, &[a, b]) in lines.iter().enumerate().rev() {
        at.entry(a).or_default().push(index);
        at.entry(b).or_default().push(index);
    }
    let mut used = vec![false; lines.len()];
    let mut chains = Vec::new();
    for (index, &[a, b]) in lines.iter().enumerate() {
        if std::mem::replace(&mut used[index], true) {
            continue;
        }
        // Returns the other end of the next unused line at a vertex.
        let mut next = |vertex: u32| {
            let lines_at = at.get_mut(&vertex)?;
            while let Some(line) = lines_at.pop() {
                if !std::mem::replace(&mut used[line], true) {
                    let [a, b] = lines[line];
                    return Some(if a == vertex { b } else { a });
                }
            }
            None
        };
        let mut chain = VecDeque::from([a, b]);
        while let Some(vertex) = chain.back().and_then(|&end| next(end)) {
            chain.push_back(vertex);
        }
        while let Some(vertex) = chain.front().and_then(|&end| next(end)) {
            chain.push_front(vertex);
        }
        chains.push(chain.into());
    }
    chains
}
