//! Points and lines of a mesh that follow from its other elements.

use super::content::Content;
use crate::visit::items::CellKind;
use std::collections::{HashMap, HashSet};

/// Boundary of a mesh, and the vertices of its lines. Mesh generators write points and lines for all corners and curves of
/// a model. A format without these elements loses nothing if they are on the boundary, or at the vertices of lines, whose
/// loss is listed. A conversion lists groups of points and lines among its losses, whether their elements are implied or not.
pub(super) struct ImpliedCells {
    /// Edges of exactly one face, each with its smaller vertex first.
    boundary: HashSet<[u32; 2]>,
    /// Vertices of the boundary, of lines, and of polygons of more than four corners.
    vertices: HashSet<u32>,
}

impl ImpliedCells {
    pub(super) fn new(content: &Content) -> ImpliedCells {
        let mut vertices = HashSet::new();
        let mut edges: HashMap<[u32; 2], u32> = HashMap::new();
        for (cell, kind) in content.cells.kinds.iter().enumerate() {
            let own = content.cells.of(cell);
            if kind.dimension() == 2 {
                for (&a, &b) in own.iter().zip(own.iter().cycle().skip(1)) {
                    *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
                }
            }
            if matches!(kind, CellKind::Line | CellKind::Polygon) {
                vertices.extend(own);
            }
        }
        let boundary: HashSet<[u32; 2]> =
            edges.into_iter().filter(|(_, uses)| *uses == 1).map(|(edge, _)| edge).collect();
        vertices.extend(boundary.iter().flatten());
        ImpliedCells { boundary, vertices }
    }

    /// Returns whether a cell is a point on the boundary or on lines, or a line on the boundary.
    pub(super) fn has(&self, content: &Content, cell: usize) -> bool {
        match (content.cells.kinds[cell], content.cells.of(cell)) {
            (CellKind::Point, [vertex]) => self.vertices.contains(vertex),
            (CellKind::Line, &[a, b]) => self.boundary.contains(&[a.min(b), a.max(b)]),
            _ => false,
        }
    }
}

/// Returns whether a group has all elements of a dimension from 1 to 2, and for lines the whole boundary, without other lines.
pub(super) fn is_of_all(content: &Content, group: u32, dimension: u8) -> bool {
    let cells = &content.cells;
    let mut own = (0..cells.len()).filter(|&cell| cells.kinds[cell].dimension() == dimension);
    let has_group = |cell: usize| content.sets[cells.sets[cell] as usize].contains(&group);
    let is_whole = |lines: &[usize]| {
        let edge = |&line: &usize| match cells.of(line) {
            &[a, b] => [a.min(b), a.max(b)],
            _ => [0; 2],
        };
        ImpliedCells::new(content).boundary == lines.iter().map(edge).collect()
    };
    match dimension {
        2 => own.all(has_group),
        1 => {
            let lines: Vec<usize> = own.collect();
            lines.iter().all(|&line| has_group(line)) && is_whole(&lines)
        }
        _ => false,
    }
}
