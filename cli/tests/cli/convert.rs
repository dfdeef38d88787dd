//! The command `gpu-smooth convert`.

use super::{Folder, assert_holds};
use std::fs;

const SMS: &str = "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 1 1 0\nND 4 0 1 0\nND 5 .5 .5 0\nE3T 1 1 2 5 1\nE3T 2 2 3 5 1\n\
                   E3T 3 3 4 5 2\nE3T 4 4 1 5 2\nNS 1 2 -3 \"shore\"\nMAT 2 \"mud\"\n";

#[test]
fn content_that_a_conversion_would_lose_is_listed_before_writing() {
    let folder = Folder::new(&[("in.2dm", SMS)]);
    let refused = folder.line("convert in.2dm out.mesh").refused(&[
        "in.2dm: Medit ASCII does not hold all of this mesh; --lossy writes it without\n",
        "\n  names of groups of lines, which become numbers: shore\n",
        "\n  names of groups of surfaces, which become numbers: mud\n",
    ]);
    assert_eq!(refused.err.lines().count(), 3);
    assert!(!folder.path("out.mesh").exists());
    let run = folder.line("convert in.2dm out.mesh --lossy");
    assert_eq!((run.code, run.err.lines().count()), (Some(0), 2));
    assert_holds(&run.err, &["gpu-smooth: lost: names of groups of lines"]);
    assert_holds(&folder.text("out.mesh"), &["Edges\n2\n1 2 1\n2 3 1\n", "3 4 5 2\n"]);
    folder.line("convert in.2dm again.mesh --lossy --quiet").clean();
}

#[test]
fn a_mesh_is_converted_by_the_ending_or_by_name() {
    let folder = Folder::new(&[("in.2dm", SMS)]);
    let out = folder.line("convert in.2dm out.msh").clean().out;
    assert_eq!(
        out,
        "5 vertices and 4 triangles, with all else that gmsh 4.1 ASCII holds of SMS 2dm: out.msh\n"
    );
    assert_holds(&folder.text("out.msh"), &["4.1 0 8", "1 1 \"shore\"", "2 2 \"mud\""]);
    folder.line("convert in.2dm old.msh --to gmsh22").clean();
    assert_holds(&folder.text("old.msh"), &["2.2 0 8"]);
    let piped = folder.line("convert in.2dm - --to gmsh22").clean().out;
    assert_eq!(piped, folder.text("old.msh"));
    folder.line("convert in.2dm out.msh.gz").clean();
    let packed = folder.line("groups out.msh.gz").clean().out;
    assert_eq!(packed.replace("out.msh.gz", "out.msh"), folder.line("groups out.msh").clean().out);
    // Smooths the converted mesh, and converts it back to the first format.
    folder.line("out.msh better.msh --engine cpu --quiet --free-interfaces").clean();
    folder.line("convert better.msh better.2dm").clean();
    assert_holds(
        &folder.text("better.2dm"),
        &["NS 1 2 -3 \"shore\"", "MAT 2 \"mud\"", "E3T 4 4 1 5 2"],
    );
    folder.line("convert in.2dm out.node --lossy --quiet").clean();
    assert_holds(&folder.text("out.poly"), &["2 1\n1 1 2 1\n"]);
    folder.line("quality out.node").clean();
}

/// SU2 identifies markers by name only.
#[test]
fn names_that_change_are_told_once() {
    let two = SMS.replace("-3 \"shore\"", "-3 \"a b\"\nNS 3 -4 \"a_b\"");
    let folder = Folder::new(&[("in.2dm", &two)]);
    let run = folder.line("convert in.2dm out.su2 --lossy");
    let told = "gpu-smooth: renamed, as SU2 cannot hold it so: groups: `a b` (1) to `a_b_2`\n";
    assert_eq!((run.code, run.err.matches(told).count()), (Some(0), 1), "{}", run.err);
    assert_holds(
        &folder.text("out.su2"),
        &[
            "NMARK= 2\n",
            "MARKER_TAG= a_b_2\nMARKER_ELEMS= 2\n",
            "MARKER_TAG= a_b\nMARKER_ELEMS= 1\n",
        ],
    );
    let quiet = folder.line("convert in.2dm out.su2 --lossy --quiet");
    assert_eq!((quiet.code, quiet.err.as_str()), (Some(0), ""));
}

