//! Destinations of meshes and reports, and unusual file names.

use super::files::{Layout, gmsh_text, middle_row, triangle_files, triangle_folder};
use super::{Folder, assert_holds, disturbed, number, small};
use std::fs;

/// The beginning of a report of any version.
const OLD_REPORT: &str = "{\"schema_version\": 3, \"program\": \"gpu-smooth 0.1.0\"}";

#[test]
fn a_mesh_is_replaced_in_place() {
    let folder = small();
    let gmsh = gmsh_text(&disturbed(), &middle_row(), Layout::Gmsh41);
    for name in ["a.msh", "b.msh"] {
        fs::write(folder.path(name), &gmsh).unwrap();
    }
    folder.line("in.node out.node --engine cpu").clean();
    folder.line("in.node in.node --engine cpu").clean();
    assert_eq!(folder.text("in.node"), folder.text("out.node"));
    assert_eq!(folder.text("in.ele"), folder.text("out.ele"));
    folder.line("a.msh out.msh --engine cpu --quiet").clean();
    folder.line("b.msh b.msh --engine cpu --quiet").clean();
    assert_eq!((folder.text("b.msh"), folder.text("a.msh")), (folder.text("out.msh"), gmsh));
    assert_eq!(folder.content().len(), 7);
}

#[test]
fn a_triangle_mesh_goes_by_any_of_its_names() {
    let folder = small();
    fs::create_dir(folder.path("a b")).unwrap();
    for (input, output) in [("in", "a b/1"), ("in.ele", "a b/2.node"), ("in.node", "a b/3.1.ele")] {
        folder.run([input, output, "--engine", "cpu"]).clean();
    }
    let nodes = ["a b/1.node", "a b/2.node", "a b/3.1.node"].map(|name| folder.text(name));
    assert!(nodes[0] == nodes[1] && nodes[1] == nodes[2] && nodes[0] != folder.text("in.node"));
    for name in ["a b/1.ele", "a b/2.ele", "a b/3.1.ele"] {
        assert_eq!(folder.text(name), folder.text("in.ele"));
    }
}

/// Endings without letters are numbers of versions, and `in.v2.node` has the ending of its OUT.
#[test]
fn a_triangle_mesh_is_not_written_behind_an_ending_of_no_format() {
    let folder = small();
    fs::create_dir(folder.path("dir")).unwrap();
    for (from, to) in [("in.node", "in.v2.node"), ("in.ele", "in.v2.ele")] {
        fs::copy(folder.path(from), folder.path(to)).unwrap();
    }
    let before = folder.content();
    for out in ["out.zzz", "out.v2", "dir/out.smooth"] {
        let text = format!(
            "{out}: the ending belongs to no format, and a Triangle mesh would be written to {out}.node and {out}.ele"
        );
        let run = folder.line(&format!("in.node {out} --engine cpu"));
        run.refused(&[&text, "End the name in .node"]);
        assert!(folder.content() == before, "{out}");
    }
    for (input, out) in [("in", "out.2"), ("in.v2", "out.v2"), ("in.v2.ele", "dir/in.v2")] {
        folder.run([input, out, "--engine", "cpu"]).clean();
        assert_eq!(folder.text(&format!("{out}.ele")), folder.text("in.ele"));
    }
}

#[test]
fn zero_sweeps_give_back_the_same_bytes() {
    let files = triangle_files(&disturbed(), 1);
    let folder = triangle_folder(&files);
    let run = folder.line("in out --max-sweeps 0 --engine cpu").clean();
    assert_holds(&run.out, &["stopped after 0 sweeps, the most allowed"]);
    assert_eq!([folder.text("out.node"), folder.text("out.ele")], files);
}

