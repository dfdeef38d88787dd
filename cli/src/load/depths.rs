//! Depths of the water at the vertices of a mesh.

use mesh_io::PointField;

use crate::error::CliError;
use crate::load::LoadedMesh;

/// Whether the numbers of vertices with a name are depths of the water or heights of its bed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Direction {
    Down,
    /// Heights above the water at rest.
    Up,
}

/// Returns the direction of data of vertices with a name; `None` if the name is that of other data.
fn direction(name: &str) -> Option<Direction> {
    let name = name.trim().to_ascii_lowercase();
    if name.ends_with("depth") || name == "hauteur d'eau" {
        return Some(Direction::Down);
    }
    let is_height = name == "z" || name.ends_with("node_z") || name == "bottom" || name == "fond";
    is_height.then_some(Direction::Up)
}

/// Returns the depth of the water at each vertex of the mesh in the unit of the file, negative above the water at rest, and
/// NaN where the file has none: from data whose name ends in `depth`, else from heights (`z`, or `BOTTOM` of TELEMAC). Of
/// several time steps, the first one counts. Values in `fields` precede those of the file. `None` if the file has neither.
///
/// # Errors
/// Returns an error if the data are damaged.
pub(crate) fn depths(
    file: &LoadedMesh,
    fields: &[PointField],
) -> Result<Option<Vec<f64>>, CliError> {
    let is_coordinate = |name: &str| file.plane().is_some() && !file.source.has_data(name);
    let find = |wanted: Direction| {
        let names = file.source.data_names().iter();
        let mut names = names.filter(|name| !is_coordinate(name));
        names.find(|name| direction(name) == Some(wanted)).map(|name| (name, wanted))
    };
    let Some((name, direction)) = find(Direction::Down).or_else(|| find(Direction::Up)) else {
        return Ok(None);
    };
    let mut depths = match fields.iter().find(|field| field.name() == name) {
        Some(field) => field.values().to_vec(),
        None => file.source.point_array(name)?,
    };
    if direction == Direction::Up {
        depths.iter_mut().for_each(|depth| *depth = -*depth);
    }
    Ok(Some(match file.chart() {
        Some(chart) => chart.extended(&depths, 1),
        None => depths,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_depths_and_heights_are_known() {
        for name in ["depth", "WATER DEPTH", "mesh2d_node_depth", "HAUTEUR D'EAU"] {
            assert_eq!(direction(name), Some(Direction::Down), "{name}");
        }
        for name in ["z", "mesh2d_node_z", "BOTTOM", "FOND"] {
            assert_eq!(direction(name), Some(Direction::Up), "{name}");
        }
        for name in ["zeta", "BOTTOM FRICTION", "attribute"] {
            assert_eq!(direction(name), None, "{name}");
        }
    }
}
