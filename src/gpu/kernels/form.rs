//! The form of a mesh on a device, for which kernels are composed.

use crate::layout::MapKind;

/// The bindings by which kernels access the positions of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Positions {
    /// One binding of the whole buffer.
    Whole,
    /// Two bindings, of high parts and of low parts, for a buffer larger than the device binds at once.
    InTwo,
}

impl Positions {
    pub(crate) const ALL: [Self; 2] = [Positions::Whole, Positions::InTwo];

    /// Returns the bindings that this number of positions needs under these limits.
    pub(crate) fn of(vertices: usize, limits: &wgpu::Limits) -> Self {
        let bytes = (vertices as u64).saturating_mul(size_of::<[f32; 4]>() as u64);
        let fits = bytes <= limits.max_storage_buffer_binding_size;
        if fits { Positions::Whole } else { Positions::InTwo }
    }
}

/// Properties of a mesh on a device that change the source of kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MeshForm {
    pub(crate) positions: Positions,
    /// Kind of the maps that follow the positions in their buffer.
    pub(crate) maps: MapKind,
    /// Whether discs or a least altitude bound the free vertices. The discs follow the maps.
    pub(crate) is_bounded: bool,
    /// Whether the one-rings have opposite vertices of quadrilaterals. A kernel that goes over a list of elements then takes the
    /// list of quadrilaterals, four numbers each; [`Self::of_triangles`] is the form for the list of triangles.
    pub(crate) has_quadrilaterals: bool,
}

impl MeshForm {
    /// Returns the form of the kernels that go over the list of triangles.
    pub(crate) fn of_triangles(self) -> Self {
        Self { has_quadrilaterals: false, ..self }
    }
}

impl From<Positions> for MeshForm {
    /// Returns the form of a mesh without maps and bounds.
    fn from(positions: Positions) -> Self {
        Self { positions, maps: MapKind::None, is_bounded: false, has_quadrilaterals: false }
    }
}
