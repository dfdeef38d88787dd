//! The form of a mesh on a device, for which kernels are composed.

/// How kernels bind the positions of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Positions {
    /// As one binding.
    Whole,
    /// As two bindings, one of high parts and one of low parts, for a buffer larger than the device binds at once.
    InTwo,
}

impl Positions {
    pub(crate) const ALL: [Self; 2] = [Positions::Whole, Positions::InTwo];

    /// Returns the form that this number of positions takes.
    pub(crate) fn of(vertices: usize, limits: &wgpu::Limits) -> Self {
        let bytes = (vertices as u64).saturating_mul(size_of::<[f32; 4]>() as u64);
        let fits = bytes <= limits.max_storage_buffer_binding_size;
        if fits { Positions::Whole } else { Positions::InTwo }
    }
}

/// The form of a mesh on a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MeshForm {
    pub(crate) positions: Positions,
    /// Whether target maps follow the positions.
    pub(crate) has_targets: bool,
}

impl From<Positions> for MeshForm {
    /// The form of a mesh without targets.
    fn from(positions: Positions) -> Self {
        Self { positions, has_targets: false }
    }
}
