//! The report on the targets of elements.

use gpu_smooth::targets::Surface;
use gpu_smooth_job::TargetKind;
use serde::Serialize;

use crate::error::CliError;
use crate::request::TargetRequest;

/// The target of the elements, with objectives under the target maps.
#[derive(Serialize)]
pub(crate) struct TargetReport {
    /// `equilateral`, `keep-size`, `keep-shape`, `size=SOURCE` or `metric=SOURCE`.
    pub(crate) kind: String,
    /// `vertex` if targets move with the vertices, or `place`.
    pub(crate) of: &'static str,
    /// `plane` or `sphere`.
    pub(crate) surface: &'static str,
    /// Number of rings of neighbors over which sizes and shapes of the mesh were averaged; `None` for other
    /// targets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rings: Option<u32>,
    /// Factor of the term of size in the base metric; `None` for targets other than `keep-size`, and for metrics without
    /// this factor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_weight: Option<f64>,
    /// The base metric's objective of triangles under the target maps, before and after.
    pub(crate) f: [f64; 2],
}

impl TargetRequest {
    /// Returns the report on targets; `None` if elements are to be equilateral in the plane. `f` returns the objectives under
    /// the target maps before and after.
    pub(crate) fn report(
        &self,
        surface: Surface,
        size_weight: Option<f64>,
        f: impl FnOnce() -> Result<[f64; 2], CliError>,
    ) -> Result<Option<TargetReport>, CliError> {
        if self.kind == TargetKind::Equilateral && surface == Surface::Plane {
            return Ok(None);
        }
        let kind = self.name();
        let f = f()?;
        let surface = match surface {
            Surface::Plane => "plane",
            Surface::Sphere => "sphere",
        };
        let of = if self.is_of_places() { "place" } else { "vertex" };
        Ok(Some(TargetReport { kind, of, surface, rings: self.rings(), size_weight, f }))
    }
}
