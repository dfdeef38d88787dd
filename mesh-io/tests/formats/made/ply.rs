//! Makes PLY files, in text and in binary.

use super::binary::size_of;
use super::{LINE, Made, PROBED, QUADRILATERAL, Text, cells, fixing, number, z};
use mesh_io::Format;
use mesh_io::Precision;
use support::Binary;
use support::Mesh;

const VERTEX: usize = PROBED.0 as usize;
/// Row of the probed triangle in the list of [`cells`].
const CELL: usize = PROBED.1 + 1;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    let mut all = Vec::new();
    for precision in [Precision::Single, Precision::Double] {
        all.push(text(mesh, precision));
        all.extend([false, true].map(|big| binary(mesh, precision, big)));
    }
    all
}

/// Adds the header except its first two lines.
fn header(text: &mut Text, mesh: &Mesh, precision: Precision) {
    let real = if precision == Precision::Single { "float" } else { "double" };
    text.put("comment element vertex 9\nobj_info by hand\nelement vertex ");
    text.count(mesh.points.len());
    text.put(&format!("\nproperty uchar red\nproperty {real} x\nproperty {real} y\n"));
    text.put("property float z\nelement face ");
    text.count(mesh.triangles.len() + 1);
    text.put("\nproperty short quality\nproperty list uchar uint vertex_indices\n");
    text.put("element edge 1\nproperty int vertex1\nproperty int32 vertex2\n");
    text.put("element other 2\nproperty list int8 double of_any_length\nend_header\n");
}

fn held(mesh: &Mesh) -> Mesh {
    fixing(mesh, LINE.into_iter().chain(QUADRILATERAL))
}

fn text(mesh: &Mesh, precision: Precision) -> Made {
    let mut text = Text::new("ply\nformat ascii 1.0\n");
    header(&mut text, mesh, precision);
    let vertices = text.rows(mesh.points.iter().enumerate().map(|(i, &[x, y])| {
        format!("{} {}  {}\t{}", i % 256, number(i, x), number(i + 1, y), z(i))
    }));
    let faces = text.rows(cells(mesh).iter().enumerate().map(|(i, cell)| {
        let corners: Vec<_> = cell.iter().map(u32::to_string).collect();
        format!("{} {} {}", -(i as i64), cell.len(), corners.join(" "))
    }));
    text.put(&format!("{} {}\n0\n2 1e0 0.5\n", LINE[0], LINE[1]));
    let probes = [(VERTEX as u64, vertices[VERTEX]), (CELL as u64, faces[CELL])];
    let made = text.made(&format!("{precision:?}"), "in.ply", Format::Ply, held(mesh), probes);
    Made { precision, ..made }
}

fn binary(mesh: &Mesh, precision: Precision, big: bool) -> Made {
    let order = if big { "big" } else { "little" };
    let mut text = Text::new(&format!("ply\nformat binary_{order}_endian 1.0\n"));
    header(&mut text, mesh, precision);
    let mut file = Binary::empty(big);
    file.text(&text.text);
    let first = file.bytes.len();
    let mut coordinates = Vec::new();
    for (i, &[x, y]) in mesh.points.iter().enumerate() {
        file.bytes.push(i as u8);
        let at = file.bytes.len();
        coordinates.push([at, at + size_of(precision)]);
        file.reals(precision, &[x, y]);
        file.reals(Precision::Single, &[z(i)]);
    }
    let points = first..file.bytes.len();
    for (i, cell) in cells(mesh).iter().enumerate() {
        file.bytes.extend([i as u8, 0xFF, cell.len() as u8]);
        file.ints(&cell.iter().map(|&v| v as i32).collect::<Vec<_>>());
    }
    let faces = points.end..file.bytes.len();
    file.ints(&LINE.map(|v| v as i32));
    file.bytes.extend([0, 1]);
    file.doubles(&[0.5]);
    Made {
        what: format!("binary PLY, {precision:?}, big-endian: {big}"),
        name: "in.ply",
        format: Format::PlyBinary,
        precision,
        bytes: file.bytes,
        mesh: held(mesh),
        regions: None,
        vertex: (VERTEX as u64, points.clone()),
        triangle: (CELL as u64, faces.clone()),
        lists: vec![points, faces],
        counts: text.counts,
        coordinates,
        big,
    }
}
