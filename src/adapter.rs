//! The description of an adapter.

/// An adapter of the machine: its name, driver, backend and kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// The adapter's name, for example that of the graphics card; "unnamed adapter" if a browser withholds the name.
    pub name: String,
    /// Driver and version.
    pub driver: String,
    /// wgpu's backend: vulkan, metal, dx12 or gl.
    pub backend: String,
    /// "discrete GPU", "integrated GPU", "virtual GPU", "CPU" (software) or "other".
    pub kind: &'static str,
}

impl AdapterSummary {
    /// Returns whether the driver computes on the CPU, as Mesa's lavapipe does.
    pub fn is_software(&self) -> bool {
        self.kind == "CPU"
    }
}
