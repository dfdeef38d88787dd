//! Errors of the library, an enum per kind of operation.

use crate::mesh::Element;

/// Error of an unsuitable mesh, or of arguments that do not match the mesh. Indices are zero-based, as in
/// [`Mesh`](crate::Mesh).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The mesh has neither triangles nor quadrilaterals.
    #[error("the mesh has no triangles and no quadrilaterals")]
    Empty,
    /// There are more vertices or corners of elements than 32-bit indices can number.
    #[error(
        "{vertices} vertices and {triangles} triangles (two for each quadrilateral) are more than 32-bit indices can number"
    )]
    TooLarge {
        /// Number of vertices.
        vertices: usize,
        /// Number of triangles, two for each quadrilateral.
        triangles: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// The first vertex with such a coordinate.
        vertex: u32,
    },
    /// A coordinate is so large, or the whole mesh so small, that products of lengths leave the range of double
    /// precision and exact predicates would not be exact.
    #[error("the coordinates are of size {size:e}, outside of 1e-100 to 1e100")]
    OutOfRange {
        /// Largest absolute value of a coordinate, among the vertices that elements use.
        size: f64,
    },
    /// An element, or a list of vertices to fix or to move, names a vertex that does not exist.
    #[error("vertex {vertex} does not exist: the mesh has {vertices}, counted from 0")]
    IndexOutOfRange {
        /// The element that names the vertex, `None` if a list of vertices names it.
        element: Option<Element>,
        /// The vertex that does not exist.
        vertex: u32,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// An element names one vertex twice.
    #[error("{element} uses vertex {vertex} twice")]
    RepeatedVertex {
        /// The element.
        element: Element,
        /// The repeated vertex.
        vertex: u32,
    },
    /// Three or more elements share an edge, so the mesh is not two-dimensional.
    #[error("the edge between vertices {} and {} belongs to {} {}", edge[0], edge[1], elements.len(), kinds(elements))]
    EdgeOfThree {
        /// The two vertices of the edge.
        edge: [u32; 2],
        /// All elements at the edge, ascending.
        elements: Vec<Element>,
    },
    /// A vertex inside the mesh has two elements alone, at least one a quadrilateral. The two corners fill 360 degrees
    /// together, so one is not convex, wherever the vertex is.
    #[error(
        "vertex {vertex} is a doublet: it is inside the mesh between {} and {} alone, so the corner of one of them is not convex: join the two elements",
        elements[0], elements[1]
    )]
    Doublet {
        /// The first such vertex.
        vertex: u32,
        /// The two elements, ascending.
        elements: [Element; 2],
    },
    /// Triangles are inverted or flat, or quadrilaterals have a corner that is not convex.
    #[error("{}", listed(triangles, quadrilaterals))]
    Infeasible {
        /// All inverted or flat triangles, in ascending order.
        triangles: Vec<BadTriangle>,
        /// All corners of quadrilaterals that are not convex, in ascending order.
        quadrilaterals: Vec<BadQuadrilateral>,
    },
    /// An edge-connected part of the mesh has no boundary: a closed surface in space, which no placement of vertices in
    /// the plane untangles.
    #[error(
        "the connected part of the mesh around {element} has no boundary: it is a closed surface in space"
    )]
    Closed {
        /// The first element of the part.
        element: Element,
    },
    /// The triangles around a free vertex overlap although none is inverted: they wind more than once around the
    /// vertex.
    #[error("the triangles around vertex {vertex} overlap: they wind {turns} times around it")]
    OverlappingStar {
        /// The first vertex with overlapping triangles.
        vertex: u32,
        /// Number of turns that the triangles make around the vertex.
        turns: u32,
    },
    /// The metric that judges the run cannot judge an element. Its area is zero or negative as computed in double
    /// precision, though by exact predicates the triangle is not inverted. Such a triangle is too flat, or too small
    /// beside other triangles.
    #[error(
        "{element} is too flat, or too small beside the others, for double precision: \
         {metric} cannot judge it"
    )]
    BeyondPrecision {
        /// The worst element.
        element: Element,
        /// Name of the metric that judges the run.
        metric: &'static str,
        /// Names of the metrics that can judge all elements of this mesh.
        usable: Vec<&'static str>,
    },
    /// The latitude of a vertex is not between -90 and 90 degrees.
    #[error("vertex {vertex} is not on the sphere: its latitude is not between -90 and 90 degrees")]
    Latitude {
        /// The first such vertex.
        vertex: u32,
    },
    /// The target of a vertex is invalid; see [`Targets`](crate::Targets).
    #[error("vertex {vertex} has no target: {problem}")]
    Target {
        /// The first vertex with an invalid target.
        vertex: usize,
        /// Description of the vertex's defect.
        problem: &'static str,
    },
    /// A pole of the sphere is inside an element or on an edge, where longitude has no direction; see
    /// [`Chart`](crate::front_ends::Chart).
    #[error("{element} has a pole of the sphere inside of it or on an edge")]
    Pole {
        /// The first element that contains a pole.
        element: Element,
    },
    /// A list of positions does not have exactly one entry per vertex of the mesh.
    #[error("{given} points are given for the {expected} vertices of the mesh")]
    PointCount {
        /// Number of vertices of the mesh.
        expected: usize,
        /// Number of points that were given.
        given: usize,
    },
    /// The length of a data list is not the number of vertices times the values per vertex.
    #[error("{given} numbers are given where the vertices of the mesh need {expected}")]
    ValueCount {
        /// Number of values that are needed: the values per vertex, times the number of vertices.
        expected: usize,
        /// Number of values that were given.
        given: usize,
    },
    /// The bound on the inverse mean ratio given to [`Topology::move_clamped`](crate::Topology::move_clamped) is NaN.
    #[error("the bound on the inverse mean ratio is NaN: give a number, or infinity for no bound")]
    BoundNotANumber,
    /// No vertex is free. Every vertex is on the boundary, is listed in [`Mesh::fixed`](crate::Mesh::fixed), is used by
    /// no triangle, or joins two fans of triangles.
    #[error("none of the {vertices} vertices is free to move")]
    NothingFree {
        /// Number of vertices of the mesh.
        vertices: usize,
    },
}

