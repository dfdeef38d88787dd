//! Reads files with long lists on all threads and item by item. Both must yield equal meshes and equal errors.

use crate::detect;
use crate::disk::source::{Companion, Source};
use crate::edit::numbers::Offsets;
use crate::visit::mesh_builder::parse_by;
use crate::visit::parsed_mesh::ParsedMesh;

/// Vertices along a side, so that all lists are long enough to be read on all threads.
const SIDE: usize = 135;

/// Numbers in binary; true for little-endian byte order.
struct Binary(Vec<u8>, bool);

impl Binary {
    fn put(&mut self, low_first: &[u8]) {
        let start = self.0.len();
        self.0.extend_from_slice(low_first);
        if self.1 {
            self.0[start..].reverse();
        }
    }

    fn ints(&mut self, numbers: impl IntoIterator<Item = usize>) {
        numbers.into_iter().for_each(|n| self.put(&(n as i32).to_le_bytes()));
    }

    fn sizes(&mut self, numbers: impl IntoIterator<Item = usize>) {
        numbers.into_iter().for_each(|n| self.put(&(n as u64).to_le_bytes()));
    }

    fn reals(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|x| self.put(&x.to_le_bytes()));
    }

    fn text(&mut self, text: &str) {
        self.0.extend_from_slice(text.as_bytes());
    }

    /// Appends a Fortran record, with its length before and after the content.
    fn record(&mut self, put: impl Fn(&mut Binary)) {
        let mut record = Binary(Vec::new(), self.1);
        put(&mut record);
        self.ints([record.0.len()]);
        self.0.extend_from_slice(&record.0);
        self.ints([record.0.len()]);
    }
}

/// The separator of the `.node` and the `.ele` of a Triangle mesh.
const NEXT_FILE: &[u8] = b"# next file\n";

