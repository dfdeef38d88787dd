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
    assert!(run.err.contains("count elements, and are no regions"), "{}", run.err);
    assert!(folder.text("in.msh") != folder.text("out.msh"));
}

/// A square of four triangles, whose edges are two inlets and two outlets. The last name has no elements.
const TWO_OF_A_NAME: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n1 1 \"out\"\n1 2 \"in\"\n1 3 \"in\"\n\
    1 4 \"out\"\n2 9 \"void\"\n$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 .3 .4 0\n$EndNodes\n\
    $Elements\n8\n1 1 2 1 1 1 2\n2 1 2 2 2 2 3\n3 1 2 3 3 3 4\n4 1 2 4 4 4 1\n5 2 2 0 5 1 2 5\n6 2 2 0 5 2 3 5\n\
    7 2 2 0 5 3 4 5\n8 2 2 0 5 4 1 5\n$EndElements\n";

#[test]
fn names_that_groups_share_are_listed_and_name_all_of_them() {
    let folder = Folder::new(&[("in.msh", TWO_OF_A_NAME)]);
    let told = folder.line("groups in.msh").clean().out;
    let rows: Vec<Vec<&str>> = told.lines().map(|row| row.split_whitespace().collect()).collect();
    assert_eq!(rows[1][..4], ["group", "name", "what", "tag"], "{told}");
    assert_eq!(rows[3][..5], ["physical:2", "in", "physical", "line", "2"], "{told}");
    assert_eq!(rows[4][..5], ["physical:3", "in", "physical", "line", "3"], "{told}");
    let run = folder.line("in.msh out.msh --slide --fix in --dry-run");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_eq!(
        run.err.matches("--fix in (physical line in): 2 vertices").count(),
        2,
        "{}",
        run.err
    );
    folder
        .line("in.msh out.msh --fix inn")
        .refused(&["no group is called 'inn'", "Did you mean in?"]);
}

#[test]
fn names_with_blanks_at_their_ends_are_found_as_they_are_listed() {
    let mesh = TWO_OF_A_NAME
        .replace("1 1 \"out\"", "1 1 \" lead\"")
        .replace("1 4 \"out\"", "1 4 \"trail \"");
    let folder = Folder::new(&[("in.msh", &mesh)]);
    for name in [" lead", "trail ", " lead,trail ", "in, lead", " in,trail ", "trail , in "] {
        let run = folder.run(["in.msh", "out.msh", "--force", "--engine", "cpu", "--fix", name]);
        assert_eq!(run.code, Some(0), "{name}: {}", run.err);
    }
    let sides = ["--slide", "--periodic", " lead,trail "];
    let run = folder.run(["in.msh", "out.msh", "--force", "--engine", "cpu"].iter().chain(&sides));
    assert!(!run.err.contains("no group is called"), "{}", run.err);
    let run = folder.run(["in.msh", "out.msh", "--fix", "lead"]);
    run.refused(&["no group is called 'lead'", "Did you mean  lead?"]);
}

/// The cell data under a usual name and under a name that the command line gives are groups alike.
#[test]
fn regions_that_an_option_names_are_groups() {
    let grid = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 double\n\
        0 0 0 1 0 0 2 0 0 0 1 0 1.3 .8 0 2 1 0 0 2 0 1 2 0 2 2 0\nCELLS 8 32\n3 0 1 4 3 0 4 3 3 1 2 5 3 1 5 4 3 3 4 7 3 3 7 6\n\
        3 4 5 8 3 4 8 7\nCELL_TYPES 8\n5 5 5 5 5 5 5 5\nCELL_DATA 8\nSCALARS zones int 1\nLOOKUP_TABLE default\n0 0 0 0 2 2 2 2\n";
    let folder = Folder::new(&[("in.vtk", grid)]);
    let table = "in.vtk: legacy VTK ASCII\n\
                 group  what           tag  triangles  vertices\n\
                 0      zones surface    0          4         6\n\
                 2      zones surface    2          4         6\n";
    for options in ["", " --regions zones"] {
        assert_eq!(folder.line(&format!("groups in.vtk{options}")).clean().out, table);
        let line = format!("in.vtk out.vtk --free-interfaces --only 2{options}");
        let run = folder.line(&line);
        assert_eq!(run.code, Some(3));
        assert!(
            run.err.contains("--only 2 (zones surface 2): 0 of 1 free vertices"),
            "{}",
            run.err
        );
        // gmsh has no physical group 0.
        let run = folder.line(&format!("convert in.vtk out.msh --force{options}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert!(run.err.contains("groups: the tag 0 of a region to an unused tag"), "{}", run.err);
        let groups = folder.line("groups out.msh").clean().out;
        for row in ["physical surface    1          4", "physical surface    2          4"] {
            assert!(groups.contains(row), "{groups}");
        }
    }
    folder.line("groups in.vtk --regions zone").refused(&["it has no cell data `zone`", "`zones`"]);
}

#[test]
fn numbers_of_entities_and_corners_of_a_model_are_no_losses() {
    // gmsh writes the corners of the model as points, and numbers its curves and surfaces.
    let model = TWO_OF_A_NAME
        .replace("$Elements\n8", "$Elements\n9\n9 15 2 0 1 1")
        .replace("5\n1 1 \"out\"\n1 2 \"in\"\n1 3 \"in\"\n1 4 \"out\"\n", "1\n")
        .replace(" 1 2 1 1 ", " 1 2 0 1 ")
        .replace(" 1 2 2 2 ", " 1 2 0 2 ")
        .replace(" 1 2 3 3 ", " 1 2 0 3 ")
        .replace(" 1 2 4 4 ", " 1 2 0 4 ");
    let folder = Folder::new(&[("in.msh", &model)]);
    for ending in ["su2", "nc", "14"] {
        let run = folder.line(&format!("convert in.msh out.{ending}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_eq!(run.err, "gpu-smooth: lost: names of groups without elements: void\n");
    }
    // A group of the user is a loss, and so is a point inside the mesh.
    let folder = Folder::new(&[("in.msh", &model.replace("9 15 2 0 1 1", "9 15 2 7 1 5"))]);
    let run = folder.line("convert in.msh out.nc");
    assert_eq!(run.code, Some(3));
    assert!(run.err.contains("\n  1 point\n"), "{}", run.err);
    // gmsh's own formats keep a name without elements.
    folder.line("convert in.msh out.msh").clean();
    assert!(folder.text("out.msh").contains("2 9 \"void\""));
}
