//! The search of layers above the walls of a mesh.

use std::collections::HashSet;

use crate::layers::elements::Elements;
use crate::layers::march::Rows;
use crate::layers::result::Layers;
use crate::layers::sectors::Sectors;
use crate::layers::{ends, front, keep, wakes};

/// A search of layers: the rows above the walls of a mesh, and the nodes that are in layers.
pub(super) struct Search {
    pub(super) sectors: Sectors,
    seeds: Vec<bool>,
    front: Vec<bool>,
    rows: Rows,
    kept: Vec<bool>,
}

impl Search {
    /// Searches the layers above the boundary and `lines`.
    pub(super) fn new(elements: &Elements<'_>, lines: &[[u32; 2]], walls: Option<&[u32]>) -> Self {
        let sectors = Sectors::new(
            elements.points,
            elements.topology.triangles(),
            &elements.all_faces(),
            lines,
        );
        let seeds = front::seeds(&sectors);
        let mut front = front::front(&sectors, &seeds);
        if let Some(walls) = walls {
            let named = on_walls(&sectors, walls);
            front.iter_mut().zip(named).for_each(|(front, named)| *front &= named);
        }
        let mut rows = Rows::new(&sectors, &front, usize::MAX);
        let mut kept = keep::kept(&rows);
        let judged = keep::judged(&sectors, &rows, &kept);
        if judged != front {
            // Rows above walls without a layer may have taken vertices of a layer.
            front = judged;
            rows = Rows::new(&sectors, &front, usize::MAX);
            kept = keep::kept(&rows);
        }
        Self { sectors, seeds, front, rows, kept }
    }

    /// Returns whether the search has found no layer.
    pub(super) fn is_empty(&self) -> bool {
        !self.front.contains(&true)
    }

    /// Returns the edges of wakes behind the walls of layers, as pairs of vertices.
    pub(super) fn wakes(&self) -> Vec<[u32; 2]> {
        wakes::wakes(&self.sectors, &self.rows, &self.kept)
    }

    /// Returns the layers.
    pub(super) fn layers(mut self) -> Layers {
        ends::add(&self.sectors, &self.rows, &mut self.kept);
        let has_kept = |row: &Vec<u32>| row.iter().any(|&n| self.kept[n as usize]);
        let deepest = self.rows.lists.iter().rposition(has_kept).unwrap_or(0);
        let sides = ends::sides(&self.sectors, &self.rows, &self.kept);
        let marked =
            Marked { seeds: &self.seeds, front: &self.front, kept: &self.kept, sides: &sides };
        marked.layers(&self.sectors, deepest)
    }
}

/// Marks the nodes of walls at the given vertices.
pub(super) fn on_walls(sectors: &Sectors, walls: &[u32]) -> Vec<bool> {
    let named: HashSet<u32> = walls.iter().copied().collect();
    let is_named = |n: u32| sectors.is_wall(n) && named.contains(&sectors.vertex[n as usize]);
    (0..sectors.len() as u32).map(is_named).collect()
}

/// Marks of nodes.
pub(super) struct Marked<'m> {
    /// Nodes of walls at which a layer may begin.
    pub(super) seeds: &'m [bool],
    /// Nodes of walls below layers.
    pub(super) front: &'m [bool],
    /// Nodes of layers, those of the front included.
    pub(super) kept: &'m [bool],
    /// Nodes of other walls at the ends of rows.
    pub(super) sides: &'m [bool],
}

impl Marked<'_> {
    /// Returns the vertices of the nodes as layers of at most `rows` rows.
    pub(super) fn layers(&self, sectors: &Sectors, rows: usize) -> Layers {
        let vertices = |marked: &dyn Fn(usize) -> bool| {
            let nodes = (0..sectors.len()).filter(|&n| marked(n));
            let mut list: Vec<u32> = nodes.map(|n| sectors.vertex[n]).collect();
            list.sort_unstable();
            list.dedup();
            list
        };
        Layers {
            vertices: vertices(&|n| self.kept[n] || self.sides[n]),
            walls: vertices(&|n| self.front[n]),
            sides: vertices(&|n| self.sides[n] && !self.front[n]),
            seeds: vertices(&|n| self.seeds[n]),
            rows,
        }
    }
}
