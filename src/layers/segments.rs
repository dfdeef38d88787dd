//! Distances from many segments.

use crate::layers::vector::{distance_to_segment, length};

/// A tree of segments: each node has the box of its segments.
pub(super) struct Segments {
    segments: Vec<[[f64; 2]; 2]>,
    /// The boxes of the tree: node `i` has the children `2 i` and `2 i + 1`, and leaves are the segments, by their order.
    boxes: Vec<[[f64; 2]; 2]>,
    leaves: usize,
}

impl Segments {
    pub(super) fn new(segments: Vec<[[f64; 2]; 2]>) -> Self {
        let leaves = segments.len().next_power_of_two();
        let nothing = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let mut boxes = vec![nothing; 2 * leaves];
        for (i, [p, q]) in segments.iter().enumerate() {
            boxes[leaves + i] = [[0, 1].map(|k| p[k].min(q[k])), [0, 1].map(|k| p[k].max(q[k]))];
        }
        for i in (1..leaves).rev() {
            let [a, b] = [boxes[2 * i], boxes[2 * i + 1]];
            boxes[i] = [[0, 1].map(|k| a[0][k].min(b[0][k])), [0, 1].map(|k| a[1][k].max(b[1][k]))];
        }
        Self { segments, boxes, leaves }
    }

    /// Returns whether a point is within a distance of a segment.
    pub(super) fn are_within(&self, point: [f64; 2], distance: f64) -> bool {
        let mut open = vec![1];
        while let Some(node) = open.pop() {
            let [low, high] = self.boxes[node];
            let outside = [0, 1].map(|k| (low[k] - point[k]).max(point[k] - high[k]).max(0.0));
            let is_near = length(outside) <= distance;
            if is_near && node < self.leaves {
                open.extend([2 * node + 1, 2 * node]);
            }
            // Leaves behind the last segment have no segment.
            let segment = node.checked_sub(self.leaves).and_then(|leaf| self.segments.get(leaf));
            if is_near && segment.is_some_and(|&own| distance_to_segment(point, own) <= distance) {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree without segments has a leaf without a segment, whose box is infinitely far away.
    #[test]
    fn no_segment_is_within_any_distance() {
        let trees = [Vec::new(), vec![[[0.0; 2], [1.0, 0.0]]; 3]].map(Segments::new);
        for (distance, expected) in
            [(f64::INFINITY, [false, true]), (f64::NAN, [false; 2]), (1.0, [false; 2])]
        {
            let found = [0, 1].map(|tree| trees[tree].are_within([9.0, 9.0], distance));
            assert_eq!(found, expected, "{distance}");
        }
    }
}