/// Returns meshes in the formats that have records, and one of Triangle, whose two files are separated by
/// [`NEXT_FILE`]. A few elements are no triangles.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let points: Vec<[f64; 2]> = (0..SIDE * SIDE)
        .map(|v| [(v % SIDE) as f64 + 1.0 / (v + 2) as f64, (v / SIDE) as f64])
        .collect();
    let cells = (0..SIDE * (SIDE - 1)).filter(|v| v % SIDE != SIDE - 1);
    let triangles: Vec<[usize; 3]> =
        cells.flat_map(|v| [[v, v + 1, v + SIDE + 1], [v, v + SIDE + 1, v + SIDE]]).collect();
    let (n, m) = (points.len(), triangles.len());
    let flat = || points.iter().flatten().copied();
    let in_space = || points.iter().flat_map(|&[x, y]| [x, y, 2.0]);
    let region = |t: usize| 3 + usize::from(t > 20_000) + usize::from(t % 1000 == 999);
    let mut files = Vec::new();

    let mut file = Binary(Vec::new(), false);
    file.text(&format!("{n} 2 1 1\n"));
    for (v, [x, y]) in points.iter().enumerate() {
        file.text(&format!("{} {x:?} {y:?} 0.5 {}\n", v + 1, v % 2));
    }
    file.0.extend_from_slice(NEXT_FILE);
    file.text(&format!("{m} 3 1\n"));
    for (t, [a, b, c]) in triangles.iter().enumerate() {
        file.text(&format!("{} {} {} {} {}\n", t + 1, a + 1, b + 1, c + 1, region(t)));
    }
    files.push(("m.node", file.0));

    let mut file = Binary(Vec::new(), false);
    file.ints([1, 2, 3, 20, 2, 4, 32 + 20 * n, n]);
    for &point in &points {
        file.reals(point);
        file.ints([0]);
    }
    file.ints([6, 44 + 20 * n + 16 * m, m]);
    for (t, corners) in triangles.iter().enumerate() {
        file.ints(corners.map(|v| v + 1));
        file.ints([region(t)]);
    }
    file.ints([54, 0]);
    files.push(("m.meshb", file.0));

    for by_offsets in [false, true] {
        let mut file = Binary(Vec::new(), true);
        file.text("# vtk DataFile Version 5.1\nm\nBINARY\nDATASET UNSTRUCTURED_GRID\n");
        file.text(&format!("POINTS {n} double\n"));
        file.reals(in_space());
        // Two lines stand among the triangles.
        let is_line = |t: usize| t == 30_000 || t == 0;
        let lines = (0..m).filter(|&t| is_line(t)).count();
        let kept = |t: usize| if is_line(t) { 2 } else { 3 };
        match by_offsets {
            false => {
                file.text(&format!("\nCELLS {m} {}\n", 4 * m - lines));
                for (t, corners) in triangles.iter().enumerate() {
                    file.ints([kept(t)]);
                    file.ints(corners[..kept(t)].iter().copied());
                }
            }
            true => {
                file.text(&format!("\nCELLS {} {}\n", m + 1, 3 * m - lines));
                file.text("OFFSETS vtktypeint64\n");
                let mut end = 0;
                file.sizes([0]);
                for t in 0..m {
                    end += kept(t);
                    file.sizes([end]);
                }
                file.text("\nCONNECTIVITY vtktypeint64\n");
                for (t, corners) in triangles.iter().enumerate() {
                    file.sizes(corners[..kept(t)].iter().copied());
                }
            }
        }
        file.text(&format!("\nCELL_TYPES {m}\n"));
        file.ints((0..m).map(|t| if is_line(t) { 3 } else { 5 }));
        file.text(&format!("\nCELL_DATA {m}\nSCALARS region int 1\nLOOKUP_TABLE default\n"));
        file.ints((0..m).map(region));
        files.push(("m.vtk", file.0));
    }

    let mut file = Binary(b"$MeshFormat\n2.2 1 8\n".to_vec(), true);
    file.ints([1]);
    file.text(&format!("\n$EndMeshFormat\n$Nodes\n{n}\n"));
    for (v, &[x, y]) in points.iter().enumerate() {
        file.ints([3 * v + 1]);
        file.reals([x, y, 0.0]);
    }
    file.text(&format!("\n$EndNodes\n$Elements\n{m}\n"));
    file.ints([2, m, 2]);
    for (t, corners) in triangles.iter().enumerate() {
        file.ints([t + 1, region(t), 7]);
        file.ints(corners.map(|v| 3 * v + 1));
    }
    file.text("\n$EndElements\n");
    files.push(("m22.msh", file.0));

    let mut file = Binary(b"$MeshFormat\n4.1 1 8\n".to_vec(), false);
    file.ints([1]);
    file.text("\n$EndMeshFormat\n$Nodes\n");
    file.sizes([2, n, 1, n]);
    for (first, count) in [(0, n - 1), (n - 1, 1)] {
        file.ints([2, 1, 0]);
        file.sizes([count]);
        file.sizes((first..first + count).map(|v| v + 1));
        file.reals(points[first..first + count].iter().flat_map(|&[x, y]| [x, y, x]));
    }
    file.text("\n$EndNodes\n$Elements\n");
    file.sizes([2, m, 1, m]);
    for (first, count) in [(0, 18_000), (18_000, m - 18_000)] {
        file.ints([2, first + 1, 2]);
        file.sizes([count]);
        for (t, corners) in triangles.iter().enumerate().skip(first).take(count) {
            file.sizes([t + 1]);
            file.sizes(corners.map(|v| v + 1));
        }
    }
    file.text("\n$EndElements\n");
    files.push(("m41.msh", file.0));

    let mut file = Binary(Vec::new(), false);
    file.text("SOL 101\nCEND\nBEGIN BULK\n");
    for (v, [x, y]) in points.iter().enumerate() {
        let comments = if v % 10 == 0 { "$ 1.0\n\n$\n" } else { "" };
        file.text(&match v % 3 {
            0 => format!("GRID*   {v:<16}{:16}{x:<16.9}{y:<16.9}\n{comments}*       0.5\n", ""),
            1 => format!("GRID,{v},,{x:.10},{y}.,0.5\n{comments}"),
            _ => format!("grid*,{v},,{x:.10},{y}.,\n{comments}*,0.5\n"),
        });
    }
    for (t, corners) in triangles.iter().enumerate() {
        let ([a, b, c], region) = (corners, region(t));
        file.text(&match t % 3 {
            0 => format!("CTRIA3* {t:<16}{region:<16}{a:<16}{b:<16}\n$\n+       {c}\n"),
            1 => format!("CTRIA3  {t:<8}{region:<8}{a:<8}{b:<8}{c:<8}\n"),
            _ => format!("CTRIA3\t{t}\t{region}\t{a}\t{b}\t{c}\n"),
        });
    }
    files.push(("m.bdf", file.0));

    let mut file = Binary(Vec::new(), true);
    file.record(|out| out.text(&format!("{:<72}SERAFIND", "m")));
    file.record(|out| out.ints([0, 0]));
    file.record(|out| out.ints([1, 0, 0, 0, 0, 0, 0, 0, 0, 0]));
    file.record(|out| out.ints([m, n, 3, 1]));
    file.record(|out| out.ints(triangles.iter().flatten().map(|v| v + 1)));
    file.record(|out| out.ints((0..n).map(|_| 0)));
    for axis in [0, 1] {
        file.record(|out| out.reals(flat().skip(axis).step_by(2)));
    }
    files.push(("m.slf", file.0));

    let mut file = Binary(b"ply\nformat binary_little_endian 1.0\n".to_vec(), false);
    file.text(&format!("element vertex {n}\nproperty uchar color\nproperty double x\n"));
    file.text("property double y\nproperty double z\n");
    file.text(&format!("element face {m}\nproperty list uchar int vertex_indices\nend_header\n"));
    for &[x, y] in &points {
        file.0.push(9);
        file.reals([x, y, 0.5]);
    }
    for corners in &triangles {
        file.0.push(3);
        file.ints(*corners);
    }
    files.push(("m.ply", file.0));

    let mut file = Binary(Vec::new(), false);
    file.text("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" ");
    file.text("header_type=\"UInt64\">\n<UnstructuredGrid>\n");
    file.text(&format!("<Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{m}\">\n"));
    let sizes = [24 * n, 12 * m, 4 * m, m];
    let names = [("Float64", "Points"), ("Int32", "connectivity"), ("Int32", "offsets")];
    let mut offset = 0;
    for (index, (number, name)) in names.into_iter().chain([("UInt8", "types")]).enumerate() {
        let array = format!("<DataArray type=\"{number}\" Name=\"{name}\"");
        let array = format!("{array} NumberOfComponents=\"{}\"", if index == 0 { 3 } else { 1 });
        let array = format!("{array} format=\"appended\" offset=\"{offset}\"/>\n");
        file.text(&match index {
            0 => format!("<Points>{array}</Points><Cells>"),
            _ => array,
        });
        offset += 8 + sizes[index];
    }
    file.text("</Cells></Piece></UnstructuredGrid>\n<AppendedData encoding=\"raw\">_");
    file.sizes([sizes[0]]);
    file.reals(in_space());
    file.sizes([sizes[1]]);
    file.ints(triangles.iter().flatten().copied());
    file.sizes([sizes[2]]);
    file.ints((1..=m).map(|t| 3 * t));
    file.sizes([sizes[3]]);
    file.0.extend(std::iter::repeat_n(5, m));
    file.text("</AppendedData></VTKFile>\n");
    files.push(("m.vtu", file.0));
    files
}

