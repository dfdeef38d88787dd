//! Parameters of nodes on plane surfaces of a gmsh model, which change with moved nodes.

use super::Folder;
use super::facts::remarks;
use mesh_io::FieldError;
use mesh_io::MeshFile;
use std::fmt::Write;
use std::fs;
use support::Binary;

/// Three nodes on the boundary and two inside, all on one surface of the model.
const NODES: [[f64; 2]; 5] = [[0.0, 0.0], [8.0, 0.0], [0.0, 8.0], [1.0, 2.0], [3.0, 1.5]];
const TRIANGLES: [[usize; 3]; 5] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [0, 4, 3], [0, 3, 2]];

/// Returns the parameters of a point on the surface, which are linear in its coordinates unless the surface is curved.
fn parameters([x, y]: [f64; 2], curved: bool) -> [f64; 2] {
    [2.0 * x + y + 1.0, x - 3.0 * y + if curved { x * y } else { 0.0 }]
}

/// Returns a mesh with all nodes on one surface, enough nodes to show that the parameters are linear.
fn text(curved: bool) -> String {
    let mut text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 5 1 5\n2 6 1 5\n".to_owned();
    (1..=5).for_each(|tag| writeln!(text, "{tag}").unwrap());
    for point @ [x, y] in NODES {
        let [u, v] = parameters(point, curved);
        writeln!(text, "{x} {y} 0 {u:e} {v}").unwrap();
    }
    text.push_str("$EndNodes\n$Elements\n1 5 1 5\n2 6 2 5\n");
    for (i, [a, b, c]) in TRIANGLES.iter().enumerate() {
        writeln!(text, "{} {} {} {}", i + 1, a + 1, b + 1, c + 1).unwrap();
    }
    text + "$EndElements\n"
}

fn binary(big: bool, nodes: &[[f64; 2]]) -> Vec<u8> {
    let mut file = Binary::new("4.1", big);
    file.text("$Nodes\n");
    file.sizes(&[1, 5, 1, 5]);
    file.ints(&[2, 6, 1]);
    file.sizes(&[5, 1, 2, 3, 4, 5]);
    for &point @ [x, y] in nodes {
        file.doubles(&[x, y, 0.0]);
        file.doubles(&parameters(point, false));
    }
    file.text("\n$EndNodes\n$Elements\n");
    file.sizes(&[1, 5, 1, 5]);
    file.ints(&[2, 6, 2]);
    file.sizes(&[5]);
    for (i, triangle) in TRIANGLES.iter().enumerate() {
        file.sizes(&[i as u64 + 1]);
        file.sizes(&triangle.map(|v| v as u64 + 1));
    }
    file.text("\n$EndElements\n");
    file.bytes
}

fn is_near(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
}

/// Returns the nodes with the last node moved.
fn moved() -> Vec<[f64; 2]> {
    let mut moved = NODES.to_vec();
    moved[4] = [2.5, 2.25];
    moved
}

#[test]
fn parameters_on_a_plane_move_with_the_nodes() {
    let before = text(false);
    let folder = Folder::new(&[("in.msh", &before)]);
    let file = folder.read("in.msh");
    assert!(file.has_parameters() && remarks(&file).is_empty());
    let (fields, others) = file.plane_parameters(file.points(), &moved()).unwrap();
    assert_eq!((fields.len(), others), (1, 0));
    file.write_with_fields(&folder.path("out.msh"), &moved(), &fields).unwrap();
    let out = folder.text("out.msh");
    for (old, new) in before.lines().zip(out.lines()) {
        if old != "3 1.5 0 8.5e0 -1.5" {
            assert_eq!(old, new);
            continue;
        }
        let numbers: Vec<f64> = new.split(' ').map(|word| word.parse().unwrap()).collect();
        assert_eq!(numbers[..3], [2.5, 2.25, 0.0]);
        assert!(is_near(&numbers[3..], &parameters([2.5, 2.25], false)), "{new}");
    }
    assert_eq!(before.lines().count(), out.lines().count());
    // If no node moves, the parameters keep their text.
    let (fields, _) = file.plane_parameters(file.points(), &NODES).unwrap();
    file.write_with_fields(&folder.path("same.msh"), &NODES, &fields).unwrap();
    assert_eq!(folder.text("same.msh"), before);
    let count = FieldError::PointCount { expected: 5, given: 4 };
    assert_eq!(file.plane_parameters(file.points(), &NODES[1..]).unwrap_err(), count);

    for big in [false, true] {
        fs::write(folder.path("in.msh"), binary(big, &NODES)).unwrap();
        let file = folder.read("in.msh");
        let (fields, _) = file.plane_parameters(file.points(), &moved()).unwrap();
        file.write_with_fields(&folder.path("out.msh"), &moved(), &fields).unwrap();
        let (out, expected) = (fs::read(folder.path("out.msh")).unwrap(), binary(big, &moved()));
        let differ = out.iter().zip(&expected).filter(|(a, b)| a != b).count();
        assert!(out.len() == expected.len() && differ < 16, "{differ} bytes differ");
        let after = folder.read("out.msh");
        let (own, _) = after.plane_parameters(after.points(), &moved()).unwrap();
        assert_eq!(own[0].values()[..8], fields[0].values()[..8]);
        assert!(is_near(&own[0].values()[8..], &parameters([2.5, 2.25], false)));
        assert_eq!(file.difference_ignoring(&after, [&fields, &own]), None);
    }
}

#[test]
fn parameters_on_other_surfaces_stay() {
    let folder = Folder::new(&[("in.msh", &text(true)), ("flat.msh", super::GMSH41)]);
    let file = folder.read("in.msh");
    let (fields, others) = file.plane_parameters(file.points(), &moved()).unwrap();
    assert_eq!((fields.len(), others), (0, 1));
    // Constant parameters are linear too.
    let flat = folder.read("flat.msh");
    let (fields, others) = flat.plane_parameters(flat.points(), flat.points()).unwrap();
    assert_eq!((fields.len(), others), (1, 0));
    let cut = text(false).replace(" 8.5e0 -1.5", " 8.5e0");
    let file = MeshFile::from_bytes("cut.msh".as_ref(), cut.into_bytes()).unwrap();
    assert!(file.plane_parameters(file.points(), &NODES).unwrap().0.is_empty());
}