/// A triangle that is inverted or flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadTriangle {
    /// Index of the triangle in [`Mesh::triangles`](crate::Mesh::triangles).
    pub triangle: usize,
    /// Vertices of the triangle, with the winding that is counter-clockwise once the triangle is no longer inverted.
    pub vertices: [u32; 3],
    /// Whether the triangle's area is zero. If false, the triangle is inverted.
    pub flat: bool,
}

impl BadTriangle {
    /// Returns the defect of the triangle: `"inverted"` or `"flat"`.
    pub fn problem(&self) -> &'static str {
        if self.flat { "flat" } else { "inverted" }
    }
}

/// A concave or flat corner of a quadrilateral: the triangle of a vertex and both neighbors along edges is inverted or flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadQuadrilateral {
    /// Index of the quadrilateral in [`Mesh::quadrilaterals`](crate::Mesh::quadrilaterals).
    pub quadrilateral: usize,
    /// Vertices of the quadrilateral, with the winding that is counter-clockwise once all corners are convex.
    pub vertices: [u32; 4],
    /// Index in `vertices` of the corner.
    pub corner: usize,
    /// Whether the angle at the corner is 180 degrees. If false, the angle is larger.
    pub flat: bool,
}

impl BadQuadrilateral {
    /// Returns the defect of the corner: `"concave"` or `"flat"`.
    pub fn problem(&self) -> &'static str {
        if self.flat { "flat" } else { "concave" }
    }
}

