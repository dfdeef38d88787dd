//! Runs that write another format than that of IN.

use super::{Folder, assert_holds, assert_smoothed, disturbed};
use std::fs;
use std::process::{Command, Stdio};

/// A square with disturbed vertices, in one physical group, which has a name in one of the two files.
fn folder() -> Folder {
    let folder = Folder::new(&[]);
    fs::write(folder.path("in.msh"), support::write_msh22(&disturbed())).unwrap();
    let named = "$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"steel\"\n$EndPhysicalNames";
    let text = folder.text("in.msh").replace("$EndMeshFormat", named);
    fs::write(folder.path("named.msh"), text).unwrap();
    folder
}

#[test]
fn a_run_writes_the_format_of_the_ending_of_out() {
    let folder = folder();
    let run = folder.line("in.msh out.vtu --engine cpu --report r.json").clean();
    assert_eq!(run.out.lines().next(), Some("gmsh 2.2 ASCII to VTK XML"));
    assert_smoothed(&folder.mesh("in.msh"), &folder.mesh("out.vtu"));
    let report = folder.json("r.json");
    let mesh = &report["mesh"];
    assert_eq!([&mesh["format"], &mesh["output_format"]], ["gmsh 2.2 ASCII", "VTK XML"]);
    let certificate = &report["certificate"];
    assert_eq!(certificate["connectivity_identical"], true);
    assert_eq!([&certificate["fixed_moved"], &certificate["inverted"]], [0, 0]);
    assert_eq!(certificate["moved"], mesh["free"]);

    // The result is that of a run and a conversion.
    folder.line("in.msh same.msh --engine cpu").clean();
    folder.line("convert same.msh same.vtu").clean();
    assert!(folder.text("out.vtu") == folder.text("same.vtu"));
    // An earlier result is replaced, another mesh is not.
    folder.line("in.msh out.vtu --engine cpu --encoding compressed").clean();
    assert!(folder.mesh("out.vtu") == folder.mesh("same.vtu"));
    fs::write(folder.path("other.vtu"), "no mesh").unwrap();
    folder
        .line("in.msh other.vtu --engine cpu")
        .refused(&["other.vtu: exists, and cannot be read"]);
    assert_eq!(folder.text("other.vtu"), "no mesh");
}

#[test]
fn an_ending_that_differs_in_its_spelling_alone_keeps_the_format() {
    let folder = folder();
    for out in ["out.MSH", "out.msh2", "out", "out.msh.gz"] {
        let run = folder.line(&format!("in.msh {out} --engine cpu --encoding text"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let run = folder.line(&format!("in.msh {out} --engine cpu")).clean();
        assert_holds(run.out.lines().next().unwrap(), &["vertices (", "free"]);
        folder.line(&format!("compare in.msh {out}")).clean();
    }
    folder.line("convert in.msh grid.14 --lossy -q").clean();
    let run = folder.line("grid.14 grid.grd --engine cpu -q").clean();
    assert_eq!(run.out, "");
    folder.line("compare grid.14 grid.grd").clean();
}

#[test]
fn losses_of_a_run_into_another_format_are_refused_before_any_sweep() {
    let folder = folder();
    let before = folder.content();
    let lost = "groups of surfaces (physical): steel";
    for line in ["named.msh out.su2", "named.msh out.su2 --dry-run"] {
        folder.line(&format!("{line} --engine cpu")).refused(&["does not hold all", lost]);
        assert!(folder.content() == before, "{line}");
    }
    let run = folder.line("named.msh out.su2 --engine cpu --lossy");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &["gpu-smooth: lost: groups of surfaces (physical): steel"]);
    assert_holds(&run.out, &["gmsh 2.2 ASCII to SU2\n"]);
    folder
        .line("in.msh in.msh --to gmsh41 --engine cpu")
        .refused(&["in.msh is the mesh that is read"]);
}

/// The standard output gets the whole mesh, and no line of the summary.
#[test]
fn a_converted_mesh_goes_to_standard_output() {
    let folder = folder();
    let run = folder.line("in.msh - --to gmsh41 --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.out.starts_with("$MeshFormat\n4.1 0 8\n"), "{}", run.out);
    assert_holds(&run.err, &["gmsh 2.2 ASCII to gmsh 4.1 ASCII\n"]);
    folder
        .line("in.msh - --to triangle --engine cpu")
        .refused(&["a Triangle mesh has several files"]);
}

#[test]
fn many_meshes_are_converted_into_files_with_the_ending_of_the_format() {
    let folder = folder();
    folder.line("in.msh --out-dir a --to vtu --engine cpu -q").clean();
    let run = folder.line("in.msh named.msh --out-dir a --to vtu --engine cpu --json");
    assert_eq!(run.code, Some(1), "{}", run.err);
    assert_holds(&run.err, &["named.msh: VTK XML does not hold all of this mesh; --lossy "]);
    assert_smoothed(&folder.mesh("in.msh"), &folder.mesh("a/in.vtu"));
    assert!(!folder.path("a/named.vtu").exists());
    folder.line("in.msh --out-dir b --to triangle --engine cpu -q").clean();
    assert!(folder.path("b/in.node").exists() && folder.path("b/in.ele").exists());
    let run = folder.line("in.msh --out-dir b --to triangle --engine cpu --resume").clean();
    assert_holds(&run.out, &["1 skipped of 1 mesh"]);
    fs::copy(folder.path("in.msh"), folder.path("in.gmsh")).unwrap();
    let run = folder.line("in.msh in.msh.gz --out-dir c --to vtu --engine cpu");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["in.msh and in.msh.gz would both be written to c/in.vtu"]);
}

/// Data that a run interpolates are interpolated in the other format too, and depths change their sign where formats do.
#[test]
fn interpolated_data_are_converted() {
    let grid = "bay\n4 5\n1 0 0 1\n2 1 0 2\n3 1 1 3\n4 0 1 2\n5 .3 .4 9\n1 3 1 2 5\n2 3 2 3 5\n3 3 3 4 5\n4 3 4 1 5\n";
    let folder = Folder::new(&[("in.14", grid)]);
    let run = folder.line("in.14 out.2dm --interpolate all --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    folder.line("in.14 same.14 --interpolate all --engine cpu -q").clean();
    folder.line("convert same.14 same.2dm").clean();
    assert!(folder.text("out.2dm") == folder.text("same.2dm"));
    assert!(!folder.text("out.2dm").contains("-9.0"), "the depth of vertex 5 is interpolated");
}

/// A reader that closes the pipe, as `head` does, ends the program without a message.
#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_error() {
    let folder = folder();
    for line in
        ["groups in.msh", "quality in.msh", "in.msh - --engine cpu -q", "convert in.msh - --to vtu"]
    {
        let mut command: Command = folder.command();
        command.args(line.split_whitespace()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let run = child.wait_with_output().unwrap();
        let told = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!((run.status.code(), told.as_str()), (Some(141), ""), "{line}");
    }
}
