//! Ghosts of a VTK XML file: cells and points that belong to another piece of the mesh.

use super::arrays::File;
use crate::error::ReadError;
use crate::visit::ghosts::{GhostNodes, vtk_ghosts};
use crate::visit::visitor::MeshVisitor;
use std::collections::HashSet;

impl File<'_> {
    /// Visits the nodes of ghosts, and the first node of each piece if there are several. Damaged arrays are ignored.
    ///
    /// # Errors
    /// If a second reading of the cells fails.
    pub(super) fn ghosts(&self, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
        let pieces = &self.document.pieces;
        let (mut cells, mut points) = (HashSet::new(), Vec::new());
        let (mut first_cell, mut first_point) = (0, 0);
        let mut first_points = Vec::new();
        for (piece, announced) in pieces.iter().enumerate() {
            for array in self.document.arrays_of(piece) {
                let of_cells = array.section == "CellData";
                let Some(is_ghost) = vtk_ghosts(array.name.as_bytes()) else { continue };
                if array.components != 1 || !(of_cells || array.section == "PointData") {
                    continue;
                }
                let numbers = self.numbers(array).map(|own| own.numbers).unwrap_or_default();
                let first = if of_cells { first_cell } else { first_point };
                let ids = (first..).zip(numbers).filter(|&(_, number)| is_ghost(number));
                let ids = ids.map(|(id, _)| id);
                match of_cells {
                    true => cells.extend(ids),
                    false => points.extend(ids),
                }
            }
            if announced.points > 0 {
                first_points.push(first_point);
            }
            first_point += announced.points;
            first_cell += announced.cells.iter().sum::<u64>();
        }
        if first_points.len() > 1 {
            visitor.pieces(&first_points);
        }
        if !points.is_empty() {
            visitor.ghosts("ghost point", points.len() as u64, &points);
        }
        GhostNodes::of(cells).send(visitor, |visitor| self.cells(visitor))
    }
}
