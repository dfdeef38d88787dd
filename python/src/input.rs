//! Fixes vertices of a mesh, continues its longitudes, untangles it, and prepares it for runs.

use std::borrow::Cow;
use std::ops::ControlFlow;

use gpu_smooth::interpolate::Chart;
use gpu_smooth::layers::Layers;
use gpu_smooth::precision::Precision;
use gpu_smooth::targets::Surface;
use gpu_smooth::untangle::{Untangled, Untangling};
use gpu_smooth::{
    Mesh, MeshError, SmoothError, Smoother, TargetField, Targets, Topology, untangle,
};

use pyo3::prelude::*;

use crate::arrays::PerVertex;
use crate::error;
use crate::mesh_options::{MeshOptions, Target};
use crate::movement::{self, Constraints, LayersEffect};
use crate::observer::RunObserver;

/// The reason for which a mesh cannot be smoothed.
pub(crate) enum Failure {
    Run(SmoothError),
    /// The mesh cannot be untangled; with the reason and the triangles that stay inverted or flat.
    Tangled {
        text: String,
        triangles: Vec<usize>,
    },
}

impl Failure {
    /// Returns the exception of the failure.
    pub(crate) fn raised(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Run(error) => error::of_run(py, &error),
            Self::Tangled { text, triangles } => error::tangled(py, &text, triangles),
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
    /// The mesh with continued longitudes on a sphere, after untangling.
    pub(crate) mesh: Mesh,
    /// The boundary layers that stay.
    layers: Layers,
    pub(crate) layout: Layout,
}

/// Points of a mesh before untangling, the chart of its longitudes, and its fixed vertices.
pub(crate) struct Layout {
    /// Points of the mesh before untangling; `None` if the mesh was not tangled.
    pub(crate) tangled: Option<Vec<[f64; 2]>>,
    pub(crate) chart: Option<Chart>,
    constraints: Constraints,
}

impl Input {
    /// Fixes vertices, lays the mesh out on its surface, and untangles it if the options ask for it.
    pub(crate) fn new(
        mut mesh: Mesh,
        options: &MeshOptions,
        stored: Precision,
        observer: &RunObserver<'_>,
    ) -> Result<Self, Failure> {
        let mut constraints = movement::fix(&mut mesh, options)?;
        let chart = match options.surface {
            Surface::Plane => None,
            Surface::Sphere => Chart::new(&mesh, stored)?,
        };
        if let Some(chart) = &chart {
            constraints.held.extend_from_slice(chart.held());
            mesh = chart.mesh().clone();
        }
        let (layers, effect) = movement::keep_layers(&mut mesh, options, &constraints)?;
        match effect {
            LayersEffect::Fixed => {}
            LayersEffect::AllKept => observer.warn(
                "keep_layers: every free vertex is in a boundary layer that stays, so the points do not move. Pass \
                 keep_layers=\"none\" to let them move",
            ),
            LayersEffect::NotFound => observer.warn(
                "keep_layers: no wall has such a layer, so all vertices may move. Pass the vertices of walls, as in \
                 (\"rows=3\", walls)",
            ),
        }
        let mut tangled = None;
        if options.untangles {
            let done = untangled(&mesh, stored, observer)?;
            if let Some(points) = done {
                tangled = Some(std::mem::replace(&mut mesh.points, points));
            }
        }
        Ok(Self { mesh, layers, layout: Layout { tangled, chart, constraints } })
    }

    /// Prepares the mesh for runs, with its targets and its sliding vertices.
    pub(crate) fn smoother(&self, options: &MeshOptions) -> Result<Smoother<'_>, Failure> {
        let mut smoother = Smoother::keeping(Cow::Borrowed(&self.mesh), self.layers.clone())?;
        self.layout.set_up(options, &mut smoother)?;
        Ok(smoother)
    }

    /// Prepares the mesh as [`smoother`](Self::smoother) does, and moves the mesh into the smoother.
    pub(crate) fn into_smoother(
        self,
        options: &MeshOptions,
    ) -> Result<(Smoother<'static>, Layout), Failure> {
        let Self { mesh, layers, layout } = self;
        let mut smoother = Smoother::keeping(Cow::Owned(mesh), layers)?;
        layout.set_up(options, &mut smoother)?;
        Ok((smoother, layout))
    }
}

/// Targets of a mesh.
enum Chosen {
    OfVertices(Targets),
    OfPlaces(Box<TargetField>),
}

impl Layout {
    /// Sets the projection, the targets and the sliding vertices of a smoother.
    fn set_up(&self, options: &MeshOptions, smoother: &mut Smoother<'_>) -> Result<(), Failure> {
        let targets = self.targets(options, smoother)?;
        if options.surface == Surface::Sphere {
            smoother.project_from_sphere()?;
        }
        match targets {
            None => {}
            Some(Chosen::OfVertices(targets)) => smoother.set_targets(&targets)?,
            Some(Chosen::OfPlaces(field)) => {
                smoother.set_target_field(*field)?;
            }
        }
        if options.slides {
            let slide = movement::slide(options, smoother.topology(), &self.constraints);
            smoother.set_slide(Some(&slide))?;
        }
        Ok(())
    }

