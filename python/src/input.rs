//! Fixes vertices of a mesh, continues its longitudes, untangles it, and prepares it for runs.

use std::borrow::Cow;
use std::ops::ControlFlow;

use gpu_smooth::front_ends::Plane;
use gpu_smooth::layers::Layers;
use gpu_smooth::targets::Surface;
use gpu_smooth::topology::{BadQuadrilateral, BadTriangle};
use gpu_smooth::untangle::{Untangled, Untangling};
use gpu_smooth::{Mesh, MeshError, SmoothError, Smoother, Topology, Untangle};
use gpu_smooth_job::{Domain, look_like_degrees};

use pyo3::prelude::*;

use crate::arrays::PointsForm;
use crate::error::{self, Indices};
use crate::mesh_options::MeshOptions;
use crate::movement;
use crate::observer::RunObserver;
use crate::remarks::Remarks;

/// The reason for which a mesh cannot be smoothed.
pub(crate) enum Failure {
    Run(SmoothError),
    /// The mesh cannot be untangled; with the reason and the elements that stay inverted, flat or concave.
    Tangled {
        text: String,
        left: Indices,
    },
}

impl Failure {
    /// Returns the exception of the failure.
    pub(crate) fn raised(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Run(error) => error::of_run(py, &error),
            Self::Tangled { text, left } => error::tangled(py, &text, left),
        }
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Self::Run(error.into())
    }
}

impl From<SmoothError> for Failure {
    fn from(error: SmoothError) -> Self {
        Self::Run(error)
    }
}

/// The mesh of a call.
pub(crate) struct Input {
    layers: Layers,
    pub(crate) layout: Layout,
}

/// The domain of a call, with its mesh after untangling, and the points of the mesh before untangling.
#[derive(Clone)]
pub(crate) struct Layout {
    /// Points of the mesh before untangling; `None` if the mesh was not tangled.
    pub(crate) tangled: Option<Vec<[f64; 2]>>,
    pub(crate) domain: Domain,
    /// The plane in which the points are moved; `None` for the plane of x and y.
    pub(crate) plane: Option<Plane>,
}

impl Input {
    /// Fixes vertices, lays the mesh out on its surface, and untangles it if the options ask for it. Its points were passed in
    /// `form`.
    pub(crate) fn new(
        mesh: Mesh,
        options: &MeshOptions,
        form: &PointsForm,
        observer: &RunObserver<'_>,
        remarks: &mut Remarks<'_>,
    ) -> Result<Self, Failure> {
        movement::check_lines(&mesh, options, remarks);
        let mut domain = movement::domain(mesh, options)?;
        if options.surface() == Surface::Sphere {
            domain.lay_out_on_sphere(form.precision())?;
        }
        let settings = options.settings();
        if let Some(limit) = settings.only_bad {
            let near = domain.fix_far_from_bad(limit, settings.rings_of_bad())?;
            remarks.only_bad(limit, near.elements, near.free, domain.mesh());
        }
        let layers = movement::keep_layers(&mut domain, options, remarks)?;
        if !options.settings().slides {
            remarks.interfaces(domain.interface_vertices().len());
        }
        if !options.has("surface") && look_like_degrees(&domain.mesh().points, false) {
            remarks.degrees();
        }
        let mut tangled = None;
        if options.settings().untangles
            && let Some(points) = untangled(domain.mesh(), form, observer)?
        {
            tangled = Some(domain.replace_points(points));
        }
        let plane = form.plane().cloned();
        Ok(Self { layers, layout: Layout { tangled, domain, plane } })
    }

    /// Prepares the mesh for runs, with its targets and its sliding vertices.
    pub(crate) fn smoother(
        &self,
        options: &MeshOptions,
        remarks: &mut Remarks<'_>,
    ) -> Result<Smoother<'_>, Failure> {
        let mesh = Cow::Borrowed(self.layout.domain.mesh());
        let mut smoother = Smoother::keeping(mesh, self.layers.clone())?;
        self.layout.set_up(options, &mut smoother, remarks)?;
        Ok(smoother)
    }

    /// Prepares the mesh as [`smoother`](Self::smoother) does, and moves the mesh into the smoother.
    pub(crate) fn into_smoother(
        self,
        options: &MeshOptions,
        remarks: &mut Remarks<'_>,
    ) -> Result<(Smoother<'static>, Layout), Failure> {
        let Self { layers, mut layout } = self;
        let mesh = Cow::Owned(layout.domain.take_mesh());
        let mut smoother = Smoother::keeping(mesh, layers)?;
        layout.set_up(options, &mut smoother, remarks)?;
        Ok((smoother, layout))
    }
}

impl Layout {
    /// Sets the projection, the plane, the targets and the sliding vertices of a smoother.
    pub(crate) fn set_up(
        &self,
        options: &MeshOptions,
        smoother: &mut Smoother<'_>,
        remarks: &mut Remarks<'_>,
    ) -> Result<(), Failure> {
        let targets = options.targets()?;
        if options.surface() == Surface::Sphere {
            smoother.project_from_sphere()?;
        }
        if let Some(plane) = &self.plane {
            smoother.set_plane(plane)?;
        }
        let metric = options.target_kind().default_metric();
        remarks.targets(&targets.set(smoother, self.domain.chart(), metric)?);
        if options.settings().slides {
            movement::slide(options, &self.domain, smoother, remarks)?;
        }
        Ok(())
    }
}

