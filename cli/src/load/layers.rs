//! Boundary layers of a mesh that stay.

use std::collections::HashSet;

use gpu_smooth::layers::{KeepLayers, Layers};
use gpu_smooth::{DetachedTopology, Topology};
use gpu_smooth_job::{is_at_wall, overlooks_boundary, overlooks_wall, vertices_in_rows};
use mesh_io::Group;

use crate::error::CliError;
use crate::kept_layers::KeptLayers;
use crate::load::named::{named, refusal};
use crate::load::walls::name;
use crate::load::{LoadedMesh, explain};

const OPTION: &str = "--keep-layers";

/// Number of groups that a note names.
const NAMED: usize = 4;

/// The effect of `--keep-layers` on a mesh.
#[derive(Default)]
pub(super) struct KeptLayersEffect {
    pub(super) notes: Vec<String>,
    /// Vertices that the layers fix and that were free before, ascending.
    pub(super) fixed: Vec<u32>,
    /// The reason if no vertex outside of the layers is free. The mesh is then unchanged.
    pub(super) nothing_to_do: Option<String>,
    /// The topology of the mesh, if no layer fixes a vertex.
    pub(super) topology: Option<DetachedTopology>,
}

/// Fixes the vertices of the layers that stay. If no other vertex is free, nothing is fixed and nothing is to do.
pub(super) fn keep_layers(
    file: &mut LoadedMesh,
    kept: &KeptLayers,
) -> Result<KeptLayersEffect, CliError> {
    let mut effect = KeptLayersEffect::default();
    if kept.keep == KeepLayers::None {
        return Ok(effect);
    }
    // The preparation of the run reports errors of the mesh.
    let Ok(topology) = Topology::new(file.mesh()) else { return Ok(effect) };
    let layers = find(file, &topology, kept)?;
    effect.notes = overlooked(file, &topology, kept, &layers)?;
    if layers.vertices.is_empty() {
        effect.topology = Some(topology.detach());
        return Ok(effect);
    }
    effect.notes.push(note(file, kept, &layers)?);
    if layers.have_all_free(&topology) {
        let text = "every free vertex is in a boundary layer that stays (--keep-layers none lets them move)";
        effect.nothing_to_do = Some(text.to_owned());
        return Ok(effect);
    }
    let is_free = |&vertex: &u32| topology.free()[vertex as usize];
    effect.fixed = layers.vertices.iter().copied().filter(is_free).collect();
    drop(topology);
    file.domain.fix(&layers.vertices)?;
    Ok(effect)
}

/// Finds the layers that an option keeps.
fn find(file: &LoadedMesh, topology: &Topology<'_>, kept: &KeptLayers) -> Result<Layers, CliError> {
    let walls = match &kept.groups {
        None => None,
        Some(text) => {
            let named = named(file, file.groups()?, OPTION, text)?;
            Some(named.iter().flat_map(|(_, group)| group.vertices()).copied().collect::<Vec<_>>())
        }
    };
    let faces = file.domain.faces_beside_mesh(&file.source);
    let layers = file.domain.layers(topology, kept.keep, walls.as_deref(), &faces);
    let layers = layers.map_err(|error| explain::mesh_error(file, &error))?;
    let is_asked = kept.groups.is_some() || kept.keep != KeepLayers::Auto;
    match layers.vertices.is_empty() && is_asked {
        true => {
            let problem = match kept.groups {
                Some(_) => "the groups have no wall with such a layer",
                None => {
                    "no wall has a layer: name the groups of walls behind a comma, as in rows=3,WALL"
                }
            };
            Err(refusal(file, OPTION, problem))
        }
        false => Ok(layers),
    }
}

/// Returns the line on the layers that stay.
fn note(file: &LoadedMesh, kept: &KeptLayers, layers: &Layers) -> Result<String, CliError> {
    let inner = vertices_in_rows(layers);
    let is_below = |group: &Group| is_at_wall(layers, group.vertices());
    let names = match &kept.groups {
        None => distinct(file.groups_of_lines()?.into_iter().filter(|group| is_below(group))),
        Some(text) => {
            // Rows and distances count from all walls of the option, found layers perhaps from some.
            let is_meant = |group: &Group| kept.keep != KeepLayers::Auto || is_below(group);
            let named = named(file, file.groups()?, OPTION, text)?.into_iter();
            let mut names: Vec<String> =
                named.filter(|(_, group)| is_meant(group)).map(|(name, _)| name.into()).collect();
            // Several groups may share a name.
            names.dedup();
            names
        }
    };
    let at = match names.len() {
        0 => "the boundary".to_owned(),
        n if n > NAMED => format!("{} and {} other groups", names[..NAMED].join(", "), n - NAMED),
        _ => names.join(", "),
    };
    let size = match (kept.keep, layers.rows) {
        (KeepLayers::Within(distance), _) => format!("within {distance} of"),
        (_, 1) => "in 1 row at".to_owned(),
        (_, rows) => format!("in {rows} rows at"),
    };
    let stay = if inner == 1 { "1 vertex" } else { &format!("{inner} vertices") };
    let (verb, them) = if inner == 1 { ("stays", "it") } else { ("stay", "them") };
    Ok(format!("layers: {stay} {size} {at} {verb} (--keep-layers none lets {them} move)"))
}

/// Returns notes on walls at which layers may begin at half of the vertices, and none was found.
fn overlooked(
    file: &LoadedMesh,
    topology: &Topology<'_>,
    kept: &KeptLayers,
    layers: &Layers,
) -> Result<Vec<String>, CliError> {
    if kept.groups.is_some() || layers.seeds.is_empty() {
        return Ok(Vec::new());
    }
    let note = |wall: &str, group: &str| {
        format!(
            "the elements at {wall} are flat like those of a boundary layer, but no layer was found: \
             --keep-layers rows=N{group} keeps the first N rows"
        )
    };
    let lines = file.groups_of_lines()?;
    if lines.is_empty() {
        let has_one = overlooks_boundary(layers, kept.keep, topology);
        return Ok(has_one.then(|| note("the boundary", "")).into_iter().collect());
    }
    let found =
        lines.into_iter().filter(|group| overlooks_wall(layers, kept.keep, group.vertices()));
    let names = distinct(found);
    Ok(names.iter().take(NAMED).map(|name| note(name, &format!(",{name}"))).collect())
}

/// Returns the names of walls. A group whose vertices are all in earlier groups has no name of its own: entities of a model are
/// parts of physical groups, which precede them.
fn distinct<'g>(walls: impl Iterator<Item = &'g Group>) -> Vec<String> {
    let mut known = HashSet::new();
    let is_new = |group: &&Group| {
        // All vertices become known.
        group.vertices().iter().filter(|vertex| known.insert(**vertex)).count() > 0
    };
    walls.filter(is_new).map(name).collect()
}
