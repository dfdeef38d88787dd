//! The vertices of a mesh that stay, slide or move, by the options of the mesh.

use gpu_smooth::layers::{KeepLayers, Layers};
use gpu_smooth::{Mesh, MeshError, SmoothError, Smoother, Topology};
use gpu_smooth_job::{Domain, SlideBy, overlooks_boundary};

use crate::mesh_options::MeshOptions;
use crate::remarks::Remarks;

/// Returns the domain of a mesh with the lines, regions, fixed vertices and pairs of its options.
pub(crate) fn domain(mesh: Mesh, options: &MeshOptions) -> Result<Domain, MeshError> {
    let mut domain = Domain::of_mesh(mesh, options.lines.clone(), &options.regions);
    if options.settings().frees_lines {
        domain.free_lines();
    }
    domain.fix(&options.fixed)?;
    if !options.periodic.is_empty() {
        domain.pair(options.periodic.clone());
    }
    Ok(domain)
}

/// Returns the boundary layers that stay. Fixes their vertices, which untangling leaves alone too, unless no other vertex
/// is free.
pub(crate) fn keep_layers(
    domain: &mut Domain,
    options: &MeshOptions,
    remarks: &mut Remarks<'_>,
) -> Result<Layers, MeshError> {
    let (keep, walls) = (options.keep_layers, options.walls.as_deref());
    if keep == KeepLayers::None && !domain.keeps_all() {
        return Ok(Layers::default());
    }
    let topology = Topology::new(domain.mesh())?;
    let layers = domain.layers(&topology, keep, walls, &[])?;
    if domain.keeps_all() {
        return Ok(layers);
    }
    if walls.is_none() && overlooks_boundary(&layers, keep, &topology) {
        remarks.overlooked_layers();
    }
    if layers.have_all_free(&topology) {
        remarks.warn(
            "keep_layers: every free vertex is in a boundary layer that stays, so the points do not move. Pass \
             keep_layers=\"none\" to let them move"
                .to_owned(),
        );
        return Ok(layers);
    }
    let is_asked = walls.is_some() || keep != KeepLayers::Auto;
    if is_asked && layers.vertices.is_empty() {
        remarks.warn(
            "keep_layers: no wall has such a layer, so all vertices may move. Pass the vertices of walls, as in (\"rows=3\", \
             walls)"
                .to_owned(),
        );
        return Ok(layers);
    }
    drop(topology);
    remarks.layers(&layers, keep);
    domain.fix(&layers.vertices)?;
    Ok(layers)
}

/// Sets the vertices of a smoother that slide along the curves of a domain.
pub(crate) fn slide(
    options: &MeshOptions,
    domain: &Domain,
    smoother: &mut Smoother<'_>,
    remarks: &mut Remarks<'_>,
) -> Result<(), SmoothError> {
    let mut by = SlideBy::default();
    by.corner_angle = options.settings().corner_angle.unwrap_or(by.corner_angle);
    by.hausdorff = options.settings().hausdorff;
    let curves = domain.curves(&smoother.mesh().points, smoother.topology(), &by);
    let count = smoother.set_slide(Some(&curves.slide))?;
    remarks.sliding(smoother, count, curves.has_lost_pairs);
    Ok(())
}
