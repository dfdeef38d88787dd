//! The command `gpu-smooth groups` lists the groups of a file as a table and as JSON.

use super::Folder;

/// A square of four triangles in two named materials.
const SMS: &str = "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 1 1 0\nND 4 0 1 0\nND 5 .5 .5 0\nE3T 1 1 2 5 1\nE3T 2 2 3 5 1\n\
                   E3T 3 3 4 5 2\nE3T 4 4 1 5 2\nNS 1 2 -3\nMAT 2 \"mud\"\n";

#[test]
fn groups_are_a_table() {
    let folder = Folder::new(&[("in.2dm", SMS)]);
    let expected = "in.2dm: SMS 2dm\n\
                    group         what              tag  points  triangles  vertices\n\
                    material:1    material surface    1       0          2         4\n\
                    mud           material surface    2       0          2         4\n\
                    nodestring:1  nodestring line     1       3          0         3\n";
    assert_eq!(folder.line("groups in.2dm").clean().out, expected);
    assert_eq!(folder.line("groups in.2dm --quiet").clean().out, expected);
}

#[test]
fn data_of_vertices_are_listed_beside_groups() {
    let deep = SMS.replace("ND 5 .5 .5 0", "ND 5 .5 .5 -2.5");
    let folder = Folder::new(&[("in.2dm", &deep)]);
    let out = folder.line("groups in.2dm").clean().out;
    assert!(out.ends_with("\ndata of vertices (--interpolate): z\n"), "{out}");
    let told: serde_json::Value =
        serde_json::from_str(&folder.line("groups in.2dm --json").clean().out).unwrap();
    assert_eq!(told["data"], serde_json::json!(["z"]));
}

#[test]
fn groups_are_json_where_asked_for() {
    let folder = Folder::new(&[("in.2dm", SMS)]);
    let told: serde_json::Value =
        serde_json::from_str(&folder.line("groups in.2dm --json").clean().out).unwrap();
    assert_eq!((&told["file"], &told["format"]), (&"in.2dm".into(), &"SMS 2dm".into()));
    let mud = serde_json::json!({
        "group": "mud", "what": "material", "kind": "surface", "dimension": 2, "name": "mud", "tag": 2,
        "points": 0, "lines": 0, "triangles": 2, "quadrilaterals": 0, "vertices": 4
    });
    assert_eq!(told["groups"][1], mud);
    assert_eq!(told["groups"].as_array().unwrap().len(), 3);
}

#[test]
fn a_file_without_groups_says_so() {
    let folder = Folder::new(&[("in.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")]);
    let told = folder.line("groups in.off").clean().out;
    assert_eq!(told, "in.off: OFF\nthe file names no groups\n");
    folder.line("groups none.node").refused(&["none.node", "Check the name"]);
}

/// The dialect of WAVEWATCH III has the number of the triangle in the place of gmsh's entity.
#[test]
fn numbers_of_triangles_are_no_groups_and_fix_no_vertex() {
    let mesh = super::disturbed();
    let mut text = format!("$MeshFormat\n2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.points.len());
    for (node, [x, y]) in (1..).zip(&mesh.points) {
        text += &format!("{node} {x} {y} 0\n");
    }
    text += &format!("$EndNodes\n$Elements\n{}\n", mesh.triangles.len());
    for (t, triangle) in (1..).zip(&mesh.triangles) {
        let [a, b, c] = triangle.map(|v| v + 1);
        text += &format!("{t} 2 3 0 {t} 0 {a} {b} {c}\n");
    }
    let folder = Folder::new(&[("in.msh", &(text + "$EndElements\n"))]);
    let told = folder.line("groups in.msh").out;
    assert!(told.ends_with("the file names no groups\n"), "{told}");
    let run = folder.line("in.msh out.msh --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.err.contains("count triangles, and are no regions"), "{}", run.err);
    assert!(folder.text("in.msh") != folder.text("out.msh"));
}
