//! Writers of meshes as text. Numbers have the fewest digits that preserve their bits.

use super::Mesh;
use super::check::boundary;
use std::fmt::Write;
use std::path::Path;
use std::{fs, io};

/// Returns the texts of a `.node` and an `.ele`, numbered from 1, with a comment on the first line. Vertex markers are
/// 1 on the boundary, 2 for other fixed vertices, and 0 for free vertices.
pub fn triangle_text(mesh: &Mesh, comment: &str) -> [String; 2] {
    let mut marker: Vec<_> = boundary(mesh).into_iter().map(u8::from).collect();
    for &v in &mesh.fixed {
        let marker = &mut marker[v as usize];
        *marker = if *marker == 0 { 2 } else { *marker };
    }
    let mut node = format!("# {comment}\n{} 2 0 1\n", mesh.points.len());
    for (i, ([x, y], marker)) in mesh.points.iter().zip(marker).enumerate() {
        line(&mut node, format_args!("{} {x} {y} {marker}", i + 1));
    }
    let mut ele = format!("# {comment}\n{} 3 0\n", mesh.triangles.len());
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        line(&mut ele, format_args!("{} {} {} {}", i + 1, a + 1, b + 1, c + 1));
    }
    [node, ele]
}

/// Writes `stem.node` and `stem.ele`.
pub fn write_triangle(mesh: &Mesh, stem: &Path, comment: &str) -> io::Result<()> {
    let [node, ele] = triangle_text(mesh, comment);
    // `with_extension` would truncate stems such as `mesh.1`.
    let named = |suffix| {
        let mut path = stem.as_os_str().to_owned();
        path.push(suffix);
        path
    };
    fs::write(named(".node"), node)?;
    fs::write(named(".ele"), ele)
}

/// Returns the mesh in gmsh 2.2 text. The format cannot mark fixed vertices.
pub fn write_msh22(mesh: &Mesh) -> String {
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.points.len());
    for (i, [x, y]) in mesh.points.iter().enumerate() {
        line(&mut text, format_args!("{} {x} {y} 0", i + 1));
    }
    line(&mut text, format_args!("$EndNodes\n$Elements\n{}", mesh.triangles.len()));
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        line(&mut text, format_args!("{} 2 2 1 1 {} {} {}", i + 1, a + 1, b + 1, c + 1));
    }
    text + "$EndElements\n"
}

/// Returns the mesh in gmsh 4.1 text, with one block of nodes and one of elements. Fixed vertices are not marked.
pub fn write_msh41(mesh: &Mesh) -> String {
    let (nodes, elements) = (mesh.points.len(), mesh.triangles.len());
    let mut text = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 {nodes} 1 {nodes}\n2 1 0 {nodes}\n"
    );
    for i in 1..=nodes {
        line(&mut text, format_args!("{i}"));
    }
    for [x, y] in &mesh.points {
        line(&mut text, format_args!("{x} {y} 0"));
    }
    line(
        &mut text,
        format_args!("$EndNodes\n$Elements\n1 {elements} 1 {elements}\n2 1 2 {elements}"),
    );
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        line(&mut text, format_args!("{} {} {} {}", i + 1, a + 1, b + 1, c + 1));
    }
    text + "$EndElements\n"
}

fn line(text: &mut String, content: std::fmt::Arguments) {
    writeln!(text, "{content}").expect("writing to a string never fails");
}
