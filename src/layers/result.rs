//! The layers of a mesh.

use crate::topology::Topology;

/// The boundary layers of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// The vertices of layers, ascending: those in rows, those on the walls below, and [`sides`](Self::sides).
    pub vertices: Vec<u32>,
    /// The vertices of walls below layers, ascending.
    pub walls: Vec<u32>,
    /// The vertices at the ends of rows on other walls, such as an inlet, ascending. They do not slide.
    pub sides: Vec<u32>,
    /// The vertices of walls at which a layer may begin, ascending, whether a layer was found there or not.
    pub seeds: Vec<u32>,
    /// Largest number of rows.
    pub rows: usize,
}

impl Layers {
    /// Returns whether the layers have all free vertices of a mesh, and at least one.
    pub fn have_all_free(&self, topology: &Topology<'_>) -> bool {
        let is_free = |v: &&u32| topology.free().get(**v as usize) == Some(&true);
        let free = self.vertices.iter().filter(is_free).count();
        free > 0 && free == topology.free_count()
    }
}