/// Reads a file. Returns the mesh with the offsets of its coordinates, or the error.
fn read(name: &str, bytes: &[u8], ahead: bool) -> Result<impl PartialEq, String> {
    let next_file = memchr::memmem::find(bytes, NEXT_FILE);
    let (main, other) = bytes.split_at(next_file.unwrap_or(bytes.len()));
    let mut source = Source::new(name.as_ref(), main.to_vec()).map_err(|e| e.to_string())?;
    if !other.is_empty() {
        let other = Source::new("m.ele".as_ref(), other.to_vec()).map_err(|e| e.to_string())?;
        source.companions.push(Companion::by_convention(other));
    }
    let reader = detect::reader(&source).map_err(|e| e.to_string())?;
    let parsed = parse_by(reader, &source, ahead).map_err(|e| e.to_string())?;
    let ParsedMesh { points, triangles, constraints, x_offsets: x_at, regions, remarks, .. } =
        parsed;
    let places: Vec<usize> = (0..points.len()).map(|v| x_at.at(v)).collect();
    let is_regular = matches!(x_at, Offsets::Regular { .. });
    Ok(((points, triangles, constraints), places, regions, remarks, is_regular))
}

#[test]
fn lists_read_on_all_threads_equal_lists_read_row_by_row() {
    let mut state = 5_u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as usize % below
    };
    let (mut meshes, mut errors) = (0, 0);
    for (name, bytes) in files() {
        let (ahead, one_by_one) = (read(name, &bytes, true), read(name, &bytes, false));
        assert!(ahead.is_ok(), "{name}: {:?}", ahead.err());
        assert!(ahead == one_by_one, "{name}");
        for _ in 0..5 {
            let mut bytes = bytes.clone();
            for _ in 0..=random(2) {
                let at = 300 + random(bytes.len() - 300);
                match random(3) {
                    // The next number comes twice.
                    0 => bytes.copy_within(at - 4..at, at - 8),
                    1 => bytes[at] = 0xFF,
                    _ => bytes[at] ^= 1 << random(8),
                }
            }
            let (ahead, one_by_one) = (read(name, &bytes, true), read(name, &bytes, false));
            *if ahead.is_ok() { &mut meshes } else { &mut errors } += 1;
            assert_eq!(ahead.as_ref().err(), one_by_one.as_ref().err(), "{name}");
            assert!(ahead == one_by_one, "{name}");
        }
    }
    assert!(meshes > 5 && errors > 5, "{meshes} meshes, {errors} errors");
}