#[test]
fn conversions_that_cannot_work_are_refused() {
    let folder = Folder::new(&[("in.2dm", SMS), ("word", "1 2 x\n")]);
    folder.line("convert in.2dm in.2dm").misused(&["in.2dm is the mesh that is read"]);
    folder
        .line("convert in.2dm out.xyz")
        .misused(&["out.xyz: its ending names no format", "gmsh22"]);
    // SU2 content in a file with the extension of VTK could be read, but not smoothed under that
    // name.
    folder
        .line("convert in.2dm out.vtk --to su2 --lossy -q")
        .refused(&["out.vtk: the ending belongs to legacy VTK, not to SU2", ".su2"]);
    assert!(!folder.path("out.vtk").exists());
    folder.line("convert in.2dm out.txt --to su2 --lossy -q").clean();
    folder.line("convert in.2dm out.stl").misused(&["out.stl: STL is read, but not written"]);
    folder.line("convert in.2dm out.bdf").misused(&["out.bdf: Nastran is read, but not written"]);
    folder.line("convert none.2dm out.msh").refused(&["none.2dm"]);
    folder.line("convert word out.msh").refused(&["word"]);
    let run = folder.line("convert in.2dm - --to triangle --lossy --quiet");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["error: a Triangle mesh has several files", "name OUT"]);
    let run = folder.line("convert in.2dm out.msh --to word");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["possible values: gmsh41, gmsh22, vtu, xdmf, vtk"]);
    fs::write(folder.path("out.poly"), "0").unwrap();
    let no_lines = SMS.replace("NS 1 2 -3 \"shore\"\n", "").replace("MAT 2 \"mud\"\n", "");
    fs::write(folder.path("plain.2dm"), no_lines).unwrap();
    for force in ["", " --force"] {
        folder
            .line(&format!("convert plain.2dm out.node{force}"))
            .refused(&["out.poly exists, belongs to another mesh"]);
    }
    assert!(!folder.path("out.node").exists());
}

/// Names are escaped in XML and read back unchanged.
#[test]
fn names_of_data_come_through_xml_and_those_without_get_one() {
    let view = |name: &str, value: f64| {
        let rows: String = (1..=5).map(|node| format!("{node} {value}\n")).collect();
        format!("$NodeData\n1\n\"{name}\"\n1\n0\n3\n0\n1\n5\n{rows}$EndNodeData\n")
    };
    let nodes = "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 .4 .3 0\n$EndNodes\n";
    let triangles = "1 2 2 0 1 1 2 5\n2 2 2 0 1 2 3 5\n3 2 2 0 1 3 4 5\n4 2 2 0 1 4 1 5\n";
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{nodes}$Elements\n4\n{triangles}$EndElements\n{}{}",
        view("x<y & z", 1.5),
        view("", 2.5)
    );
    let folder = Folder::new(&[("in.msh", &text)]);
    for out in ["out.vtu", "out.xdmf", "out.vtk", "out.exo", "out.ply"] {
        folder.line(&format!("convert in.msh {out} --lossy -q")).clean();
        let told = folder.line(&format!("groups {out}")).clean().out;
        let name = if out == "out.ply" { "x<y_&_z" } else { "x<y & z" };
        assert_holds(&told, &[&format!("(--interpolate): {name}, unnamed")]);
    }
    folder.line("convert out.vtu back.msh --lossy -q").clean();
    assert_holds(&folder.text("back.msh"), &["\"x<y & z\"", "\"unnamed\""]);
    let args = ["out.vtu", "better.vtu", "--engine", "cpu", "-q", "--interpolate", "x<y & z"];
    folder.run(args).clean();
}

#[test]
fn a_mesh_is_written_in_binary_and_compressed() {
    let folder = Folder::new(&[("in.2dm", SMS)]);
    for (name, encoding, start) in [
        ("out.msh", "binary", &b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n"[..]),
        ("out.vtk", "binary", b"# vtk DataFile Version 4.2\nwritten by gpu-smooth\nBINARY\n"),
        ("out.ply", "binary", b"ply\nformat binary_little_endian 1.0\n"),
        ("out.vtu", "compressed", b"<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\""),
    ] {
        folder
            .line(&format!("convert in.2dm {name} --lossy --quiet --encoding {encoding}"))
            .clean();
        assert!(fs::read(folder.path(name)).unwrap().starts_with(start), "{name}");
        folder.line(&format!("{name} again-{name} --engine cpu --quiet --free-interfaces")).clean();
    }
    let run = folder.line("convert in.2dm out.off --lossy --encoding binary");
    assert_eq!(run.code, Some(2));
    let remedy = "VTK XML takes text, binary and compressed";
    assert_holds(&run.err, &["out.off: OFF is not written in this --encoding", remedy]);
}

/// Third coordinates that lie in no plane are refused without the option that the note names.
#[test]
fn heights_that_become_third_coordinates_have_a_note_with_the_option_that_reads_them() {
    let bed = SMS.replace("ND 5 .5 .5 0", "ND 5 .5 .5 -2");
    let folder = Folder::new(&[("in.2dm", &bed)]);
    let note = "gpu-smooth: heights of the SMS 2dm become third coordinates of the VTK XML: add --z data to commands \
                that read OUT\n";
    for line in
        ["convert in.2dm out.vtu --lossy", "in.2dm run.vtu --lossy --engine cpu --free-interfaces"]
    {
        let run = folder.line(line);
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.err, &[note]);
    }
    folder.line("quality out.vtu").refused(&["not planar", "--z data"]);
    folder.line("quality out.vtu --z data").clean();
    // Grids have heights, and Triangle loses them.
    folder.line("convert in.2dm out.gr3 --lossy --quiet").clean();
    let run = folder.line("convert in.2dm out.node --lossy");
    assert!(!run.err.contains("--z data"), "{}", run.err);
}
