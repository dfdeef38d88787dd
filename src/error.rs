//! What can go wrong, one enum per operation.

use std::path::PathBuf;
use std::{fmt, io};

/// Where in a file something stands. Displayed to follow the file's name: `:18`, or `, byte 4711`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// One-based line of a text.
    Line(usize),
    /// How many bytes of a binary file stand before it.
    Byte(usize),
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Location::Line(line) => write!(f, ":{line}"),
            Location::Byte(at) => write!(f, ", byte {at}"),
        }
    }
}

/// A mesh file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system refused.
    #[error("{}: {source}. {remedy}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
        /// What the user can do about it.
        remedy: String,
    },
    /// The content is not what the format asks for.
    #[error("{}{location}: {problem}. {remedy}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Where the offence stands.
        location: Location,
        /// What is wrong there.
        problem: String,
        /// What the user can do about it.
        remedy: String,
    },
    /// The file is readable, but in no format this program knows.
    #[error("{}: {problem}. {remedy}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What was found instead.
        problem: String,
        /// What the user can do about it.
        remedy: String,
    },
}

/// A file could not be written. Whatever stood at its place before still stands there.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system refused.
    #[error("{}: {source}. {remedy}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
        /// What the user can do about it.
        remedy: String,
    },
    /// The name asks for another format than the mesh was read in.
    #[error("{}: {problem}. {remedy}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong with the name.
        problem: String,
        /// What the user can do about it.
        remedy: String,
    },
    /// The points given do not make a mesh. A mistake of the caller, not of the user.
    #[error("{}: not written: {problem}", path.display())]
    Points {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        problem: String,
    },
}

/// A mesh that cannot be smoothed as it is. Indices are zero-based, as in [`Mesh`](crate::Mesh).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There is no triangle at all.
    #[error("the mesh has no triangles")]
    Empty,
    /// Vertices or triangle corners do not fit 32-bit indices.
    #[error(
        "{vertices} vertices and {triangles} triangles are more than 32-bit indices can number"
    )]
    TooLarge {
        /// Number of vertices.
        vertices: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// The first such vertex.
        vertex: u32,
    },
    /// A coordinate is so large, or the whole mesh so small, that products of lengths leave the range
    /// of double precision and exact predicates would not be exact.
    #[error("the coordinates are of size {size:e}, outside of 1e-100 to 1e100")]
    OutOfRange {
        /// The largest coordinate.
        size: f64,
    },
    /// A triangle or the list of fixed vertices names a vertex that does not exist.
    #[error("vertex {vertex} is used, but there are only {vertices}")]
    IndexOutOfRange {
        /// The triangle, or `None` if it is the list of fixed vertices.
        triangle: Option<usize>,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A triangle names one vertex twice.
    #[error("triangle {triangle} uses vertex {vertex} twice")]
    RepeatedVertex {
        /// The triangle.
        triangle: usize,
        /// The vertex.
        vertex: u32,
    },
    /// Three or more triangles share an edge: not a 2D mesh.
    #[error("the edge between vertices {} and {} belongs to {} triangles", edge[0], edge[1], triangles.len())]
    EdgeOfThree {
        /// The edge's vertices.
        edge: [u32; 2],
        /// Every triangle at the edge.
        triangles: Vec<usize>,
    },
    /// Some triangles are inverted against their neighbors, or flat.
    #[error("{}", listed(triangles))]
    Infeasible {
        /// All of them, ascending.
        triangles: Vec<BadTriangle>,
    },
    /// A list of positions has not one for each vertex of the mesh.
    #[error("{given} points are given for the {expected} vertices of the mesh")]
    PointCount {
        /// How many vertices the mesh has.
        expected: usize,
        /// How many points were given.
        given: usize,
    },
    /// The bound on the inverse mean ratio that [`Topology::move_clamped`](crate::Topology::move_clamped) was given
    /// is NaN.
    #[error(
        "the bound on the inverse mean ratio is NaN: it must be a number, or infinite for no bound"
    )]
    BoundNotANumber,
    /// Every vertex is on the boundary, on a constraint line or unused.
    #[error("none of the {vertices} vertices is free to move")]
    NothingFree {
        /// Number of vertices.
        vertices: usize,
    },
}

