//! The request on how meshes are read.

use mesh_io::{MeshFile, ReadOptions};

use crate::args::{Quadrilaterals, ReadArgs};

/// How meshes are read.
#[derive(Clone)]
pub(crate) struct ReadRequest {
    /// Whether corners of triangles at equal positions are joined to one vertex. STL requires
    /// joining, VTK XML allows joining, and other formats ignore the option.
    pub(crate) weld: bool,
    /// Whether a mesh may name files outside of its directory.
    pub(crate) allow_outside: bool,
    /// Name of the cell data that number the regions. `None` for the reader's choice.
    pub(crate) regions: Option<String>,
    /// Whether quadrilaterals are elements of the mesh, whose vertices may move.
    pub(crate) takes_quadrilaterals: bool,
    /// Whether quadrilaterals are elements of a mesh that has no triangle.
    pub(crate) takes_quadrilaterals_alone: bool,
}

impl ReadRequest {
    /// Returns the options by which the library reads a mesh.
    pub(crate) fn options(&self) -> ReadOptions {
        ReadOptions::new()
            .weld(self.weld)
            .allow_outside(self.allow_outside)
            .regions(self.regions.clone())
            .allow_quadrilaterals_alone(
                self.takes_quadrilaterals || self.takes_quadrilaterals_alone,
            )
    }

    /// Returns the request with quadrilaterals as elements of the mesh.
    pub(crate) fn taking_quadrilaterals(self) -> Self {
        Self { takes_quadrilaterals: true, ..self }
    }

    /// Returns the request with quadrilaterals as elements of the mesh, if the options let their vertices move.
    pub(crate) fn moving(self, quadrilaterals: Quadrilaterals) -> Self {
        Self { takes_quadrilaterals: quadrilaterals == Quadrilaterals::Move, ..self }
    }

    /// Returns the request with quadrilaterals as elements of meshes that have no triangle.
    pub(crate) fn taking_quadrilaterals_alone(self) -> Self {
        Self { takes_quadrilaterals_alone: true, ..self }
    }

    /// Returns whether the quadrilaterals of a file are elements of its mesh.
    pub(crate) fn has_elements_of(&self, file: &MeshFile) -> bool {
        self.takes_quadrilaterals || self.takes_quadrilaterals_alone && file.triangles().is_empty()
    }
}

impl From<&ReadArgs> for ReadRequest {
    fn from(args: &ReadArgs) -> Self {
        Self {
            weld: args.weld,
            allow_outside: args.allow_outside,
            regions: args.regions.clone(),
            takes_quadrilaterals: false,
            takes_quadrilaterals_alone: false,
        }
    }
}
