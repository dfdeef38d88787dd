//! Exceptions and warnings: the classes of `gpu_smooth/_errors.py`, raised with messages that name the argument, the index
//! and a remedy.

use gpu_smooth::front_ends::NotPlanar;
use gpu_smooth::topology::{BadQuadrilateral, BadTriangle};
use gpu_smooth::{Element, GpuError, MeshError, SmoothError};
use gpu_smooth_job::options::{GivenOptions, Spelling};
use mesh_io::{ReadError, WriteError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyTuple, PyType};

/// The module that defines the exceptions.
static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();

/// Returns a class or a function of `gpu_smooth._errors`.
fn item_named<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let module = MODULE
        .get_or_try_init(py, || py.import(intern!(py, "gpu_smooth._errors")).map(Bound::unbind))?;
    module.bind(py).getattr(name)
}

/// Returns an exception of the class `class` of `gpu_smooth._errors`.
fn raised(py: Python<'_>, class: &str, text: &str) -> PyErr {
    match item_named(py, class).and_then(|class| Ok(class.cast_into::<PyType>()?)) {
        Ok(class) => PyErr::from_type(class, (text.to_owned(),)),
        Err(error) => error,
    }
}

/// Issues a `MeshWarning` that names the line by which the package was called. A filter of warnings may make the warning an
/// exception.
pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    item_named(py, "warn")?.call1((text,)).map(drop)
}

/// Returns the exception for arrays that are no mesh, or do not fit the mesh.
pub(crate) fn mesh(py: Python<'_>, text: &str) -> PyErr {
    raised(py, "MeshError", text)
}

/// Returns the exception for an option with a wrong value.
pub(crate) fn option(py: Python<'_>, text: &str) -> PyErr {
    raised(py, "OptionError", text)
}

/// Returns the exception for a device that cannot be used.
pub(crate) fn device(py: Python<'_>, text: &str) -> PyErr {
    raised(py, "DeviceError", text)
}

/// Returns the exception for a file that cannot be read or written.
pub(crate) fn file(py: Python<'_>, text: &str) -> PyErr {
    raised(py, "FileError", text)
}

/// Returns the exception of a file that cannot be read.
pub(crate) fn of_reading(py: Python<'_>, error: &ReadError) -> PyErr {
    let text = match error {
        ReadError::Unwelded { path } => format!(
            "{}: an STL lists corners of triangles, and has no vertices that these share. Have corners at the same place \
             joined: MeshFile(path, weld=True)",
            path.display()
        ),
        error => error.to_string(),
    };
    file(py, &text)
}

/// Returns the exception of a file that cannot be written.
pub(crate) fn of_writing(py: Python<'_>, error: &WriteError) -> PyErr {
    match error {
        WriteError::Points { .. } => mesh(py, &format!("points: {error}")),
        _ => file(py, &error.to_string()),
    }
}

/// Returns the exception of a run.
pub(crate) fn of_run(py: Python<'_>, error: &SmoothError) -> PyErr {
    match error {
        SmoothError::Mesh(error) => of_mesh(py, error),
        SmoothError::Option(error) => {
            option(py, &GivenOptions::default().refusal(error, Spelling::Python))
        }
        SmoothError::Gpu(error) => of_gpu(py, error),
        SmoothError::Checkpoint(error) => option(py, &format!("resume: {error}")),
        _ => option(py, &error.to_string()),
    }
}

/// Returns the exception of a device, with advice.
pub(crate) fn of_gpu(py: Python<'_>, error: &GpuError) -> PyErr {
    let (argument, remedy) = match error {
        GpuError::NoAdapter { wanted: Some(_), available } if !available.is_empty() => {
            ("adapter", "Pass a part of one of these names, or engine=\"cpu\" without adapter")
        }
        GpuError::NoAdapter { wanted, .. } => (
            if wanted.is_some() { "adapter" } else { "engine" },
            "Install a Vulkan driver (on Debian or Ubuntu, `apt install mesa-vulkan-drivers` brings one that needs no \
             graphics card), or pass engine=\"cpu\"",
        ),
        GpuError::Arithmetic { .. } => {
            ("engine", "Use another adapter or the CPU (engine=\"cpu\")")
        }
        _ => ("engine", "Pass engine=\"cpu\" to compute on the CPU"),
    };
    device(py, &format!("{argument}: {error}. {remedy}"))
}

/// The indices of triangles, quadrilaterals and a vertex that an exception names.
#[derive(Default)]
pub(crate) struct Indices {
    triangles: Vec<usize>,
    quadrilaterals: Vec<usize>,
    vertex: Option<usize>,
}

impl Indices {
    fn of_vertex(vertex: usize) -> Self {
        Self { vertex: Some(vertex), ..Self::default() }
    }

    fn of_elements(elements: &[Element]) -> Self {
        let mut found = Self::default();
        for element in elements {
            match *element {
                Element::Triangle(index) => found.triangles.push(index),
                Element::Quadrilateral(index) => found.quadrilaterals.push(index),
            }
        }
        found
    }

