//! Untangling of meshes with inverted or flat triangles, for `--untangle`.

use crate::error::CliError;
use crate::load::{InterpolatedFields, LoadedMesh};
use std::ops::ControlFlow;

use gpu_smooth::{
    Element, Mesh, MeshError, Smoother, Topology,
    topology::BadTriangle,
    untangle::{Untangle, Untangled, Untangling},
};

use crate::load::explain;
use crate::load::streams;
use crate::report::{Failure, SmoothJob};
use crate::run::input::Input;
use crate::terminal::interrupt;
use crate::terminal::numbers::counted;

/// An untangled mesh, with counts of the work.
pub(crate) struct UntangledInput {
    pub(crate) mesh: Mesh,
    pub(crate) bad_before: usize,
    pub(crate) sweeps: u32,
    pub(crate) moved: usize,
    /// A remark on remaining crossings of fixed edges; `None` without crossings.
    pub(crate) remark: Option<String>,
}

/// Untangles a mesh that has inverted or flat triangles.
///
/// If triangles stay inverted, returns an error that lists them. With `--keep-going`, the best mesh found is written
/// before, unless a signal ended untangling. The time limit counts from the start of the run.
pub(super) fn untangle_input(input: &Input<'_>) -> Result<UntangledInput, Failure> {
    let Input { task, file, began, .. } = *input;
    let SmoothJob { request, verbosity, out, .. } = *task;
    let keeps_going = request.untangle.is_some_and(|untangle| untangle.keeps_going);
    let mesh = file.mesh();
    let explained = |error: MeshError| explain::mesh_error(file, &error);
    let topology = Topology::by_area(mesh).map_err(explained)?;
    let failure = |error, bad: &[_]| Failure::of_triangles(request, file, error, bad);
    let unchanged = |error| match topology.bad_triangles(&mesh.points) {
        Ok(bad) => failure(error, &bad),
        Err(_) => error.into(),
    };
    let crossings = explain::crossings(file, &topology);
    if let (Some(crossings), false) = (&crossings, keeps_going) {
        let remedy =
            "Correct them, or untangle a mesh that is meant to lie over itself with --keep-going";
        let path = file.source.path().display().to_string();
        return Err(unchanged(crossings.clone().within(&path).with_remedy(remedy)));
    }
    if !keeps_going
        && let Some(vertices) = topology.misplaced_loop(&mesh.points).map_err(explained)?
    {
        return Err(unchanged(misplaced_loop(file, &vertices)));
    }
    let mut ended = None;
    let mut observe = |progress: &Untangling| {
        if verbosity.verbose {
            let Untangling { sweep, bad, .. } = progress;
            let text = format!("untangling, sweep {sweep:<5} inverted or flat {bad}");
            streams::say_beside(out, &text);
        }
        if interrupt::is_requested() {
            ended = Some("interrupted while untangling");
        } else if request.time_limit.is_some_and(|limit| began.elapsed() >= limit) {
            ended = Some("--time-limit ended untangling");
        }
        // Triangles that no move can mend are an error, which need not wait for the others.
        let is_hopeless = progress.hopeless > 0 && !keeps_going;
        match ended {
            None if !is_hopeless => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        }
    };
    let untangled = Untangle::new(mesh)
        .stored(file.precision())
        .in_plane(file.plane())
        .observe(&mut observe)
        .run()
        .map_err(explained)?;
    let concave = concave(file, &untangled);
    let Untangled { points, bad_before, left, hopeless, overlapping, sweeps, moved, .. } =
        untangled;
    let mut error = match (concave, overlapping) {
        (Some(error), _) => error,
        (None, None) if left.is_empty() => {
            let mesh = Mesh { points, ..mesh.clone() };
            let remark = crossings.map(|crossings| crossings.to_string());
            return Ok(UntangledInput { mesh, bad_before, sweeps, moved, remark });
        }
        (None, Some(vertex)) if left.is_empty() => overlaps(file, vertex, sweeps),
        _ => {
            let was_ended = ended.is_some();
            let left = TangledRest { triangles: &left, hopeless: &hopeless, sweeps, was_ended };
            still_tangled(file, &left)
        }
    };
    if let Some(ended) = ended {
        error = error.after(&format!("{ended}."));
    }
    if interrupt::is_requested() {
        return Err(failure(error, &left));
    }
    if !keeps_going {
        let error = error.with_remedy("--keep-going writes the best mesh found");
        return Err(failure(error, &left));
    }
    let mut fields = InterpolatedFields::default();
    fields.add_dependents(file, &points)?;
    let error = error.with_detail(match input.write(&points, &fields) {
        Ok(()) => format!("The best mesh found was written: {}", out.display()),
        Err(error) => error.to_string(),
    });
    Err(failure(error, &left))
}

