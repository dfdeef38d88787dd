//! What is wrong with a mesh, in the terms of its file.

use gpu_smooth::{MeshError, MeshFile};

/// One line: file, place, problem, remedy.
pub(crate) fn mesh_error(file: &MeshFile, error: &MeshError) -> String {
    let name = |v: u32| file.vertex_place(v).label;
    match *error {
        MeshError::Infeasible { count, first, flat, .. } => {
            let place = file.triangle_place(first);
            // As the file lists them; the error may have turned them over.
            let [a, b, c] = file.mesh().triangles[first].map(name);
            let bad = if flat { "flat" } else { "inverted" };
            let which = match count {
                1 => format!("triangle {} (vertices {a}, {b}, {c}) is {bad}", place.label),
                _ => format!(
                    "{count} triangles are inverted or flat, the first is triangle {} (vertices {a}, {b}, {c}), which is {bad}",
                    place.label
                ),
            };
            format!(
                "{place}: {which}. Untangle the mesh first: smoothing keeps triangles from \
                 inverting, and cannot turn one back"
            )
        }
        MeshError::EdgeOfThree { edge, ref triangles } => {
            let places: Vec<_> = triangles.iter().map(|&t| file.triangle_place(t)).collect();
            let labels: Vec<_> = places.iter().map(|place| place.label.to_string()).collect();
            let mut ends = edge.map(name);
            ends.sort_unstable();
            let [a, b] = ends;
            format!(
                "{}: the edge between vertices {a} and {b} belongs to {} triangles ({}). In a 2D mesh \
                 an edge has one or two: remove the others",
                places.last().map(ToString::to_string).unwrap_or_default(),
                labels.len(),
                labels.join(", ")
            )
        }
        MeshError::NotFinite { vertex } => {
            format!("{}: {error}. Correct the line", file.vertex_place(vertex))
        }
        MeshError::NothingFree { .. } => format!(
            "{}: {error}: all are on the boundary, on constraint lines, between regions or of other \
             elements. {}",
            file.path().display(),
            match file.interface_vertices() {
                [] => "There is nothing to smooth",
                _ => "Let those between regions move: --free-interfaces",
            }
        ),
        MeshError::OutOfRange { .. } => {
            format!("{}: {error}. Write the mesh in another unit", file.path().display())
        }
        // The readers do not let these pass.
        MeshError::Empty
        | MeshError::TooLarge { .. }
        | MeshError::IndexOutOfRange { .. }
        | MeshError::RepeatedVertex { .. } => format!("{}: {error}", file.path().display()),
    }
}
