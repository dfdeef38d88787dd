//! Protection of existing files: a written mesh may replace an earlier state of the mesh, but no foreign mesh or
//! file.

use std::fs;
use std::path::{Path, PathBuf};

use gpu_smooth::Topology;
use mesh_io::{MeshFile, PointField, ReadError, atomic};

use crate::error::CliError;
use crate::load::LoadedMesh;
use crate::request::ReadRequest;
use crate::terminal::numbers::elements;

/// Properties in which a written mesh must equal the existing mesh that is replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Likeness {
    /// The elements and the fixed vertices, and unless vertices slide the place and the data of the boundary.
    Mesh { slides: bool },
    /// The elements. A conversion may lose groups, and with them the constraints that fix vertices.
    Elements,
}

/// Checks that the files `written`, the main file first, are empty or hold the input mesh or an earlier state of the
/// mesh. Devices and pipes count as empty. `reading` tells how the mesh was read.
///
/// # Errors
/// Returns an error of kind [`Output`](crate::error::ErrorKind::Output) if a file holds another mesh, or has content
/// that cannot be read as a mesh.
pub(crate) fn check(
    file: &LoadedMesh,
    written: &[PathBuf],
    reading: &ReadRequest,
    likeness: Likeness,
) -> Result<(), CliError> {
    let Some(main) = written.first() else { return Ok(()) };
    if atomic::same_file(main, file.source.path()) {
        return Ok(());
    }
    let is_full = |path: &PathBuf| fs::metadata(path).is_ok_and(|at| at.is_file() && at.len() > 0);
    // A killed run may leave companion files without the main file. Companions of a Triangle mesh are copies of the
    // input's.
    let own: Vec<&[u8]> = file.source.contents().map(|(_, bytes)| bytes).collect();
    let is_copy = |(part, path): (usize, &PathBuf)| {
        !is_full(path)
            || own.get(part).is_some_and(|&own| fs::read(path).is_ok_and(|old| old == own))
    };
    let Some(first) = written.iter().find(|path| is_full(path)) else { return Ok(()) };
    if !main.exists() && written.iter().enumerate().skip(1).all(is_copy) {
        return Ok(());
    }
    // A read from a pipe would block until a writer appears.
    let is_readable = written.iter().all(|path| !path.exists() || path.is_file());
    let old = match is_readable {
        true => read(main, reading).map_err(|error| match error {
            // The remedy of a damaged mesh is none for a file that is no mesh.
            ReadError::Content { path, location, problem, .. } => {
                format!("{}{location}: {problem}", path.display())
            }
            ReadError::Format { problem, .. } => problem,
            error => error.to_string(),
        }),
        false => Err("one of its files is no regular file".to_owned()),
    };
    let (path, read) = (first.display(), file.source.path().display());
    let difference = |old: MeshFile| {
        difference(&file.source, &old, likeness).or_else(|| match likeness {
            Likeness::Mesh { slides } => difference_of_vertices(file, &old, slides),
            Likeness::Elements => None,
        })
    };
    let text = match old.map(difference) {
        Ok(None) => return Ok(()),
        Ok(Some(difference)) => format!("{path}: holds another mesh than {read}: {difference}"),
        Err(problem) => format!("{path}: exists, and cannot be read as a mesh: {problem}"),
    };
    Err(CliError::output(text))
}

/// Reads an existing mesh. An STL is joined to vertices, independent of the format of the input. If the mesh lacks the cell
/// data that number the regions of the input, its regions are those of the reader's choice.
fn read(path: &Path, reading: &ReadRequest) -> Result<MeshFile, ReadError> {
    let options = reading.options();
    match options.clone().read(path) {
        Err(ReadError::Unwelded { .. }) => options.weld(true).regions(None).read(path),
        Err(_) if reading.regions.is_some() => options.regions(None).read(path),
        read => read,
    }
}

/// Describes the first difference between two meshes; `None` if `new` may replace `old`.
fn difference(new: &MeshFile, old: &MeshFile, likeness: Likeness) -> Option<String> {
    // A mesh that was converted to another format may have lost its quadrilaterals.
    let has_lost = likeness == Likeness::Elements
        && !(new.holds_quadrilaterals() && old.holds_quadrilaterals());
    let quadrilaterals = |file: &MeshFile| match has_lost {
        true => Vec::new(),
        false => file.proper_quadrilaterals().map(|(_, own)| *own).collect(),
    };
    let [of_new, of_old] = [new, old].map(quadrilaterals);
    let [old_counts, new_counts] = [(old, &of_old), (new, &of_new)]
        .map(|(file, own)| (file.points().len(), elements(file.triangles().len(), own.len())));
    if new_counts != old_counts {
        let ((vertices, elements), (own_vertices, own_elements)) = (old_counts, new_counts);
        return Some(format!(
            "it has {vertices} vertices and {elements}, not {own_vertices} and {own_elements}"
        ));
    }
    let have_other_triangles = new.triangles() != old.triangles()
        && ascending(new.triangles()) != ascending(old.triangles());
    if have_other_triangles || ascending(&of_new) != ascending(&of_old) {
        return Some("the vertices of its elements are others".to_owned());
    }
    (likeness != Likeness::Elements && fixed(new) != fixed(old))
        .then(|| "its fixed vertices are others".to_owned())
}