    /// Returns the targets of a mesh; `None` for equilateral targets in the plane.
    fn targets(
        &self,
        options: &MeshOptions,
        smoother: &Smoother<'_>,
    ) -> Result<Option<Chosen>, MeshError> {
        let (points, topology, surface) =
            (&smoother.mesh().points, smoother.topology(), options.surface);
        let rings = options.target_rings();
        // Shapes are kept as they appear in coordinates, also on the sphere.
        let mut measured_on = surface;
        let targets = match &options.target {
            Target::Equilateral if surface == Surface::Plane => return Ok(None),
            Target::Equilateral => Targets::equilateral(points.len()),
            Target::KeepSize => Targets::keep_size(topology, points, surface, rings)?,
            Target::KeepShape => {
                measured_on = Surface::Plane;
                Targets::keep_shape(topology, points, rings)?
            }
            Target::Given(values) => match &self.chart {
                Some(chart) => of_numbers(&chart.extended(&values.numbers, values.each), values)?,
                None => of_numbers(&values.numbers, values)?,
            },
            Target::Background { points: background, triangles, values } => {
                let mesh = Mesh {
                    points: background.xy.clone(),
                    triangles: triangles.clone(),
                    fixed: vec![],
                };
                let field = TargetField::new(&mesh, &of_numbers(&values.numbers, values)?)?;
                let field = field.seen_on(surface);
                return Ok(Some(match options.is_of_places() {
                    true => Chosen::OfPlaces(field.into()),
                    false => Chosen::OfVertices(field.at(points)?.0),
                }));
            }
        };
        if options.is_of_places() {
            let triangles = topology.triangles().to_vec();
            let mesh = Mesh { points: points.clone(), triangles, fixed: vec![] };
            let field = TargetField::new(&mesh, &targets)?.seen_on(measured_on);
            return Ok(Some(Chosen::OfPlaces(field.into())));
        }
        let targets = targets.seen_on(measured_on, points, topology.triangles())?;
        Ok(Some(Chosen::OfVertices(targets)))
    }
}

fn of_numbers(numbers: &[f64], values: &PerVertex) -> Result<Targets, MeshError> {
    match values.each {
        1 => Targets::sizes(numbers),
        _ => Targets::tensors(numbers.as_chunks().0),
    }
}

/// Returns the points of a mesh after untangling; `None` if the mesh is not tangled.
pub(crate) fn untangled(
    mesh: &Mesh,
    stored: Precision,
    observer: &RunObserver<'_>,
) -> Result<Option<Vec<[f64; 2]>>, Failure> {
    let done = untangle_mesh(mesh, stored, observer)?;
    let remedy =
        "Pass the mesh to gpu_smooth.untangle with keep_going=True to get the best points found";
    let bad = |list: &[gpu_smooth::topology::BadTriangle]| -> Vec<usize> {
        list.iter().map(|bad| bad.triangle).collect()
    };
    match done {
        Untangled { bad_before: 0, .. } => Ok(None),
        Untangled { hopeless, .. } if !hopeless.is_empty() => Err(Failure::Tangled {
            text: format!(
                "triangles: triangle {} and {} more cannot be untangled, as none of their vertices is free, or two fixed \
                 vertices are at the same point. Correct the points of their vertices, or fix fewer vertices",
                hopeless[0].triangle,
                hopeless.len() - 1
            ),
            triangles: bad(&hopeless),
        }),
        Untangled { left, sweeps, .. } if !left.is_empty() => Err(Failure::Tangled {
            text: format!(
                "triangles: {} triangles stay inverted or flat after {sweeps} sweeps of untangling, the first is triangle \
                 {}. {remedy}",
                left.len(),
                left[0].triangle
            ),
            triangles: bad(&left),
        }),
        Untangled { overlapping: Some(vertex), .. } => Err(Failure::Tangled {
            text: format!(
                "points[{vertex}]: the triangles around the vertex wind more than once around it after untangling. {remedy}"
            ),
            triangles: Vec::new(),
        }),
        Untangled { points, .. } => Ok(Some(points)),
    }
}

/// Untangles a mesh unless its fixed edges cross or a loop of its boundary is misplaced.
fn untangle_mesh(
    mesh: &Mesh,
    stored: Precision,
    observer: &RunObserver<'_>,
) -> Result<Untangled, Failure> {
    let topology = Topology::by_area(mesh)?;
    if !topology.bad_triangles(&mesh.points)?.is_empty() {
        let refused = |text| Err(Failure::Tangled { text, triangles: Vec::new() });
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
    let done = untangle(mesh, stored, &mut observe(observer))?;
    Ok(done)
}

/// Returns the callback of untangling that asks an observer of runs.
pub(crate) fn observe(observer: &RunObserver<'_>) -> impl FnMut(&Untangling) -> ControlFlow<()> {
    |progress: &Untangling| observer.step("untangling", progress.sweep, progress.bad as f64)
}
