//! The six domains, which were drawn for this project, and their meshes.

use gpu_smooth::Mesh;

use super::study::{Size, Start};
use super::support::{Outline, distort_smooth, perturb_random, triangulate};

/// A domain and what the paper's Table 2 says of its mesh.
pub(crate) struct Domain {
    pub(crate) name: &'static str,
    outline: &'static str,
    /// The number of vertices in the paper's mesh.
    pub(crate) vertices: usize,
    /// The number of elements in the paper's mesh.
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

/// The number of vertices of a coarse mesh, as of those in `meshes/`.
const COARSE: usize = 1500;

/// The amplitude of the smooth distortion. At 1 the first triangle would be flat.
const AMPLITUDE: f64 = 0.95;

impl Domain {
    pub(crate) fn named(name: &str) -> Result<&'static Self, String> {
        DOMAINS.iter().find(|d| d.name == name).ok_or_else(|| format!("no domain '{name}'"))
    }

    /// Triangulates the domain. The result always has the same bytes.
    pub(crate) fn mesh(&self, size: Size) -> Result<Mesh, String> {
        let vertices = match size {
            Size::Coarse => COARSE,
            Size::Full => self.vertices,
        };
        triangulate(&Outline::parse(self.outline)?, vertices)
    }
}

/// Moves the interior from where the triangulation had it, without inverting a triangle.
pub(crate) fn started(mesh: &Mesh, start: Start) -> Mesh {
    match start {
        Start::Random => perturb_random(mesh, 1.0, 1),
        Start::Smooth => distort_smooth(mesh, AMPLITUDE),
    }
}