    /// Returns the indices of bad elements. Several corners of a quadrilateral follow each other.
    pub(crate) fn of_bad(triangles: &[BadTriangle], corners: &[BadQuadrilateral]) -> Self {
        let triangles = triangles.iter().map(|bad| bad.triangle).collect();
        let mut quadrilaterals: Vec<usize> = corners.iter().map(|bad| bad.quadrilateral).collect();
        quadrilaterals.dedup();
        Self { triangles, quadrilaterals, vertex: None }
    }
}

/// Returns the exception of a mesh that cannot be untangled.
pub(crate) fn tangled(py: Python<'_>, text: &str, left: Indices) -> PyErr {
    with_indices(py, mesh(py, text), left)
}

/// Returns the exception of a mesh that the library refuses. The attributes `triangles`, `quadrilaterals` and `vertex` of the
/// exception have the indices that the error names.
pub(crate) fn of_mesh(py: Python<'_>, error: &MeshError) -> PyErr {
    with_indices(py, mesh(py, &explained(error)), indices(error))
}

/// Returns the exception of points that do not lie in one plane.
pub(crate) fn not_planar(py: Python<'_>, name: &str, refused: &NotPlanar) -> PyErr {
    let NotPlanar { vertex, distance } = *refused;
    let text = format!(
        "{name}[{vertex}]: the mesh is not planar: the vertex is at a distance of {distance:.6} from the plane nearest to all \
         vertices. If z is data of a mesh in x and y, such as the depth of water, pass z=\"data\". Curved surfaces are not \
         smoothed"
    );
    with_indices(py, mesh(py, &text), Indices::of_vertex(vertex))
}

const NOT_FINITE_REMEDY: &str = "Replace NaN and infinity, or remove the vertex";

/// Returns the exception of a point of the argument `name` that is not finite.
pub(crate) fn not_finite(py: Python<'_>, name: &str, vertex: usize) -> PyErr {
    let text = format!(
        "{name}[{vertex}]: vertex {vertex} has a coordinate that is not a finite number. {NOT_FINITE_REMEDY}"
    );
    with_indices(py, mesh(py, &text), Indices::of_vertex(vertex))
}

/// Returns the exception of a third coordinate that is not finite.
pub(crate) fn third_coordinate(py: Python<'_>, name: &str, vertex: usize, z: f64) -> PyErr {
    let text = format!(
        "{name}[{vertex}, 2]: the third coordinate is {z}. Replace NaN and infinity, or pass z=\"data\" if z is data of a \
         mesh in x and y"
    );
    with_indices(py, mesh(py, &text), Indices::of_vertex(vertex))
}

/// Returns the exception of a point that is not in the plane of a prepared mesh.
pub(crate) fn other_plane(py: Python<'_>, vertex: usize) -> PyErr {
    let text = format!(
        "points[{vertex}]: the vertex is not in the plane of the points of the Smoother. Make a Smoother of the new points, or \
         pass z=\"data\" to it if z is data of a mesh in x and y"
    );
    with_indices(py, mesh(py, &text), Indices::of_vertex(vertex))
}

/// Returns the exception of a point to write, at which a vertex is that a run keeps.
pub(crate) fn moved_fixed(py: Python<'_>, vertex: usize, slides: bool) -> PyErr {
    let text = match slides {
        false => format!(
            "points[{vertex}]: the vertex has moved, but is on the boundary, on a line, between regions or on other elements of \
             the file. Pass slide=True or free_lines=True if the mesh was smoothed so, or the Result in place of points, or \
             moved_fixed=True to write any points"
        ),
        true => format!(
            "points[{vertex}]: the vertex has moved, but is an end of a group or on other elements of the file, and does not \
             slide. Pass fixed=MeshFile.anchored to the run, or free_lines=True if the mesh was smoothed so, or moved_fixed=True \
             to write any points"
        ),
    };
    with_indices(py, mesh(py, &text), Indices::of_vertex(vertex))
}

/// Sets the attributes of an exception that name triangles, quadrilaterals and a vertex.
fn with_indices(py: Python<'_>, raised: PyErr, indices: Indices) -> PyErr {
    let Indices { triangles, quadrilaterals, vertex } = indices;
    let value = raised.value(py);
    let set = |name, list| PyTuple::new(py, list).and_then(|list| value.setattr(name, list));
    let set = set(intern!(py, "triangles"), triangles)
        .and_then(|()| set(intern!(py, "quadrilaterals"), quadrilaterals))
        .and_then(|()| value.setattr(intern!(py, "vertex"), vertex));
    match set {
        Ok(()) => raised,
        Err(error) => error,
    }
}