#[test]
fn destinations_that_cannot_work_are_refused_before_anything_is_written() {
    let folder = small();
    fs::write(folder.path("in.msh"), support::write_msh22(&disturbed())).unwrap();
    fs::write(folder.path("old.node"), "old").unwrap();
    fs::write(folder.path("locked.ele"), "old").unwrap();
    fs::create_dir(folder.path("dir")).unwrap();
    fs::write(folder.path("locked.json"), OLD_REPORT).unwrap();
    for name in ["locked.ele", "locked.json"] {
        let mut permissions = fs::metadata(folder.path(name)).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(folder.path(name), permissions).unwrap();
    }
    let before = folder.content();
    let cases: [(&str, &[&str]); 9] = [
        ("in.node none/out.node", &["none: no such directory", "Create the directory first"]),
        ("in.node out.bdf", &["out.bdf: Nastran is read, but not written. --to takes one of "]),
        ("in.node in.msh --to vtu", &["in.msh: the ending belongs to gmsh, not to VTK XML"]),
        ("in.msh out.step", &["out.step: its ending names no format to convert to"]),
        ("in.node locked", &["locked.ele: the file is read-only", "Make the file writable"]),
        ("in.node dir", &["dir: not the name of a file. Add a name like out.node"]),
        ("in.node out --report none/r.json", &["the report", "none: no such directory", "Create"]),
        ("in.node out --report dir", &["the report cannot be written: dir: ", "name of a file"]),
        ("in.node out --report locked.json", &["the report", "locked.json: the file is read-only"]),
    ];
    for (line, parts) in cases {
        folder.line(&format!("{line} --engine cpu")).refused(parts);
        assert!(folder.content() == before, "{line} has changed files");
    }
    for (line, parts) in [
        ("in.node out --report locked.ele", ["locked.ele: the report is JSON, not a mesh", ""]),
        ("in.node old --report old.node", ["old.node: the report is JSON", "End its name in"]),
        ("in.msh out --report out", ["out: the report is JSON, not a mesh", ""]),
        ("in.msh out.msh --report in.msh", ["in.msh: the report is JSON, not a mesh", ""]),
    ] {
        folder.line(&format!("{line} --engine cpu")).misused(&parts);
        assert!(folder.content() == before, "{line} has changed files");
    }
}

/// IN does not exist, so reading IN would cause a different error.
#[test]
fn files_beside_the_mesh_with_names_of_meshes_are_refused_before_a_mesh_is_read() {
    let folder = Folder::new(&[]);
    for (line, part) in [
        ("none out --report r.vtu", "r.vtu: the report is JSON, not a mesh. End its name in .json"),
        ("none out --report R.2DM", "R.2DM: the report is JSON, not a mesh"),
        ("none out --report r.msh.gz", "r.msh.gz: the report is JSON, not a mesh"),
        ("none out --report r.poly", "r.poly: the report is JSON, not a mesh"),
        (
            "none out --checkpoint c.msh",
            "c.msh: a checkpoint is no mesh. Give --checkpoint another",
        ),
        ("none out --continue c.su2", "c.su2: a checkpoint is no mesh"),
        ("none out --picture p.vtk", "p.vtk: a picture is PNG or SVG"),
        ("none out --html p.vtk", "p.vtk: a page is HTML"),
        ("a.msh b.msh --out-dir out --report r.vtu", "r.vtu: the report is JSON, not a mesh"),
    ] {
        folder.line(line).misused(&[part]);
    }
    for (line, part) in [
        ("none none/out", "none: no such directory. Create the directory first"),
        ("convert none none/out.msh", "none: no such directory. Create the directory first"),
        ("none out --report none/r.json", "the report cannot be written: none: no such directory"),
        ("none out --picture none/p.png", "the picture cannot be written: none: no such"),
        ("none out --html none/p.html", "the page cannot be written: none: no such"),
        ("none out --checkpoint none/c", "checkpoints cannot be saved: none: no such"),
        ("quality none --picture none/p.png", "the picture cannot be written: none: no such"),
    ] {
        folder.line(line).refused(&[part]);
    }
    assert_eq!(folder.content().len(), 0);
}

#[test]
fn files_that_are_read_or_hold_a_mesh_are_not_replaced_by_other_files() {
    let folder = small();
    let gmsh = support::write_msh22(&disturbed());
    let sizes = "MeshVersionFormatted 2\nDimension 2\nSolAtVertices\n0\n1 1\n";
    for (name, text) in [("in.msh", &*gmsh), ("kept.json", &gmsh), ("kept.html", &gmsh)] {
        fs::write(folder.path(name), text).unwrap();
    }
    for (name, text) in
        [("list.json", "1\n"), ("list.svg", "1\n"), ("sizes.json", sizes), ("state", "any\n")]
    {
        fs::write(folder.path(name), text).unwrap();
    }
    let before = folder.content();
    for (options, part) in [
        ("--report kept.json", "kept.json: the file is a mesh (gmsh)"),
        ("--html kept.html", "kept.html: the file is a mesh (gmsh). Give --html another"),
        (
            "--report list.json",
            "list.json: exists and is not a report of gpu-smooth. Give --report another name, or",
        ),
        ("--picture list.svg", "list.svg: exists and is not a picture"),
    ] {
        folder.line(&format!("in out --engine cpu {options}")).refused(&[part]);
    }
    for (options, part) in [
        ("--fix-vertices list.json --report list.json", "list.json: the report would replace this"),
        ("--target size=sizes.json --report sizes.json", "sizes.json: the report would replace"),
        ("--continue state --report state", "state: the report would replace this file"),
        ("--checkpoint r --report r", "r: the checkpoint would replace this file"),
        ("--checkpoint r --continue state --report state", "state: the report would replace"),
    ] {
        folder.line(&format!("in out --engine cpu {options}")).misused(&[part]);
    }
    folder.line("quality in.msh --picture in.msh").misused(&["in.msh: a picture is PNG or SVG"]);
    assert!(folder.content() == before);
    let run = folder.line("quality in.msh --picture list.svg");
    assert!(!run.refused(&["list.svg: exists and is not a picture"]).err.contains("--force"));
    folder.line("in out --engine cpu --report list.json --force").clean();
    assert!(folder.text("list.json").starts_with('{'));
}