/// Returns the message of [`MeshError::Infeasible`]: the numbers of bad triangles and of bad corners, and the first ten of each.
fn listed(triangles: &[BadTriangle], quadrilaterals: &[BadQuadrilateral]) -> String {
    let triangle = |bad: &BadTriangle| format!("{} ({})", bad.triangle, bad.problem());
    let corner = |bad: &BadQuadrilateral| {
        let (number, vertex) = (bad.quadrilateral, bad.vertices[bad.corner]);
        format!("{number} ({} at vertex {vertex})", bad.problem())
    };
    let (s, are) = if triangles.len() == 1 { ("", "is") } else { ("s", "are") };
    let of_triangles = format!("{} triangle{s} {are} inverted or flat", triangles.len());
    let (s, are) = if quadrilaterals.len() == 1 { ("", "is") } else { ("s", "are") };
    let of_corners =
        format!("{} corner{s} of quadrilaterals {are} not convex", quadrilaterals.len());
    let parts = [
        (of_triangles, triangles.iter().map(triangle).collect::<Vec<_>>()),
        (of_corners, quadrilaterals.iter().map(corner).collect()),
    ];
    let texts = parts.into_iter().filter(|(_, list)| !list.is_empty()).map(|(count, list)| {
        let more = match list.len().saturating_sub(10) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        format!("{count}: {}{more}", list[..list.len().min(10)].join(", "))
    });
    texts.collect::<Vec<_>>().join("; ")
}

/// Returns the word for a list of elements: triangles, quadrilaterals, or elements if the list has both.
fn kinds(elements: &[Element]) -> &'static str {
    let is_triangle = |element: &Element| matches!(element, Element::Triangle(_));
    match elements.iter().filter(|element| is_triangle(element)).count() {
        0 => "quadrilaterals",
        count if count == elements.len() => "triangles",
        _ => "elements",
    }
}

/// Error of a run that failed or could not start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SmoothError {
    /// The mesh cannot be smoothed.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// An option has a number outside its range, or two features of the run exclude each other.
    #[error(transparent)]
    Option(#[from] crate::options::OptionError),
    /// The checkpoint is from another run.
    #[error("the checkpoint cannot be used: {0}")]
    Checkpoint(#[from] ResumeError),
    /// The GPU engine failed.
    #[error(transparent)]
    Gpu(#[from] crate::error::GpuError),
}

/// The reason why a run cannot continue from a checkpoint.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ResumeError {
    /// The mesh, its fixed vertices, curves or targets are others.
    #[error(
        "mesh, held vertices, curves or targets of the checkpoint differ from this run: continue with the mesh that the run began with"
    )]
    OtherMesh,
    /// An option of the run has another value than in the run of the checkpoint.
    #[error(
        "the run of the checkpoint has {then}, and this run has {now}: continue with the same options"
    )]
    OtherOption {
        /// The option of the checkpoint, as `name = value`.
        then: String,
        /// The option of this run, as `name = value`.
        now: String,
    },
    /// Another version of the library wrote the checkpoint, with an option that this version lacks.
    #[error(
        "the run of the checkpoint has {then}, an option that this version of gpu-smooth lacks: continue with the version that wrote the checkpoint"
    )]
    UnknownOption {
        /// The option of the checkpoint, as `name = value`.
        then: String,
    },
}