/// Returns whether the boxes around vertices differ by more than a tenth of their size between two lists of points. Vertices
/// that slide may change the box of a mesh without corners a little.
fn is_elsewhere(points: [&[[f64; 2]]; 2], vertices: &[usize]) -> bool {
    let ends = |points: &[[f64; 2]], axis: usize| {
        let of_axis = vertices.iter().map(|&v| points[v][axis]);
        [of_axis.clone().fold(f64::INFINITY, f64::min), of_axis.fold(f64::NEG_INFINITY, f64::max)]
    };
    let boxes = [0, 1].map(|axis| points.map(|points| ends(points, axis)));
    let size = boxes.iter().map(|[[low, high], _]| high - low).fold(0.0, f64::max);
    let mut ends = boxes.iter().flat_map(|[new, old]| new.iter().zip(old));
    ends.any(|(new, old)| (new - old).abs() > 0.1 * size)
}

/// Describes the first difference between the boundary of a mesh with equal elements and that of `old`: the places and data of its
/// vertices. `None` if these are no reason to keep `old`. Other vertices may have moved in an earlier run with other options, which
/// may also have let vertices of the boundary slide. If `slides`, nothing is compared.
fn difference_of_vertices(new: &LoadedMesh, old: &MeshFile, slides: bool) -> Option<String> {
    let names = old.data_names();
    if let Some(name) = names.iter().find(|name| !new.source.data_names().contains(name)) {
        return Some(format!("it has data of vertices that would be lost: `{name}`"));
    }
    // A run refuses a mesh without a topology.
    let topology = Topology::new(new.mesh()).ok().filter(|_| !slides)?;
    let points = [new.source.points(), old.points()];
    let mut boundary: Vec<usize> =
        topology.boundary_edges().as_flattened().iter().map(|&v| v as usize).collect();
    // Copies of vertices on the sphere come last.
    boundary.retain(|&v| v < points[0].len());
    if is_elsewhere(points, &boundary) {
        return Some("its boundary is elsewhere".to_owned());
    }
    // Vertices that slid in an earlier run may have interpolated data.
    boundary.retain(|&v| points[0][v] == points[1][v]);
    if names.is_empty() {
        return None;
    }
    // Whatever is wrong with data, a run that needs them says so.
    let fields = [&new.source, old].map(|file| file.point_fields(Some(names)));
    let [Ok(of_new), Ok(of_old)] = fields else { return None };
    let has_places = new.source.has_third_coordinates();
    let other = of_new.iter().zip(&of_old).find(|(new, old)| {
        let each = new.components();
        let values = |field: &PointField, v: usize| {
            let own = field.values().get(v * each..(v + 1) * each);
            own.map(|own| own.iter().map(|x| x.to_bits()).collect::<Vec<_>>())
        };
        let is_place = new.is_third_of_points() && has_places;
        !is_place && boundary.iter().any(|&v| values(new, v) != values(old, v))
    });
    other.map(|(field, _)| format!("its data on the boundary are others: `{}`", field.name()))
}

/// Returns elements sorted, with sorted corners, independent of the order in the file.
fn ascending<const N: usize>(elements: &[[u32; N]]) -> Vec<[u32; N]> {
    let sorted = |corners: &[u32; N]| {
        let mut corners = *corners;
        corners.sort_unstable();
        corners
    };
    let mut elements: Vec<_> = elements.iter().map(sorted).collect();
    elements.sort_unstable();
    elements
}

/// Returns the vertices fixed by the file, ascending. Vertices of quadrilaterals count only if materials, lines or points fix
/// them, because all of them would be equal in meshes with other materials and lines.
fn fixed(file: &MeshFile) -> Vec<u32> {
    let mut fixed = file.constraints_beside_quadrilaterals().vertices;
    fixed.extend(file.interfaces_of_elements().0);
    fixed.sort_unstable();
    fixed.dedup();
    fixed
}
