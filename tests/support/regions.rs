//! Writers of a mesh with several regions in each format.

use super::Mesh;
use super::{Binary, write_msh22, write_msh41};
use std::fmt::Write;

/// Names and bytes of the files of a mesh. The main file comes first.
pub type Files = Vec<(&'static str, Vec<u8>)>;

/// Writes the mesh in each format, with triangle `t` in the region of the two numbers `regions[t]`. In gmsh 2.2, they
/// are a physical group and an entity, in an `.ele` two attributes. In gmsh 4.1, the entity is the number `10 a + b`.
pub fn write_regions(mesh: &Mesh, regions: &[[i32; 2]]) -> Vec<Files> {
    assert_eq!(regions.len(), mesh.triangles.len());
    let mut formats = vec![
        vec![("in.node", node(mesh).into_bytes()), ("in.ele", ele(mesh, regions).into_bytes())],
        vec![("in.msh", msh22(mesh, regions).into_bytes())],
        vec![("in.msh", msh41(mesh, regions).into_bytes())],
    ];
    for big in [false, true] {
        formats.push(vec![("in.msh", msh22_binary(mesh, regions, big))]);
        formats.push(vec![("in.msh", msh41_binary(mesh, regions, big))]);
    }
    formats
}

/// Returns each triangle's number, vertex numbers and region. Numbers count from 1.
fn rows<'a>(
    mesh: &'a Mesh,
    regions: &'a [[i32; 2]],
) -> impl Iterator<Item = (usize, [u32; 3], [i32; 2])> + 'a {
    let rows = (1..).zip(&mesh.triangles).zip(regions);
    rows.map(|((number, t), &region)| (number, t.map(|v| v + 1), region))
}

/// Returns the ranges of consecutive triangles with equal regions, each with its entity number `10 a + b`.
fn blocks(regions: &[[i32; 2]]) -> Vec<(std::ops::Range<usize>, i32)> {
    let mut start = 0;
    let of = |same: &[[i32; 2]]| {
        let range = start..start + same.len();
        start = range.end;
        (range, 10 * same[0][0] + same[0][1])
    };
    regions.chunk_by(|a, b| a == b).map(of).collect()
}

fn node(mesh: &Mesh) -> String {
    super::triangle_text(mesh, "of several regions")[0].clone()
}

fn ele(mesh: &Mesh, regions: &[[i32; 2]]) -> String {
    let mut text = format!("{} 3 2\n", mesh.triangles.len());
    for (number, [a, b, c], [p, q]) in rows(mesh, regions) {
        writeln!(text, "{number} {a} {b} {c} {p} {q}.5 # region").unwrap();
    }
    text
}

/// Returns the text before the section of elements.
fn before_elements(text: &str) -> &str {
    &text[..text.find("$Elements").unwrap()]
}

fn msh22(mesh: &Mesh, regions: &[[i32; 2]]) -> String {
    let all = write_msh22(mesh);
    let mut text = format!("{}$Elements\n{}\n", before_elements(&all), mesh.triangles.len());
    for (number, [a, b, c], [p, q]) in rows(mesh, regions) {
        writeln!(text, "{number} 2 4 {p} {q} 1 {} {a} {b} {c}", number % 7).unwrap();
    }
    text + "$EndElements\n"
}

fn msh41(mesh: &Mesh, regions: &[[i32; 2]]) -> String {
    let (all, blocks, n) = (write_msh41(mesh), blocks(regions), mesh.triangles.len());
    let mut text = format!("{}$Elements\n{} {n} 1 {n}\n", before_elements(&all), blocks.len());
    let mut rows = rows(mesh, regions);
    for (block, entity) in blocks {
        writeln!(text, "2 {entity} 2 {}", block.len()).unwrap();
        for (number, [a, b, c], _) in rows.by_ref().take(block.len()) {
            writeln!(text, "{number} {a} {b} {c}").unwrap();
        }
    }
    text + "$EndElements\n"
}

fn msh22_binary(mesh: &Mesh, regions: &[[i32; 2]], big: bool) -> Vec<u8> {
    let mut file = Binary::new("2.2", big);
    file.text(&format!("$Nodes\n{}\n", mesh.points.len()));
    for (tag, [x, y]) in (1..).zip(&mesh.points) {
        file.ints(&[tag]);
        file.doubles(&[*x, *y, 0.]);
    }
    file.text(&format!("\n$EndNodes\n$Elements\n{}\n", mesh.triangles.len()));
    for (number, [a, b, c], [p, q]) in rows(mesh, regions) {
        file.ints(&[2, 1, 3, number as i32, p, q, 9]);
        file.ints(&[a, b, c].map(|v| v as i32));
    }
    file.text("\n$EndElements\n");
    file.bytes
}

fn msh41_binary(mesh: &Mesh, regions: &[[i32; 2]], big: bool) -> Vec<u8> {
    let (blocks, n, m) = (blocks(regions), mesh.points.len() as u64, mesh.triangles.len() as u64);
    let mut file = Binary::new("4.1", big);
    file.text("$Nodes\n");
    file.sizes(&[1, n, 1, n]);
    file.ints(&[2, 1, 0]);
    file.sizes(&[n]);
    (1..=n).for_each(|tag| file.sizes(&[tag]));
    mesh.points.iter().for_each(|[x, y]| file.doubles(&[*x, *y, 0.]));
    file.text("\n$EndNodes\n$Elements\n");
    file.sizes(&[blocks.len() as u64, m, 1, m]);
    let mut rows = rows(mesh, regions);
    for (block, entity) in blocks {
        file.ints(&[2, entity, 2]);
        file.sizes(&[block.len() as u64]);
        for (number, t, _) in rows.by_ref().take(block.len()) {
            file.sizes(&[number as u64]);
            file.sizes(&t.map(u64::from));
        }
    }
    file.text("\n$EndElements\n");
    file.bytes
}
