//! The vertices of a mesh that stay, slide or move, by the options of the mesh.

use std::collections::HashSet;

use gpu_smooth::layers::{KeepLayers, Layers};
use gpu_smooth::{Mesh, MeshError, Slide, SmoothError, Smoother, Topology};
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

/// Warns of pairs of `lines` that are no edges of a mesh. Pairs of vertices that no element has are omitted, such as a network
/// of lines beside the mesh.
pub(crate) fn check_lines(mesh: &Mesh, options: &MeshOptions, remarks: &mut Remarks<'_>) {
    let lines = &options.lines;
    if lines.is_empty() || options.settings().frees_lines {
        return;
    }
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut missing: HashSet<[u32; 2]> = lines.iter().copied().map(sorted).collect();
    let mut has_element = vec![false; mesh.points.len()];
    let triangles = mesh.triangles.iter().map(|corners| &corners[..]);
    let quadrilaterals = mesh.quadrilaterals.iter().map(|corners| &corners[..]);
    for corners in triangles.chain(quadrilaterals) {
        for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            has_element[a as usize] = true;
            missing.remove(&sorted([a, b]));
        }
    }
    let is_stray = |line: [u32; 2]| {
        missing.contains(&sorted(line)) && line.iter().any(|&vertex| has_element[vertex as usize])
    };
    let mut stray = (0..).zip(lines).filter(|&(_, &line)| is_stray(line));
    if let Some((row, &line)) = stray.next() {
        remarks.stray_lines(row, line, stray.count());
    }
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
    let mut curves = domain.curves(&smoother.mesh().points, smoother.topology(), &by);
    let mut free_of_pairs = None;
    if !options.periodic.is_empty() {
        remove_pairs_inside(&mut curves.slide, smoother.mesh().points.len(), remarks);
        let without = Slide { periodic: Vec::new(), ..curves.slide.clone() };
        free_of_pairs = Some(smoother.set_slide(Some(&without))?);
    }
    let count = smoother.set_slide(Some(&curves.slide))?;
    remarks.sliding(smoother, count, curves.has_lost_pairs);
    let [_, unlike] = smoother.pairs();
    // Pairs that no motion fits have a warning of their own. They hold their neighbors too.
    let stuck = free_of_pairs.filter(|_| unlike == 0).map_or(0, |free| free.saturating_sub(count));
    remarks.stuck_pairs(stuck);
    Ok(())
}

/// Removes pairs with a vertex that is neither on the boundary nor on a line, and warns of them. The other vertex of such a pair
/// stays.
fn remove_pairs_inside(slide: &mut Slide, vertices: usize, remarks: &mut Remarks<'_>) {
    let mut is_on_line = vec![false; vertices];
    slide.lines.as_flattened().iter().for_each(|&vertex| is_on_line[vertex as usize] = true);
    let inside =
        |pair: &[u32; 2]| pair.iter().copied().find(|&vertex| !is_on_line[vertex as usize]);
    let pairs = slide.periodic.iter().flat_map(|periodic| &periodic.pairs);
    let mut removed = (0..).zip(pairs).filter_map(|(row, pair)| Some((row, inside(pair)?, *pair)));
    let Some((row, vertex, pair)) = removed.next() else { return };
    let mut held = pair.to_vec();
    held.extend(removed.flat_map(|(_, _, pair)| pair));
    remarks.pairs_inside(row, vertex, held.len() / 2 - 1);
    slide.periodic.iter_mut().for_each(|own| own.pairs.retain(|pair| inside(pair).is_none()));
    slide.held.extend(held.into_iter().filter(|&vertex| is_on_line[vertex as usize]));
}
