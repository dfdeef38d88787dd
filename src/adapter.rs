//! The description of an adapter.

/// The name of an adapter, and how wgpu drives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// The name, for example of the graphics card. Browsers may keep it to themselves: "unnamed adapter" then.
    pub name: String,
    /// Driver and version.
    pub driver: String,
    /// wgpu's backend: vulkan, metal, dx12 or gl.
    pub backend: String,
    /// "discrete GPU", "integrated GPU", "virtual GPU", "CPU" (software) or "other".
    pub kind: &'static str,
}

impl AdapterSummary {
    /// Whether the driver computes on the CPU, as Mesa's lavapipe does.
    pub fn is_software(&self) -> bool {
        self.kind == "CPU"
    }
}