/// Error of the GPU engine: a device cannot be used, or failed during a run.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// The machine has no adapter, or no adapter with the wanted name.
    #[error("no GPU adapter{}", lacking(wanted.as_deref(), available))]
    NoAdapter {
        /// The wanted name, `None` if any adapter would do.
        wanted: Option<String>,
        /// Names of the available adapters, separated by commas.
        available: String,
    },
    /// The adapter refused to create a device.
    #[error("the adapter {adapter} could not be opened: {message}")]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// Message of wgpu.
        message: String,
    },
    /// A driver crashed the process that tried to use the device, or never answered; see
    /// [`Backend::auto_tried`](crate::Backend::auto_tried).
    #[error("the driver of the GPU failed when it was tried: {0}")]
    Crashed(String),
    /// A limit of the device is lower than a run needs.
    #[error("{what} needs {needed}, but the device's {limit} is {available}")]
    Limit {
        /// The resource that exceeds the limit.
        what: String,
        /// Least value of the limit that would suffice.
        needed: u64,
        /// Name of the limit in wgpu.
        limit: &'static str,
        /// Value of the limit on the device.
        available: u64,
    },
    /// The vertex or triangle count of the mesh exceeds the index ranges of the kernels.
    #[error(
        "the mesh has {vertices} vertices and {triangles} triangles, but the GPU kernels number at most {most_vertices} and {most_triangles}; only the CPU engine takes them"
    )]
    TooLarge {
        /// Number of vertices.
        vertices: usize,
        /// Number of triangles.
        triangles: usize,
        /// Largest vertex count that fits the index ranges of the kernels.
        most_vertices: usize,
        /// Largest triangle count that fits the index ranges of the kernels.
        most_triangles: usize,
    },
    /// The adapter's compiler reorders or drops operations that the kernels rely on, so results would be silently
    /// wrong. `Gpu::check_arithmetic` detects the failure. Take another adapter or
    /// [`Backend::Cpu`](crate::Backend::Cpu).
    #[error("the adapter {adapter} cannot be used: {operation}")]
    Arithmetic {
        /// The adapter.
        adapter: String,
        /// The failed operation and its failure, in words.
        operation: &'static str,
    },
    /// The device was created without a feature that a use of the device needs.
    #[error("{what} needs a device made with the feature {feature}")]
    Feature {
        /// The use that needs the feature.
        what: &'static str,
        /// Name of the feature in wgpu.
        feature: &'static str,
    },
    /// The device is out of memory.
    #[error("the device is out of memory: {0}")]
    OutOfMemory(String),
    /// A buffer of the application lacks the needed size, usage or layout, was destroyed, or belongs to another device.
    #[error("the application's buffer cannot be used: {0}")]
    Buffer(String),
    /// The queue and the device come from different calls of `request_device`.
    #[error(
        "queue and device are no pair: pass the device and the queue of one call of request_device"
    )]
    Queue,
    /// The call would block the thread, and browsers forbid blocking calls.
    #[error("a browser cannot block: await the call instead of calling `block`")]
    WouldBlock,
    /// wgpu refused a call. Cause: a bug in this library, or a device created with limits below the required limits.
    #[error("the device refused: {0}")]
    Refused(String),
    /// A sweep made the objective infinite or NaN, which indicates a bug in this library or in the driver.
    #[error(
        "sweep {sweep} made the objective infinite or NaN: a defect of this program or of the GPU driver"
    )]
    NotFinite {
        /// Number of the sweep, from 1.
        sweep: u32,
    },
    /// The device was lost or destroyed, and the run with it.
    #[error("the device was lost: {0}")]
    Lost(String),
}

/// Returns the end of the message of [`GpuError::NoAdapter`].
fn lacking(wanted: Option<&str>, available: &str) -> String {
    match wanted {
        None => " was found".into(),
        Some(name) if available.is_empty() => format!(" was found, so none called '{name}'"),
        Some(name) => format!(" has '{name}' in its name; there are: {available}"),
    }
}

/// Error of bytes that [`Checkpoint::from_bytes`](crate::Checkpoint::from_bytes) cannot decode.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The bytes are no checkpoint.
    #[error("the file is not a checkpoint of gpu-smooth")]
    Foreign,
    /// The version of the checkpoint's format differs from the version that this library reads.
    #[error("gpu-smooth {} does not read checkpoints that {writer} wrote", env!("CARGO_PKG_VERSION"))]
    Version {
        /// Name and version of the library that wrote the checkpoint, such as `gpu-smooth 0.1.0`.
        writer: String,
    },
    /// Bytes of the checkpoint were changed or cut off.
    #[error("the checkpoint, written by {writer}, is damaged")]
    Damaged {
        /// Name and version of the library that wrote the checkpoint, such as `gpu-smooth 0.1.0`.
        writer: String,
    },
}
