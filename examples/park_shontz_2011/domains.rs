//! The six domains, whose outlines were drawn for this project, and their meshes.

use gpu_smooth::Mesh;

use super::study::{Size, Start};
use support::{Outline, distort_smooth, perturb_random, triangulate};

/// A domain, with the data of its mesh in the paper's Table 2.
pub(crate) struct Domain {
    pub(crate) name: &'static str,
    outline: &'static str,
    /// Number of vertices in the paper's mesh of the domain.
    pub(crate) vertices: usize,
    /// Number of elements in the paper's mesh of the domain.
    pub(crate) elements: usize,
}

macro_rules! domains {
    ($($name:literal $vertices:literal $elements:literal)*) => {
        /// All domains, in the paper's order.
        pub(crate) const DOMAINS: &[Domain] = &[$(Domain {
            name: $name,
            outline: include_str!(concat!("../../meshes/", $name, ".outline")),
            vertices: $vertices,
            elements: $elements,
        }),*];
    };
}

domains! {
    "airplane" 72205 143205
    "duck" 62372 123904
    "fish" 57575 114546
    "hand" 68807 136419
    "mechanic" 69904 138610
    "twoholes" 56088 111537
}

/// Number of vertices in a coarse mesh, equal to that of meshes in `meshes/`.
const COARSE: usize = 1500;

/// Amplitude of the smooth distortion. An amplitude of 1 would flatten the first triangle.
const AMPLITUDE: f64 = 0.95;

impl Domain {
    pub(crate) fn named(name: &str) -> Result<&'static Self, String> {
        DOMAINS.iter().find(|d| d.name == name).ok_or_else(|| format!("no domain '{name}'"))
    }

    /// Triangulates the domain. The result is identical in each call.
    pub(crate) fn mesh(&self, size: Size) -> Result<Mesh, String> {
        let vertices = match size {
            Size::Coarse => COARSE,
            Size::Full => self.vertices,
        };
        triangulate(&Outline::parse(self.outline)?, vertices)
    }
}

/// Displaces the interior vertices of a triangulation without inverting triangles.
pub(crate) fn started(mesh: &Mesh, start: Start) -> Mesh {
    match start {
        Start::Random => perturb_random(mesh, 1.0, 1),
        Start::Smooth => distort_smooth(mesh, AMPLITUDE),
    }
}
