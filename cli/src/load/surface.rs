//! Layout of a mesh on the surface of its coordinates.

use crate::error::CliError;
use crate::load::LoadedMesh;
use gpu_smooth::{front_ends::Chart, targets::Surface};

use crate::load::explain;
use crate::request::ThirdCoordinate;

/// Lays a mesh out on `surface`, and in its own plane if `z` is a coordinate. Returns remarks on the plane, or on
/// continued longitudes and poles.
pub(crate) fn lay_out(
    file: &mut LoadedMesh,
    surface: Surface,
    z: ThirdCoordinate,
) -> Result<Vec<String>, CliError> {
    if surface == Surface::Plane {
        return match z {
            ThirdCoordinate::Coordinate => file.lay_out_in_plane(),
            ThirdCoordinate::NamedData if file.source.has_data("z") => file.lay_out_in_plane(),
            ThirdCoordinate::Data | ThirdCoordinate::NamedData => Ok(Vec::new()),
        };
    }
    match file.domain.lay_out_on_sphere(file.precision()) {
        Ok(()) => Ok(file.chart().map(remarks).unwrap_or_default()),
        Err(error) => Err(explain::mesh_error(file, &error)),
    }
}

/// Converts a point of a laid-out mesh to the coordinates of the file, without continued longitudes. A mesh in a plane
/// other than that of x and y has its points in this plane.
pub(crate) fn as_in_file(file: &LoadedMesh, [x, y]: [f64; 2]) -> [f64; 2] {
    [file.chart().map_or(x, |chart| chart.given_longitude(x)), y]
}

/// Describes the triangles and vertices that the layout on the sphere affects.
fn remarks(chart: &Chart) -> Vec<String> {
    let mut remarks = Vec::new();
    let count = |n: usize, one: &str, many: &str| match n {
        1 => format!("1 {one}"),
        n => format!("{n} {many}"),
    };
    let points = &chart.original().points;
    let poles = points.iter().filter(|point| point[1].abs() == 90.0).count();
    let copied = |is_pole: bool| {
        let is_of = |&&v: &&u32| (points[v as usize][1].abs() == 90.0) == is_pole;
        let mut owners: Vec<u32> = chart.owners().iter().filter(is_of).copied().collect();
        owners.sort_unstable();
        owners.dedup();
        owners.len()
    };
    if chart.across() > 0 {
        let triangles = count(chart.across(), "element that reaches", "elements that reach");
        let mut text = format!(
            "longitudes are continued for {triangles} across the line where they start again, as at 180 degrees"
        );
        if let stay @ 1.. = copied(false) {
            let stay = count(stay, "vertex at that line stays", "vertices at that line stay");
            text += &format!("; the mesh closes around the globe, so {stay}");
        }
        remarks.push(text);
    }
    if chart.polar() > 0 && poles > 0 {
        let triangles = count(chart.polar(), "element at a pole stays", "elements at a pole stay");
        remarks
            .push(format!("{triangles}, with all vertices, as longitudes are no coordinate there"));
    }
    remarks
}