#[test]
fn files_beside_the_mesh_replace_earlier_outputs_and_no_foreign_json_xml_or_picture() {
    let folder = small();
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0";
    let drawing = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\"></svg>\n";
    let page = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>Notes</title>\n";
    let mesh = "{ \"type\": \"FeatureCollection\", \"program\": \"gpu-smooth\" }\n";
    let febio = "<?xml version=\"1.0\"?>\n<febio_spec><Mesh name=\"plate\"/></febio_spec>\n";
    for (option, name, foreign) in [
        ("--report", "a.json", [mesh.as_bytes(), b"{\"schema_version\": 3, \"meshes\": []}"]),
        ("--html", "a.html", [page.as_bytes(), febio.as_bytes()]),
        ("--picture", "a.svg", [drawing.as_bytes(), febio.as_bytes()]),
        ("--picture", "a.png", [&png[..], drawing.as_bytes()]),
    ] {
        let line = format!("in out --engine cpu -q {option} {name}");
        for foreign in foreign {
            fs::write(folder.path(name), foreign).unwrap();
            folder.line(&line).refused(&[&format!("{name}: exists and is not a "), "--force"]);
            assert!(fs::read(folder.path(name)).unwrap() == foreign);
        }
        folder.line(&format!("{line} --force")).clean();
        folder.line(&line).clean();
    }
    // A report whose blanks another program has changed is still a report.
    let compact: String = folder.text("a.json").split_whitespace().collect();
    fs::write(folder.path("a.json"), compact).unwrap();
    folder.line("in out --engine cpu -q --report a.json").clean();
    folder.line("quality in --html q.html -q").clean();
    folder.line("quality in --html q.html -q").clean();
}

/// Formats without a first word, and compressed meshes.
#[test]
fn meshes_that_their_numbers_identify_are_not_replaced_by_reports() {
    let folder = small();
    fs::write(folder.path("in.msh"), support::write_msh22(&disturbed())).unwrap();
    for (to, out) in
        [("freefem", "a.msh"), ("adcirc", "a.gr3"), ("vtk", "a.vtk.gz"), ("obj", "a.obj.zst")]
    {
        folder.line(&format!("convert in.msh {out} --to {to} --lossy -q")).clean();
    }
    for mesh in ["in.node", "in.ele", "a.msh", "a.gr3", "a.vtk.gz", "a.obj.zst"] {
        fs::copy(folder.path(mesh), folder.path("kept.json")).unwrap();
        let before = folder.content();
        let run = folder.line("in out --engine cpu --report kept.json");
        run.refused(&["kept.json: the file is a mesh (", "Give --report another name"]);
        assert!(folder.content() == before, "{mesh}");
    }
}

/// A mesh with a `.poly`, under names without the usual endings, and links to its files.
#[cfg(unix)]
fn linked() -> Folder {
    use std::os::unix::fs::symlink;
    let folder = small();
    fs::write(folder.path("in.poly"), "0 2 0 0\n1 0\n1 50 51\n0\n").unwrap();
    fs::write(folder.path("mesh"), support::write_msh22(&disturbed())).unwrap();
    fs::create_dir(folder.path("sub")).unwrap();
    for name in ["in.node", "in.ele", "in.poly", "out.ele", "later"] {
        symlink(name, folder.path(&format!("to-{name}.json"))).unwrap();
    }
    symlink("to-later.json", folder.path("to-to-later.json")).unwrap();
    symlink(".", folder.path("here")).unwrap();
    fs::hard_link(folder.path("mesh"), folder.path("mesh.json")).unwrap();
    fs::hard_link(folder.path("in.poly"), folder.path("poly.json")).unwrap();
    folder
}

