//! The vertices of a mesh that stay, slide or move, by the options of the mesh.

use gpu_smooth::layers::{Elements, KeepLayers, Layers};
use gpu_smooth::slide::Periodic;
use gpu_smooth::{Mesh, MeshError, Slide, Topology, select};
use mesh_io::edges_between_regions;

use crate::mesh_options::MeshOptions;

/// The vertices of a mesh that are not free.
#[derive(Clone)]
pub(crate) struct Constraints {
    /// Edges whose vertices stay, or slide along the edges.
    pub(crate) lines: Vec<[u32; 2]>,
    /// Vertices that neither move nor slide.
    pub(crate) held: Vec<u32>,
}

/// Sets the fixed vertices of a mesh by its options.
pub(crate) fn fix(mesh: &mut Mesh, options: &MeshOptions) -> Result<Constraints, MeshError> {
    let mut lines = options.lines.clone();
    lines.extend(edges_between_regions(&options.regions, &mesh.triangles, mesh.points.len()));
    let mut held = options.fixed.clone();
    if let Some(limit) = options.only_bad {
        let topology = Topology::new(mesh)?;
        let bad = select::triangles_above(&mesh.points, &topology, limit);
        let near = select::vertices_near(&topology, &bad, options.rings.unwrap_or(2));
        let mut is_near = vec![false; mesh.points.len()];
        near.into_iter().for_each(|v| is_near[v as usize] = true);
        held.extend((0..).zip(is_near).filter(|(_, is_near)| !is_near).map(|(v, _)| v));
    }
    mesh.fixed = [&held, lines.as_flattened()].concat();
    Ok(Constraints { lines, held })
}

/// The effect of the boundary layers that stay.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum LayersEffect {
    /// The vertices of layers are fixed, if any were found.
    Fixed,
    /// All free vertices are in layers. No vertex is fixed, and runs have no sweeps.
    AllKept,
    /// The walls, rows or distance of the options have no layer.
    NotFound,
}

/// Returns the boundary layers that stay. Fixes their vertices, which untangling leaves alone too, unless no other vertex
/// is free.
pub(crate) fn keep_layers(
    mesh: &mut Mesh,
    options: &MeshOptions,
    constraints: &Constraints,
) -> Result<(Layers, LayersEffect), MeshError> {
    if options.keep_layers == KeepLayers::None {
        return Ok((Layers::default(), LayersEffect::Fixed));
    }
    let topology = Topology::new(mesh)?;
    let points = &mesh.points;
    let elements = Elements { topology: &topology, points, faces: &[], lines: &constraints.lines };
    let layers = options.keep_layers.find(&elements, options.walls.as_deref())?;
    if layers.have_all_free(&topology) {
        return Ok((layers, LayersEffect::AllKept));
    }
    let is_asked = options.walls.is_some() || options.keep_layers != KeepLayers::Auto;
    if is_asked && layers.vertices.is_empty() {
        return Ok((layers, LayersEffect::NotFound));
    }
    mesh.fixed.extend_from_slice(&layers.vertices);
    Ok((layers, LayersEffect::Fixed))
}

/// Returns the curves along which vertices slide.
pub(crate) fn slide(
    options: &MeshOptions,
    topology: &Topology<'_>,
    constraints: &Constraints,
) -> Slide {
    let Constraints { mut lines, held } = constraints.clone();
    // Fixed vertices on the boundary slide only if their boundary edges are listed.
    lines.extend(topology.boundary_edges());
    let periodic = match options.periodic.is_empty() {
        true => Vec::new(),
        false => vec![Periodic { pairs: options.periodic.clone(), motion: None }],
    };
    let usual = Slide::default();
    Slide {
        corner_angle: options.corner_angle.unwrap_or(usual.corner_angle),
        hausdorff: options.hausdorff,
        lines,
        held,
        periodic,
    }
}
