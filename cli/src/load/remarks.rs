//! Remarks on a mesh after reading.

use gpu_smooth_job::{Adapted, look_like_degrees};
use mesh_io::{Format, Remark};

use crate::load::LoadedMesh;

/// Returns the remarks on a mesh, one line each. If `slides` is true, no remark says that vertices between regions stay
/// fixed.
pub(crate) fn remarks(file: &LoadedMesh, slides: bool) -> Vec<String> {
    // The effect of degrees depends on `--surface`.
    let is_told = |remark: &&Remark| match remark {
        Remark::Degrees => false,
        Remark::AllOnModelCurves => file.domain.holds_lines(),
        _ => true,
    };
    let told = file.source.remarks().iter().filter(is_told);
    let moves = file.domain.moves_quadrilaterals();
    let effect = |remark| with_effect(remark, moves, slides);
    let mut remarks: Vec<String> = told.map(effect).collect();
    let source = &file.source;
    match source.quadrilaterals().len() - source.proper_quadrilaterals().count() {
        0 => {}
        _ if !moves => {}
        1 => {
            remarks.push("1 quadrilateral lists a vertex twice: its vertices stay fixed".to_owned())
        }
        n => remarks
            .push(format!("{n} quadrilaterals list a vertex twice: their vertices stay fixed")),
    }
    match file.domain.interface_vertices().len() {
        0 => {}
        _ if slides => {}
        1 => remarks.push(
            "1 vertex between regions stays fixed (--free-interfaces lets it move)".to_owned(),
        ),
        n => remarks.push(format!(
            "{n} vertices between regions stay fixed (--free-interfaces lets them move)"
        )),
    }
    remarks
}

/// Adds to a remark of the file how a run treats the affected vertices. `moves` tells whether vertices of quadrilaterals may
/// move, and `slides` whether vertices on lines slide.
fn with_effect(remark: &Remark, moves: bool, slides: bool) -> String {
    match remark {
        Remark::OtherElements { name, .. } if moves && name.starts_with("quadrilateral") => {
            format!("{remark}, whose vertices may move")
        }
        Remark::OtherElements { count, name } => {
            let their = if *count == 1 { "its" } else { "their" };
            let slide = match slides && is_of_lines(name) {
                true => ", or slide along lines",
                false => "",
            };
            format!("{remark}: {their} vertices stay fixed{slide}")
        }
        Remark::AllOnModelCurves => {
            format!("{remark}: all of them stay fixed (--free-lines lets those on curves move)")
        }
        Remark::UnlistedPairs { count, list } => format!(
            "periodic pairs that name a node which {list} does not list do not slide: {count}"
        ),
        Remark::RegionArray { others, .. } => match &others[..] {
            [] => format!("{remark} (--regions NAME takes others)"),
            names => {
                format!("{remark}, and not `{}` (--regions NAME takes others)", names.join("`, `"))
            }
        },
        Remark::FurtherRegionArrays(_) => {
            format!("{remark}, and are not used (--regions NAME takes them instead)")
        }
        _ => remark.to_string(),
    }
}

/// Returns whether elements that are no triangles are lines, to judge by their name in a remark. Vertices of quadrilaterals, of
/// ghosts and of elements that constrain nodes stay where they are.
fn is_of_lines(name: &str) -> bool {
    ["edge", "node", "segment"].iter().any(|line| name.starts_with(line))
}

/// Returns the remark on an adapted mesh.
pub(crate) fn adapted(adapted: Adapted) -> String {
    match adapted {
        Adapted::Stretched(stretching) => format!(
            "the mesh is adapted: around one vertex in twenty, elements are stretched {stretching:.1}-fold or more; they \
             become equilateral or square unless --target keep-shape keeps their stretching and sizes"
        ),
        Adapted::Graded(gradation) => format!(
            "the mesh is graded: sizes differ {gradation:.0}-fold from fine to coarse parts; they become more even unless \
             --target keep-size keeps them"
        ),
    }
}

/// Returns a remark if a file says that its coordinates are longitude and latitude, or if a mesh in a format of coastal
/// models seems to have longitudes and latitudes, at latitudes above 20°, where a degree of longitude is shorter by more
/// than 6 %. `None` for other meshes, and if a file says that its coordinates have another unit.
pub(crate) fn degrees(file: &LoadedMesh) -> Option<String> {
    if file.source.remarks().contains(&Remark::Degrees) {
        return Some(format!(
            "{}: --surface sphere smooths them as longitude and latitude",
            Remark::Degrees
        ));
    }
    if file.source.says_degrees() == Some(false) {
        return None;
    }
    let is_of_oceans = matches!(
        file.source.format(),
        Format::Adcirc
            | Format::Sms2dm
            | Format::Mike
            | Format::Fvcom
            | Format::Selafin
            | Format::Ugrid
    );
    (is_of_oceans && look_like_degrees(&file.mesh().points, is_of_oceans)).then(|| {
        "the coordinates look like degrees: --surface sphere smooths them as longitude and latitude"
            .to_owned()
    })
}
