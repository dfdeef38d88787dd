//! Errors, one enum for each kind of operation.

/// A mesh cannot be smoothed as it is, or arguments do not fit it. Indices are zero-based, as in
/// [`Mesh`](crate::Mesh).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The mesh has no triangles.
    #[error("the mesh has no triangles")]
    Empty,
    /// There are more vertices or triangle corners than 32-bit indices can number.
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
        /// The first vertex with such a coordinate.
        vertex: u32,
    },
    /// A coordinate is so large, or the whole mesh so small, that products of lengths leave the range
    /// of double precision and exact predicates would not be exact.
    #[error("the coordinates are of size {size:e}, outside of 1e-100 to 1e100")]
    OutOfRange {
        /// The largest absolute value of a coordinate, among the vertices that triangles use.
        size: f64,
    },
    /// A triangle, or a list of vertices to fix or to move, names a vertex that does not exist.
    #[error("vertex {vertex} does not exist: the mesh has {vertices}, counted from 0")]
    IndexOutOfRange {
        /// The triangle, or `None` if it is a list of vertices that names the vertex.
        triangle: Option<usize>,
        /// The vertex that does not exist.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A triangle names one vertex twice.
    #[error("triangle {triangle} uses vertex {vertex} twice")]
    RepeatedVertex {
        /// The triangle.
        triangle: usize,
        /// The vertex that it names twice.
        vertex: u32,
    },
    /// Three or more triangles share an edge, so this is not a 2D mesh.
    #[error("the edge between vertices {} and {} belongs to {} triangles", edge[0], edge[1], triangles.len())]
    EdgeOfThree {
        /// The edge's vertices.
        edge: [u32; 2],
        /// All triangles at the edge, ascending.
        triangles: Vec<usize>,
    },
    /// Some triangles are inverted or flat.
    #[error("{}", listed(triangles))]
    Infeasible {
        /// All inverted or flat triangles, in ascending order.
        triangles: Vec<BadTriangle>,
    },
    /// A part of the mesh has no boundary. It is a closed surface in space, and cannot be untangled in the plane.
    #[error(
        "the part of the mesh with triangle {triangle} has no boundary, so that it is a closed surface in space"
    )]
    Closed {
        /// The first triangle of the part.
        triangle: usize,
    },
    /// The triangles around a free vertex overlap, though none is inverted: they wind more than once around it.
    #[error("the triangles around vertex {vertex} overlap: they wind {turns} times around it")]
    OverlappingStar {
        /// The first such vertex.
        vertex: u32,
        /// Number of times that the triangles wind around it.
        turns: u32,
    },
    /// The metric that judges the run cannot judge a triangle: its area is zero or below as computed in double precision, though
    /// by exact predicates it is not inverted. It is too flat, or too small beside the others.
    #[error(
        "triangle {triangle} is too flat, or too small beside the others, for double precision: \
         {metric} cannot judge it"
    )]
    BeyondPrecision {
        /// The worst triangle.
        triangle: usize,
        /// The name of the metric that judges the run.
        metric: &'static str,
    },
    /// The target given for a vertex is not a valid one; see [`Targets`](crate::Targets).
    #[error("vertex {vertex} has no target: {problem}")]
    Target {
        /// The first such vertex.
        vertex: usize,
        /// What is wrong there.
        problem: &'static str,
    },
    /// A pole of the sphere is inside a triangle or on its edge, where longitudes have no direction; see
    /// [`Chart`](crate::interpolate::Chart).
    #[error("triangle {triangle} has a pole of the sphere inside of it or on an edge")]
    Pole {
        /// The first such triangle.
        triangle: usize,
    },
    /// A list of positions does not have exactly one for each vertex of the mesh.
    #[error("{given} points are given for the {expected} vertices of the mesh")]
    PointCount {
        /// Number of vertices of the mesh.
        expected: usize,
        /// Number of points that were given.
        given: usize,
    },
    /// A list of data does not have as many numbers as the vertices of the mesh need.
    #[error("{given} numbers are given where the vertices of the mesh need {expected}")]
    ValueCount {
        /// How many numbers are needed: those of a vertex, times the vertices.
        expected: usize,
        /// How many were given.
        given: usize,
    },
    /// The bound on the inverse mean ratio that [`Topology::move_clamped`](crate::Topology::move_clamped) was given
    /// is NaN.
    #[error(
        "the bound on the inverse mean ratio is NaN: it must be a number, or infinite for no bound"
    )]
    BoundNotANumber,
    /// No vertex is free: each is on the boundary, is listed in [`Mesh::fixed`](crate::Mesh::fixed), is used by no
    /// triangle, or joins two fans of triangles.
    #[error("none of the {vertices} vertices is free to move")]
    NothingFree {
        /// Number of vertices.
        vertices: usize,
    },
}

