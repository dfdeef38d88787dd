//! Makes files of version 1 of gmsh's format, and of version 4.0 as text and in binary.

use super::{LINE, Made, POINT, PROBED, QUADRILATERAL, Text, fixing, number, region, regions, z};
use mesh_io::Format;
use mesh_io::Precision;
use support::Binary;
use support::Mesh;

const VERTEX: usize = PROBED.0 as usize;
const TRIANGLE: usize = PROBED.1;

/// Returns the tag of a vertex.
fn tag(vertex: u32) -> u32 {
    2 * vertex + 7
}

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    vec![version_1(mesh), as_text(mesh), in_binary(mesh, false), in_binary(mesh, true)]
}

/// Makes a file of version 1, without a section for the version.
fn version_1(mesh: &Mesh) -> Made {
    let mut text = Text::new("$NOD\n");
    text.count(mesh.points.len());
    text.put("\n");
    let vertices = text.rows(mesh.points.iter().enumerate().map(|(i, &[x, y])| {
        format!("{} {} {}  {}", tag(i as u32), number(i, x), number(i + 1, y), z(i))
    }));
    text.put("$ENDNOD\n$ELM\n");
    text.count(mesh.triangles.len() + 3);
    text.put("\n");
    let of = |vertices: &[u32]| {
        let tags: Vec<_> = vertices.iter().map(|&v| tag(v).to_string()).collect();
        format!("{} {}", tags.len(), tags.join(" "))
    };
    let others = [
        format!("900 15 0 3 {}", of(&[POINT])),
        format!("901 1 8 4 {}", of(&LINE)),
        format!("902 3 5 1 {}", of(&QUADRILATERAL)),
    ];
    let rows = mesh.triangles.iter().enumerate();
    let rows = rows.map(|(t, c)| format!("{} 2 {} 1 {}", t + 1, region(t), of(c)));
    let listed = text.rows(others.into_iter().chain(rows));
    text.put("$ENDELM\n");
    let regions = regions(mesh);
    let mesh = fixing(mesh, [POINT].into_iter().chain(LINE).chain(QUADRILATERAL));
    let probes = [(u64::from(tag(PROBED.0)), vertices[VERTEX]), (18, listed[3 + TRIANGLE])];
    Made { regions, ..text.made("version 1", "in.msh", Format::Gmsh1, mesh, probes) }
}

/// Returns the mesh with its vertices in another order.
fn ordered(mesh: &Mesh, order: &[usize]) -> Mesh {
    // A vertex outside of `order` keeps its number.
    let position = |v: u32| order.iter().position(|&i| i == v as usize).map_or(v, |at| at as u32);
    let points = order.iter().map(|&i| mesh.points[i]).collect();
    let triangles = mesh.triangles.iter().map(|t| t.map(position)).collect();
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    fixing(&mesh, [POINT].into_iter().chain(LINE).map(position))
}