#[cfg(unix)]
#[test]
fn a_report_does_not_replace_the_mesh_under_another_spelling_or_through_a_link() {
    let folder = linked();
    let before = folder.content();
    for line in [
        "mesh out --report ./mesh",
        "mesh out --report sub/../mesh",
        "mesh out --report here/mesh",
        "./mesh out --report mesh",
        "mesh out --report mesh.json",
        // A file written by the run, both existing and new.
        "mesh out --report ./out",
        "mesh later --report to-later.json",
        "mesh here/later --report to-to-later.json",
        "mesh to-later.json --report later",
    ] {
        folder.line(&format!("{line} --engine cpu")).misused(&["the report is JSON, not a mesh"]);
        assert!(folder.content() == before, "{line} has changed files");
    }
    // The files of a Triangle mesh are known only after reading, or by their content.
    let (by_name, by_content) = ("the report is JSON, not a mesh", "the file is a mesh (Triangle");
    for (line, part) in [
        ("in out --report to-in.node.json", by_content),
        ("in out --report here/to-in.ele.json", by_content),
        ("in out --report to-in.poly.json --force", by_name),
        ("in out --report poly.json --force", by_name),
        ("in out --report to-out.ele.json", by_name),
    ] {
        folder.line(&format!("{line} --engine cpu")).refused(&[part]);
        assert!(folder.content() == before, "{line} has changed files");
    }
    let run = folder.line("mesh out --engine cpu --report sub/out");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(number(&folder.json("sub/out")["sweeps"]) > 0.0);
}

#[cfg(unix)]
#[test]
fn a_report_takes_the_place_of_an_old_one_only_once_it_is_whole() {
    let folder = small();
    fs::write(folder.path("r.json"), OLD_REPORT).unwrap();
    // A hard link keeps the old content if the file is replaced, and shows the new content if the file is
    // overwritten.
    fs::hard_link(folder.path("r.json"), folder.path("kept")).unwrap();
    folder.line("in out --engine cpu --report r.json").clean();
    assert_eq!(folder.text("kept"), OLD_REPORT);
    assert!(number(&folder.json("r.json")["sweeps"]) > 0.0);
    assert_eq!(folder.content().len(), 6);
}

/// Names of files are bytes. They may be invalid text, and contain line ends or control characters of a terminal.
#[cfg(target_os = "linux")]
#[test]
fn names_of_any_bytes_are_read_and_written_and_printed_on_one_line() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let folder = small();
    let named = |bytes: &'static [u8]| OsStr::from_bytes(bytes);
    for (from, to) in [("in.node", &b"\xFF\n.node"[..]), ("in.ele", b"\xFF\n.ele")] {
        fs::rename(folder.path(from), folder.0.path().join(OsStr::from_bytes(to))).unwrap();
    }
    let [cpu, quiet, report] = ["--engine=cpu", "-q", "--report"].map(OsStr::new);
    let args = [named(b"\xFF\n"), named(b"\xFE\x1B[31m"), cpu, quiet, report, named(b"\xFD.json")];
    folder.run(args).clean();
    for written in [&b"\xFE\x1B[31m.node"[..], b"\xFE\x1B[31m.ele", b"\xFD.json"] {
        assert!(folder.0.path().join(OsStr::from_bytes(written)).exists(), "{written:?}");
    }
    let run = folder.run([named(b"none\xFF\x1B[31m\x07"), named(b"out"), cpu]);
    let run = run.refused(&["none\u{FFFD}\\u{1b}[31m\\u{7}"]);
    assert_eq!(run.err.lines().count(), 1, "{}", run.err);
}

/// A mesh in the format of IN was written behind any ending, and `--report -` made a file of that name.
#[test]
fn endings_of_other_files_and_a_stream_beside_the_mesh_are_refused() {
    let folder = small();
    let before = folder.content();
    for (line, remedy) in [
        ("in out.png", "--picture FILE.png"),
        ("in out.HTML", "--html FILE.html"),
        ("in out.json", "--report FILE.json"),
        ("in out.xz", "or in .gz"),
    ] {
        folder.line(line).misused(&["a mesh is written here, and .", remedy]);
    }
    for option in ["--report", "--html", "--checkpoint"] {
        let told = ["only a mesh is written to standard output", option];
        folder.line(&format!("in out {option} -")).misused(&told);
    }
    assert!(folder.content() == before);
}