/// Returns the error for a boundary that no positions of the free vertices make valid.
fn misplaced_loop(file: &LoadedMesh, vertices: &[u32]) -> CliError {
    let place = file.vertex_place(vertices.first().copied().unwrap_or_default());
    CliError::run(format!(
        "{place}: the boundary loop of {} vertices through vertex {} is turned over, lies outside of the outer boundary, or lies \
         inside another hole, so no move of interior vertices untangles the mesh",
        vertices.len(),
        place.id
    ))
    .with_remedy("Correct the positions of the loop; --keep-going writes the best mesh found")
}

const PERHAPS: &str = ". Perhaps fixed vertices leave no room, or the boundary winds around itself";

/// Returns the error for a mesh without inverted triangles in which the triangles around a vertex wind more than once.
fn overlaps(file: &LoadedMesh, vertex: u32, sweeps: u32) -> CliError {
    let place = file.vertex_place(vertex);
    let vertex = place.id;
    CliError::run(format!(
        "{place}: after {} of untangling no triangle is inverted, but those around vertex {vertex} wind more than once around \
         it{PERHAPS}",
        counted(sweeps as usize, "sweep")
    ))
}

/// Returns the error for a mesh whose quadrilaterals could not be made convex; `None` if all are convex.
fn concave(file: &LoadedMesh, untangled: &Untangled) -> Option<CliError> {
    let Untangled { left_quadrilaterals: left, hopeless_quadrilaterals: hopeless, .. } = untangled;
    let (bad, why) = match hopeless.first() {
        Some(bad) => {
            (bad, "cannot become convex, as none of their three vertices is free".to_owned())
        }
        None => {
            let sweeps = counted(untangled.sweeps as usize, "sweep");
            (left.first()?, format!("are not convex after {sweeps} of untangling"))
        }
    };
    let count = if hopeless.is_empty() { left.len() } else { hopeless.len() };
    let (name, place) = explain::named(file, Element::Quadrilateral(bad.quadrilateral));
    let vertex = file.vertex_place(bad.vertices[bad.corner]).id;
    Some(CliError::run(format!(
        "{place}: {name} is {} at vertex {vertex}: {count} corners of quadrilaterals {why}",
        bad.problem()
    )))
}

/// The remaining problems of a tangled mesh.
struct TangledRest<'a> {
    /// All remaining inverted or flat triangles.
    triangles: &'a [BadTriangle],
    /// The remaining triangles that no move of vertices can mend.
    hopeless: &'a [BadTriangle],
    /// Number of completed sweeps.
    sweeps: u32,
    /// Whether a signal or the time limit ended untangling.
    was_ended: bool,
}

/// Returns the error for a mesh that could not be untangled. Lists the first hopeless triangles if any exist,
/// otherwise the first remaining triangles.
fn still_tangled(file: &LoadedMesh, left: &TangledRest<'_>) -> CliError {
    let TangledRest { triangles: left, hopeless, sweeps, was_ended } = *left;
    let name = file.source.path().display();
    let (shown, count, why) = match hopeless.len() {
        0 => {
            let perhaps = if was_ended { "" } else { PERHAPS };
            let sweeps = counted(sweeps as usize, "sweep");
            let why = format!("stayed inverted or flat after {sweeps} of untangling{perhaps}");
            (left, left.len(), why)
        }
        count => {
            let why = "cannot be mended by moving vertices, as none of their vertices is free, or two fixed vertices \
                       are at the same point. Vertices are fixed on the boundary, on lines, between regions and of other \
                       elements. Mend the file, or let vertices on lines move: --free-lines, or vertices between \
                       regions: --free-interfaces"
                .to_owned();
            (hopeless, count, why)
        }
    };
    let (triangles, first) = (
        counted(count, "triangle"),
        explain::bad_triangles(file, &shown[..count.min(explain::TOLD)]),
    );
    CliError::run(format!("{name}: {triangles} {why}")).with_details(explain::list(
        &first,
        count,
        explain::QUALITY_JSON,
    ))
}

/// Returns whether untangling may help: the mesh was refused for inverted or flat triangles, or has movable triangles
/// that double precision cannot judge.
pub(crate) fn can_mend(prepared: &Result<Smoother<'_>, MeshError>) -> bool {
    match prepared {
        Ok(smoother) => {
            smoother.beyond_precision().iter().any(|&t| smoother.topology().can_move(t))
        }
        Err(error) => matches!(error, MeshError::Infeasible { .. }),
    }
}
