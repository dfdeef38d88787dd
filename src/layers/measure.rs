//! Offset, height and aspect of a vertex above a row.

use crate::layers::sectors::{NONE, Sectors};
use crate::layers::vector::{cross, dot, length, minus};

/// Offset, height and aspect of a node above a node of the row below.
#[derive(Clone, Copy)]
pub(super) struct Measure {
    /// Offset along the row, as a share of the edge of the row toward which the node leans.
    pub(super) offset: f64,
    /// Height above the row, in the unit of the mesh.
    pub(super) height: f64,
    /// Mean length of the edges of the row, divided by the height.
    pub(super) aspect: f64,
    /// The neighbor along the row toward which the node leans; [`NONE`] if the row has no edge here.
    pub(super) along: u32,
}

impl Measure {
    /// Measures `node` above `parent`, whose neighbors along the row are `beside`.
    pub(super) fn new(sectors: &Sectors, node: u32, parent: u32, beside: &[u32]) -> Self {
        let from = sectors.point(parent);
        let to = minus(sectors.point(node), from);
        let (mut offset, mut along, mut height) = (f64::NEG_INFINITY, NONE, f64::INFINITY);
        let mut sum = 0.0;
        for &neighbor in beside {
            let edge = minus(sectors.point(neighbor), from);
            let size = length(edge);
            sum += size;
            let lean = dot(to, edge) / (size * size);
            if lean > offset {
                (offset, along) = (lean, neighbor);
            }
            if lean >= 0.0 || beside.len() == 1 {
                height = height.min(cross(edge, to).abs() / size);
            }
        }
        if beside.len() == 1 {
            offset = offset.abs();
        }
        if height == f64::INFINITY {
            height = length(to);
        }
        Self { offset, height, aspect: sum / beside.len() as f64 / height, along }
    }
}