/// A triangle that is inverted or flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadTriangle {
    /// Its index in [`Mesh::triangles`](crate::Mesh::triangles).
    pub triangle: usize,
    /// Its vertices, in the order in which a sound triangle goes around counter-clockwise.
    pub vertices: [u32; 3],
    /// Whether its area is zero; otherwise it is inverted.
    pub flat: bool,
}

impl BadTriangle {
    /// What is wrong with it: `"inverted"` or `"flat"`.
    pub fn problem(&self) -> &'static str {
        if self.flat { "flat" } else { "inverted" }
    }
}

/// How many triangles are bad, and the first ten of them.
fn listed(triangles: &[BadTriangle]) -> String {
    let one = |bad: &BadTriangle| format!("{} ({})", bad.triangle, bad.problem());
    let first: Vec<String> = triangles.iter().take(10).map(one).collect();
    let more = match triangles.len().saturating_sub(10) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let (s, are) = if triangles.len() == 1 { ("", "is") } else { ("s", "are") };
    format!("{} triangle{s} {are} inverted or flat: {}{more}", triangles.len(), first.join(", "))
}

/// A run could not be done.
#[derive(Debug, thiserror::Error)]
pub enum SmoothError {
    /// The mesh is not one that can be smoothed.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// An option is out of its range.
    #[error("{option} is {value}: {remedy}")]
    Option {
        /// The field of [`Options`](crate::Options).
        option: &'static str,
        /// Its value.
        value: String,
        /// What it should be.
        remedy: &'static str,
    },
    /// The GPU cannot start or go on.
    #[error(transparent)]
    Gpu(#[from] crate::error::GpuError),
}

/// The GPU engine cannot start or go on.
#[derive(Clone, Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter, or none of that name.
    #[error("no GPU adapter{}", lacking(wanted.as_deref(), available))]
    NoAdapter {
        /// The name that was asked for.
        wanted: Option<String>,
        /// The names there are, separated by commas.
        available: String,
    },
    /// The adapter would not give a device.
    #[error("the adapter {adapter} gave no device: {message}")]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// What wgpu said.
        message: String,
    },
    /// A limit of the device is too low for this mesh.
    #[error("{what} needs {needed}, but the device's {limit} is {available}")]
    Limit {
        /// What does not fit.
        what: String,
        /// How much it needs.
        needed: u64,
        /// The limit's name in wgpu.
        limit: &'static str,
        /// Its value on this device.
        available: u64,
    },
    /// The mesh has more vertices or triangles than the kernels can number.
    #[error(
        "the mesh has {vertices} vertices and {triangles} triangles, but the GPU kernels number at most {most_vertices} and {most_triangles}; only the CPU engine takes them"
    )]
    TooLarge {
        /// Number of vertices.
        vertices: usize,
        /// Number of triangles.
        triangles: usize,
        /// The most vertices.
        most_vertices: usize,
        /// The most triangles.
        most_triangles: usize,
    },
    /// The compiler of the adapter reorders or drops operations that the kernels rely on, so that results would be
    /// wrong without notice. Found by a trial, see [`Gpu::check_arithmetic`](crate::Gpu::check_arithmetic).
    #[error(
        "the adapter {adapter} cannot be used: {operation}. Use another adapter or the CPU (--engine cpu)"
    )]
    Arithmetic {
        /// The adapter.
        adapter: String,
        /// Which operation failed, and how.
        operation: &'static str,
    },
    /// A feature that this takes was not asked for when the device was made.
    #[error("{what} needs a device made with the feature {feature}")]
    Feature {
        /// What takes it.
        what: &'static str,
        /// Its name in wgpu.
        feature: &'static str,
    },
    /// The device has no memory left.
    #[error("the device is out of memory: {0}")]
    OutOfMemory(String),
    /// A buffer of the application cannot be used as asked.
    #[error("the application's buffer cannot be used: {0}")]
    Buffer(String),
    /// wgpu refused a call: a bug in this library, or a device made with other limits.
    #[error("the device refused: {0}")]
    Refused(String),
    /// The device was lost or destroyed; the run is lost with it.
    #[error("the device was lost: {0}")]
    Lost(String),
}

fn lacking(wanted: Option<&str>, available: &str) -> String {
    match wanted {
        None => " was found".into(),
        Some(name) if available.is_empty() => format!(" was found, so none called '{name}'"),
        Some(name) => format!(" has '{name}' in its name; there are: {available}"),
    }
}