/// Makes the mesh in binary. One inner vertex is on a point of the model, and nodes of a surface have parameters.
fn in_binary(mesh: &Mesh, big: bool) -> Made {
    let mut file = Binary::new("4", big);
    let (mut counts, mut coordinates) = (Vec::new(), Vec::new());
    file.text("$Entities\n");
    file.sizes(&[1, 0, 0, 0]);
    file.ints(&[-3]);
    file.doubles(&[0.0; 6]);
    file.sizes(&[0]);
    file.text("\n$EndEntities\n$Nodes\n");
    file.sizes(&[2]);
    counts.push(file.bytes.len()..file.bytes.len() + 8);
    file.sizes(&[mesh.points.len() as u64]);
    let alone = POINT as usize;
    let others = (0..mesh.points.len()).filter(|&i| i != alone);
    let order: Vec<usize> = [alone].into_iter().chain(others).collect();
    let start = file.bytes.len();
    for (block, header) in [(&order[..1], [-3, 0, 0]), (&order[1..], [1, 2, 1])] {
        file.ints(&header);
        file.sizes(&[block.len() as u64]);
        for &i in block {
            file.ints(&[tag(i as u32) as i32]);
            let x_at = file.bytes.len();
            coordinates.push([x_at, x_at + 8]);
            let [x, y] = mesh.points[i];
            file.doubles(&[x, y, z(i)]);
            file.doubles(if header[1] == 2 { &[0.5, 0.25] } else { &[] });
        }
    }
    let nodes = start..file.bytes.len();
    file.text("\n$EndNodes\n$Elements\n");
    file.sizes(&[3]);
    counts.push(file.bytes.len()..file.bytes.len() + 8);
    file.sizes(&[mesh.triangles.len() as u64 + 1]);
    let start = file.bytes.len();
    file.ints(&[4, 1, 1]);
    file.sizes(&[1]);
    file.ints(&[500, tag(LINE[0]) as i32, tag(LINE[1]) as i32]);
    let halves = (0..mesh.triangles.len()).position(|t| region(t) != region(0)).unwrap();
    for triangles in [0..halves, halves..mesh.triangles.len()] {
        file.ints(&[region(triangles.start), 2, 2]);
        file.sizes(&[triangles.len() as u64]);
        for t in triangles {
            file.ints(&[t as i32 + 1]);
            file.ints(&mesh.triangles[t].map(|v| tag(v) as i32));
        }
    }
    let elements = start..file.bytes.len();
    file.text("\n$EndElements\n");
    let mesh = ordered(mesh, &order);
    Made {
        what: format!("version 4.0 in binary, big-endian: {big}"),
        name: "in.msh",
        format: Format::Gmsh40Binary,
        precision: Precision::Double,
        bytes: file.bytes,
        regions: regions(&mesh),
        mesh,
        vertex: (u64::from(tag(order[VERTEX] as u32)), nodes.clone()),
        triangle: (TRIANGLE as u64 + 1, elements.clone()),
        lists: vec![nodes, elements],
        counts,
        coordinates,
        big,
    }
}

fn as_text(mesh: &Mesh) -> Made {
    let mut text = Text::new("$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n2 ");
    text.count(mesh.points.len());
    // One inner vertex is on a point of the model, and nodes of a surface have parameters.
    text.put("\n-3 0 0 1\n");
    let row = |i: usize, end: &str| {
        let [x, y] = mesh.points[i];
        format!("{} {} {} {}{end}", tag(i as u32), number(i, x), number(i + 1, y), z(i))
    };
    let alone = POINT as usize;
    let mut order = vec![alone];
    let first = text.rows([row(alone, "")].into_iter().chain([String::from("1 2 1 29")]));
    assert_eq!(first.len(), 2);
    text.lists.clear();
    let others: Vec<_> = (0..mesh.points.len()).filter(|&i| i != alone).collect();
    let rows = text.rows(others.iter().map(|&i| row(i, " 0.5 0.25")));
    order.extend(&others);
    text.put("$EndNodes\n$Elements\n3 ");
    text.count(mesh.triangles.len() + 1);
    text.put(&format!("\n4 1 1 1\n500 {} {}\n", tag(LINE[0]), tag(LINE[1])));
    let halves = (0..mesh.triangles.len()).position(|t| region(t) != region(0)).unwrap();
    let triangle = |t: usize| {
        let [a, b, c] = mesh.triangles[t].map(tag);
        format!("{} {a} {b} {c} ", t + 1)
    };
    text.put(&format!("{} 2 2 {halves}\n", region(0)));
    let listed = text.rows((0..halves).map(triangle));
    text.put(&format!("{} 2 2 {}\n", region(halves), mesh.triangles.len() - halves));
    text.rows((halves..mesh.triangles.len()).map(triangle));
    text.put("$EndElements\n");

    // The file lists vertices in another order than the mesh.
    let probed = order[VERTEX];
    let row_of = others.iter().position(|&i| i == probed).unwrap();
    let probes =
        [(u64::from(tag(probed as u32)), rows[row_of]), (TRIANGLE as u64 + 1, listed[TRIANGLE])];
    let mesh = ordered(mesh, &order);
    let made = text.made("version 4.0", "in.msh", Format::Gmsh40, mesh.clone(), probes);
    Made { regions: regions(&mesh), ..made }
}
