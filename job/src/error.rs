//! Errors of jobs.

use std::path::PathBuf;

use gpu_smooth::SmoothError;
use gpu_smooth::topology::{BadQuadrilateral, BadTriangle};
use mesh_io::{FieldError, ReadError, SourceLocation, WriteError};

/// Error of the plane of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlaneError {
    /// The third coordinates cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The vertices do not lie in one plane.
    #[error(
        "{place}: the mesh is not planar: vertex {} is at a distance of {distance} from the plane nearest to all vertices. Curved surfaces are not smoothed",
        place.id
    )]
    NotPlanar {
        /// The vertex farthest from the plane nearest to all vertices.
        place: SourceLocation,
        /// Distance of the vertex from the plane. Not finite if a coordinate is not finite.
        distance: f64,
    },
    /// Some vertices of a mesh outside of the plane of x and y lack z.
    #[error("{}: some vertices have no z: give each vertex three coordinates", .0.display())]
    NoZ(PathBuf),
    /// The list of points does not have one entry per vertex.
    #[error(transparent)]
    Field(#[from] FieldError),
}

/// Error of a job.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// The plane of the mesh cannot be determined.
    #[error(transparent)]
    Plane(#[from] PlaneError),
    /// The mesh cannot be smoothed, or the run has failed.
    #[error("{}: {error}", path.display())]
    Smooth {
        /// The file of the mesh.
        path: PathBuf,
        /// The error of the smoother. Vertices and triangles are zero-based indices.
        #[source]
        error: SmoothError,
    },
    /// The mesh cannot be untangled.
    #[error(
        "{}: the mesh cannot be untangled: {}. Perhaps fixed vertices leave no room",
        path.display(), still_bad(left, left_quadrilaterals)
    )]
    Tangled {
        /// The file of the mesh.
        path: PathBuf,
        /// The triangles that stay inverted or flat.
        left: Vec<BadTriangle>,
        /// The corners of quadrilaterals that stay concave or flat. Both lists are empty if elements wind more than once around
        /// a vertex.
        left_quadrilaterals: Vec<BadQuadrilateral>,
    },
    /// The groups of the file cannot be read.
    #[error(transparent)]
    Groups(#[from] ReadError),
    /// The smoothed mesh cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Describes the elements that untangling leaves bad.
fn still_bad(triangles: &[BadTriangle], corners: &[BadQuadrilateral]) -> String {
    let of_triangles = format!("{} triangles stay inverted or flat", triangles.len());
    let of_corners = format!("{} corners of quadrilaterals stay concave or flat", corners.len());
    match (triangles.is_empty(), corners.is_empty()) {
        (true, true) => "elements wind more than once around a vertex".to_owned(),
        (false, true) => of_triangles,
        (true, false) => of_corners,
        (false, false) => format!("{of_triangles}, and {of_corners}"),
    }
}