/// A triangle that is inverted or flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadTriangle {
    /// The triangle's index in [`Mesh::triangles`](crate::Mesh::triangles).
    pub triangle: usize,
    /// The triangle's vertices, in the order that would be counter-clockwise if it were not inverted.
    pub vertices: [u32; 3],
    /// Whether the triangle's area is zero. If not, the triangle is inverted.
    pub flat: bool,
}

impl BadTriangle {
    /// What is wrong with the triangle: `"inverted"` or `"flat"`.
    pub fn problem(&self) -> &'static str {
        if self.flat { "flat" } else { "inverted" }
    }
}

/// The message of [`MeshError::Infeasible`]: the number of bad triangles, and the first ten.
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

/// A run failed, or could not start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SmoothError {
    /// The mesh cannot be smoothed.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A number out of the range of an option, or two features that do not go together.
    #[error(transparent)]
    Option(#[from] crate::options::OptionError),
    /// The checkpoint is from another run.
    #[error("the checkpoint cannot be used: {0}")]
    Checkpoint(String),
    /// The GPU engine failed.
    #[error(transparent)]
    Gpu(#[from] crate::error::GpuError),
}

/// The GPU engine cannot start, or failed during a run.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// The machine has no adapter, or no adapter with the wanted name.
    #[error("no GPU adapter{}", lacking(wanted.as_deref(), available))]
    NoAdapter {
        /// The name that was asked for.
        wanted: Option<String>,
        /// The names of the available adapters, separated by commas.
        available: String,
    },
    /// The adapter refused to create a device.
    #[error("the adapter {adapter} could not be opened: {message}")]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// wgpu's message.
        message: String,
    },
    /// A driver crashed the process that tried it, or never answered; see
    /// [`Backend::auto_tried`](crate::Backend::auto_tried).
    #[error("the driver of the GPU failed when it was tried: {0}")]
    Crashed(String),
    /// A limit of the device is too low.
    #[error("{what} needs {needed}, but the device's {limit} is {available}")]
    Limit {
        /// The resource that does not fit.
        what: String,
        /// The value of the limit that is needed.
        needed: u64,
        /// The limit's name in wgpu.
        limit: &'static str,
        /// The value of the limit on this device.
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
        /// Largest number of vertices for the kernels.
        most_vertices: usize,
        /// Largest number of triangles for the kernels.
        most_triangles: usize,
    },
    /// The adapter's compiler reorders or drops operations that the kernels rely on, so results would be silently
    /// wrong. Found by `Gpu::check_arithmetic`.
    #[error(
        "the adapter {adapter} cannot be used: {operation}. Use another adapter or the CPU (--engine cpu)"
    )]
    Arithmetic {
        /// The adapter.
        adapter: String,
        /// Which operation failed, and how.
        operation: &'static str,
    },
    /// The device was created without a feature that is needed.
    #[error("{what} needs a device made with the feature {feature}")]
    Feature {
        /// The use that needs the feature.
        what: &'static str,
        /// The feature's name in wgpu.
        feature: &'static str,
    },
    /// The device is out of memory.
    #[error("the device is out of memory: {0}")]
    OutOfMemory(String),
    /// A buffer of the application lacks the needed size, usage or layout, was destroyed, or belongs to another device.
    #[error("the application's buffer cannot be used: {0}")]
    Buffer(String),
    /// The queue belongs to another device.
    #[error("the queue is not that of the device: both must come from one call of request_device")]
    Queue,
    /// The call would block the thread, which a page in a browser cannot do.
    #[error(
        "a browser cannot wait in a blocking call: await a run, or use the call of this name that ends in _async"
    )]
    WouldBlock,
    /// wgpu refused a call: a bug in this library, or a device created with limits other than those required.
    #[error("the device refused: {0}")]
    Refused(String),
    /// A sweep made the objective infinite or NaN, which no sweep should.
    #[error(
        "sweep {sweep} made the objective infinite or NaN: a mistake of this program or of the driver of the GPU"
    )]
    NotFinite {
        /// The sweep.
        sweep: u32,
    },
    /// The device was lost or destroyed, and the run with it.
    #[error("the device was lost: {0}")]
    Lost(String),
}

/// The end of the message of [`GpuError::NoAdapter`].
fn lacking(wanted: Option<&str>, available: &str) -> String {
    match wanted {
        None => " was found".into(),
        Some(name) if available.is_empty() => format!(" was found, so none called '{name}'"),
        Some(name) => format!(" has '{name}' in its name; there are: {available}"),
    }
}