/// Returns the points of a mesh after untangling; `None` if the mesh is not tangled. The points were passed in `form`.
pub(crate) fn untangled(
    mesh: &Mesh,
    form: &PointsForm,
    observer: &RunObserver<'_>,
) -> Result<Option<Vec<[f64; 2]>>, Failure> {
    let done = untangle_mesh(mesh, form, observer)?;
    let remedy =
        "Pass the mesh to gpu_smooth.untangle with keep_going=True to get the best points found";
    let failure = |text, left| Err(Failure::Tangled { text, left });
    if done.bad_before == 0 && done.moved == 0 && done.overlapping.is_none() {
        return Ok(None);
    }
    if let Some(bad) = Bad::of(&done.hopeless, &done.hopeless_quadrilaterals) {
        let Bad { argument, first, count, all, .. } = bad;
        let (subject, whose) = match count {
            1 => (first, "its"),
            count => (format!("{first} and {} more", count - 1), "their"),
        };
        let text = format!(
            "{argument}: {subject} cannot be untangled, as none of {whose} vertices is free, or two fixed vertices are at the \
             same point. Correct the points of {whose} vertices, or fix fewer vertices"
        );
        return failure(text, all);
    }
    if let Some(bad) = Bad::of(&done.left, &done.left_quadrilaterals) {
        let (Bad { argument, first, named, all, .. }, sweeps) = (bad, done.sweeps);
        let text = format!(
            "{argument}: {named} after {sweeps} sweeps of untangling, the first is {first}. {remedy}"
        );
        return failure(text, all);
    }
    if let Some(vertex) = done.overlapping {
        let text = format!(
            "points[{vertex}]: the triangles around the vertex wind more than once around it after untangling. {remedy}"
        );
        return failure(text, Indices::default());
    }
    Ok(Some(done.points))
}

/// Bad elements of a mesh, in words.
struct Bad {
    /// The argument that has the first element.
    argument: &'static str,
    first: String,
    /// Number of bad triangles and of bad corners of quadrilaterals.
    count: usize,
    /// The numbers, and how the elements stay.
    named: String,
    all: Indices,
}

impl Bad {
    /// Describes bad elements; `None` without such elements.
    fn of(triangles: &[BadTriangle], corners: &[BadQuadrilateral]) -> Option<Self> {
        let of_triangles = match triangles.len() {
            1 => "1 triangle stays inverted or flat".to_owned(),
            count => format!("{count} triangles stay inverted or flat"),
        };
        let of_corners = match corners.len() {
            1 => "1 corner of a quadrilateral stays concave or flat".to_owned(),
            count => format!("{count} corners of quadrilaterals stay concave or flat"),
        };
        let (argument, first, named) = match (triangles, corners) {
            ([], []) => return None,
            ([first, ..], []) => {
                ("triangles", format!("triangle {}", first.triangle), of_triangles)
            }
            ([first, ..], _) => {
                let named = format!("{of_triangles}, and {of_corners}");
                ("triangles", format!("triangle {}", first.triangle), named)
            }
            ([], [first, ..]) => {
                let (number, vertex) = (first.quadrilateral, first.vertices[first.corner]);
                let first = format!("quadrilateral {number} at vertex {vertex}");
                ("quadrilaterals", first, of_corners)
            }
        };
        let count = triangles.len() + corners.len();
        Some(Self { argument, first, count, named, all: Indices::of_bad(triangles, corners) })
    }
}

/// Untangles a mesh unless its fixed edges cross or a loop of its boundary is misplaced.
fn untangle_mesh(
    mesh: &Mesh,
    form: &PointsForm,
    observer: &RunObserver<'_>,
) -> Result<Untangled, Failure> {
    let topology = Topology::by_area(mesh)?;
    let is_tangled = !topology.bad_triangles(&mesh.points)?.is_empty()
        || !topology.bad_quadrilaterals(&mesh.points)?.is_empty();
    if is_tangled {
        let refused = |text| Err(Failure::Tangled { text, left: Indices::default() });
        if let Some(crossing) = topology.crossings(&mesh.points, 1)?.first() {
            let [[a, b], [c, d]] = crossing.edges;
            return refused(format!(
                "points: the fixed edges from vertex {a} to {b} and from vertex {c} to {d} cross, so that no points of free \
                 vertices untangle the mesh. Correct the points of these vertices"
            ));
        }
        if let Some(vertices) = topology.misplaced_loop(&mesh.points)? {
            return refused(format!(
                "points: the boundary loop through vertex {} is turned over, lies outside of the outer boundary or inside of \
                 another hole, so that no points of free vertices untangle the mesh. Correct the points of the loop",
                vertices.first().copied().unwrap_or_default()
            ));
        }
    }
    let untangle = Untangle::new(mesh).stored(form.precision()).in_plane(form.plane());
    Ok(untangle.observe(observe(observer)).run()?)
}

/// Returns the callback of untangling that asks an observer of runs.
pub(crate) fn observe(observer: &RunObserver<'_>) -> impl FnMut(&Untangling) -> ControlFlow<()> {
    |progress: &Untangling| observer.step("untangling", progress.sweep, progress.bad as f64)
}