/// Returns the elements and the vertex that an error names.
fn indices(error: &MeshError) -> Indices {
    match error {
        MeshError::NotFinite { vertex } | MeshError::OverlappingStar { vertex, .. } => {
            Indices::of_vertex(*vertex as usize)
        }
        MeshError::IndexOutOfRange { element, vertex, .. } => {
            let element = element.as_ref().map_or(&[][..], std::slice::from_ref);
            Indices { vertex: Some(*vertex as usize), ..Indices::of_elements(element) }
        }
        MeshError::RepeatedVertex { element, vertex } => {
            let vertex = Some(*vertex as usize);
            Indices { vertex, ..Indices::of_elements(&[*element]) }
        }
        MeshError::Doublet { vertex, elements } => {
            Indices { vertex: Some(*vertex as usize), ..Indices::of_elements(elements) }
        }
        MeshError::EdgeOfThree { elements, .. } => Indices::of_elements(elements),
        MeshError::Infeasible { triangles, quadrilaterals } => {
            Indices::of_bad(triangles, quadrilaterals)
        }
        MeshError::Closed { element }
        | MeshError::BeyondPrecision { element, .. }
        | MeshError::Pole { element } => Indices::of_elements(&[*element]),
        MeshError::Target { vertex, .. } => Indices::of_vertex(*vertex),
        MeshError::Latitude { vertex } => Indices::of_vertex(*vertex as usize),
        _ => Indices::default(),
    }
}

/// Returns the argument and the row of an element, such as `triangles[4]`.
fn argument(element: Element) -> String {
    let name = match element {
        Element::Triangle(_) => "triangles",
        Element::Quadrilateral(_) => "quadrilaterals",
    };
    format!("{name}[{}]", element.index())
}

/// Returns the name of an element without its index.
fn kind(element: Element) -> &'static str {
    match element {
        Element::Triangle(_) => "triangle",
        Element::Quadrilateral(_) => "quadrilateral",
    }
}

/// Returns the message of a mesh error in terms of the arguments, with a remedy.
fn explained(error: &MeshError) -> String {
    match error {
        MeshError::Empty => {
            format!(
                "triangles: {error}. Pass an integer array of shape (m, 3), or quadrilaterals of shape (k, 4), with at least one row"
            )
        }
        MeshError::NotFinite { vertex } => {
            format!("points[{vertex}]: {error}. {NOT_FINITE_REMEDY}")
        }
        MeshError::OutOfRange { .. } => format!("points: {error}. Choose another unit of length"),
        MeshError::IndexOutOfRange { element: Some(element), .. } => {
            let argument = argument(*element);
            format!("{argument}: {error}. Vertices are numbered from 0 by the rows of points")
        }
        MeshError::RepeatedVertex { element, .. } => {
            format!("{}: {error}. Remove the {}", argument(*element), kind(*element))
        }
        MeshError::EdgeOfThree { elements, .. } => {
            let name = match elements.iter().any(|own| matches!(own, Element::Triangle(_))) {
                true => "triangles",
                false => "quadrilaterals",
            };
            format!("{name}: {error}. Remove {name} until an edge has two at most")
        }
        MeshError::Doublet { vertex, .. } => format!("points[{vertex}]: {error}"),
        MeshError::Infeasible { triangles, quadrilaterals } => {
            let remedy = "Pass untangle=True, or correct the points of their vertices";
            match &quadrilaterals[..] {
                [first, others @ ..] if triangles.is_empty() => {
                    let number = first.quadrilateral;
                    let (problem, vertex) = (first.problem(), first.vertices[first.corner]);
                    let more = match others.len() {
                        0 => String::new(),
                        n => format!(", one of {} corners that are not convex", n + 1),
                    };
                    format!(
                        "quadrilaterals[{number}]: quadrilateral {number} is {problem} at vertex {vertex}{more}. {remedy}"
                    )
                }
                _ => format!("triangles: {error}. {remedy}"),
            }
        }
        MeshError::OverlappingStar { vertex, .. } => {
            format!("points[{vertex}]: {error}. Correct the points around the vertex")
        }
        MeshError::BeyondPrecision { element, usable, .. } => {
            let argument = argument(*element);
            let usable = match usable.is_empty() {
                true => "Pass untangle=True".to_owned(),
                false => format!("Pass untangle=True, or a scheme of {}", usable.join(", ")),
            };
            format!("{argument}: {error}. {usable}")
        }
        MeshError::Latitude { vertex } => format!(
            "points[{vertex}]: {error}. Pass longitude and latitude in degrees, or no surface"
        ),
        MeshError::Target { vertex, problem } => {
            format!(
                "target: vertex {vertex} has no target: {problem}. Sizes are positive, tensors (xx, xy, yy) positive definite"
            )
        }
        MeshError::NothingFree { .. } => format!(
            "{error}: all are on the boundary, fixed, on lines or between regions. Pass free_lines=True if lines hold them, \
             pass slide=True, fix fewer vertices, or refine the mesh"
        ),
        MeshError::PointCount { .. } => format!("points: {error}. Pass one row per vertex"),
        MeshError::ValueCount { .. } => format!("{error}. Pass one row per vertex"),
        other => other.to_string(),
    }
}
