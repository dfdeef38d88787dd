//! Files that a mesh must not replace: another mesh, a file of another kind, a file of IN, and a file changed during
//! the run.

#[cfg(unix)]
use super::interrupt::Started;
use super::{Folder, assert_holds, disturbed, small};
use std::fs;

/// Returns a folder with two meshes of different triangles, `a.msh` and `b.msh`, and `moved.msh`, which is `a.msh` with
/// other positions.
fn two_meshes() -> Folder {
    let mesh = disturbed();
    let other = support::perturb_random(&support::lattice(12, 8), 0.5, 5);
    let moved = support::perturb_random(&mesh, 0.1, 9);
    let text = [&mesh, &other, &moved].map(support::write_msh22);
    Folder::new(&[("a.msh", &text[0]), ("b.msh", &text[1]), ("moved.msh", &text[2])])
}

/// A shell expands `gpu-smooth *.msh` without `--out-dir` to two meshes, of which the second would be OUT.
#[test]
fn another_mesh_is_replaced_by_force_only() {
    let folder = two_meshes();
    let before = folder.content();
    folder.line("a.msh b.msh --engine cpu").refused(&[
        "b.msh: holds another mesh than a.msh: it has 117 vertices",
        "name a directory by --out-dir",
        "--force",
    ]);
    assert!(folder.content() == before, "files have changed");
    folder.line("a.msh b.msh --engine cpu -q --force").clean();
    folder.line("a.msh out.msh --engine cpu -q").clean();
    assert_eq!(folder.text("b.msh"), folder.text("out.msh"));
}

#[test]
fn an_earlier_state_of_the_mesh_is_replaced_without_force() {
    let folder = two_meshes();
    folder.line("a.msh out.msh --engine cpu -q --max-sweeps 1").clean();
    folder.line("a.msh out.msh --engine cpu -q").clean();
    folder.line("a.msh moved.msh --engine cpu -q").clean();
    assert_eq!(folder.text("moved.msh"), folder.text("out.msh"));
    fs::write(folder.path("empty.msh"), "").unwrap();
    folder.line("a.msh empty.msh --engine cpu -q").clean();
    let parts = small();
    parts.line("in out --engine cpu -q --max-sweeps 1").clean();
    parts.line("in out.ele --engine cpu -q").clean();
    // A killed run may leave these companion files of a new mesh.
    fs::remove_file(parts.path("out.node")).unwrap();
    parts.line("in out --engine cpu -q").clean();
}

#[test]
fn a_mesh_with_other_fixed_vertices_is_another_mesh() {
    let text = support::write_msh22(&disturbed());
    let folder = Folder::new(&[("a.msh", &text)]);
    let (head, elements) = text.split_once("$Elements\n").unwrap();
    let (count, rows) = elements.split_once('\n').unwrap();
    let count: usize = count.parse().unwrap();
    let with_point = format!("{head}$Elements\n{}\n{}15 2 0 1 50\n", count + 1, "9999 ");
    fs::write(folder.path("b.msh"), with_point + rows).unwrap();
    let refused = folder.line("a.msh b.msh --engine cpu");
    refused.refused(&["b.msh: holds another mesh than a.msh: its fixed vertices are others"]);
}

#[test]
fn a_mesh_of_another_place_or_with_other_data_is_another_mesh() {
    let mesh = disturbed();
    let text = |scale: f64, depth: f64, corner: f64| {
        let nodes = (1..).zip(&mesh.points).map(|(id, [x, y])| {
            let depth = if id == 1 { corner } else { depth + x };
            format!("ND {id} {} {} {depth}\n", scale * x + 10.0 * (scale - 1.0), scale * y)
        });
        let triangles = (1..).zip(&mesh.triangles).map(|(id, t)| {
            let [a, b, c] = t.map(|v| v + 1);
            format!("E3T {id} {a} {b} {c} 1\n")
        });
        format!("MESH2D\n{}{}", triangles.collect::<String>(), nodes.collect::<String>())
    };
    let folder = Folder::new(&[
        ("in.2dm", &text(1.0, 5.0, 5.0)),
        ("elsewhere.2dm", &text(2.0, 5.0, 5.0)),
        ("deeper.2dm", &text(1.0, 7.0, 7.0)),
        ("corner.2dm", &text(1.0, 5.0, 6.0)),
    ]);
    let before = folder.content();
    for (out, told) in [
        ("elsewhere.2dm", "its boundary is elsewhere"),
        ("deeper.2dm", "its data on the boundary are others: `z`"),
        ("corner.2dm", "its data on the boundary are others: `z`"),
    ] {
        let told = format!("{out}: holds another mesh than in.2dm: {told}");
        folder.line(&format!("in.2dm {out} --engine cpu")).refused(&[&told, "--force"]);
        assert!(folder.content() == before, "files have changed");
    }
    // Results of runs replace each other, whether vertices slide and data are interpolated or not.
    for words in ["", "--slide", "--interpolate z", "--slide --interpolate z", "--slide", ""] {
        let run = folder.line(&format!("in.2dm out.2dm --engine cpu -q {words}"));
        assert_eq!(run.code, Some(0), "{words}: {}", run.err);
    }
}

/// Returns a square of four times four quadrilaterals as gmsh 2.2. `group` is the physical group of a column of
/// quadrilaterals, and `lines` have the numbers of their nodes.
fn quadrilaterals(group: impl Fn(usize) -> usize, lines: &[[usize; 2]]) -> String {
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n25\n");
    for v in 0..25 {
        let off = if v == 12 { 0.2 } else { 0.0 };
        text += &format!("{} {} {} 0\n", v + 1, (v % 5) as f64 + off, v / 5);
    }
    text += &format!("$EndNodes\n$Elements\n{}\n", 16 + lines.len());
    for k in 0..16 {
        let a = k / 4 * 5 + k % 4 + 1;
        let group = group(k % 4);
        text += &format!("{} 3 2 {group} 1 {a} {} {} {}\n", k + 1, a + 1, a + 6, a + 5);
    }
    for (k, [a, b]) in lines.iter().enumerate() {
        text += &format!("{} 1 2 9 9 {a} {b}\n", k + 17);
    }
    text + "$EndElements\n"
}

/// A former defect: vertices that had slid around a disc were a boundary elsewhere.
#[test]
fn a_disc_whose_whole_boundary_has_slid_is_no_other_mesh() {
    let (around, disc) = (24, support::hub_evenly(24, 6));
    let disc = support::tangle::moved(&disc, |[x, y]| [x + 0.1 * x * y, y]);
    let folder = Folder::new(&[("in.msh", &support::write_msh22(&disc))]);
    for words in ["--slide", "", "--slide"] {
        let run = folder.line(&format!("in.msh out.msh --engine cpu -q {words}"));
        assert_eq!(run.code, Some(0), "{words}: {}", run.err);
        let out = folder.mesh("out.msh").points;
        let moved = (0..around).filter(|v| out[*v] != disc.points[*v]);
        assert_eq!(moved.count(), if words.is_empty() { 0 } else { around });
    }
}

#[test]
fn quadrilaterals_of_other_materials_or_with_other_lines_are_another_mesh() {
    let meshes = [
        ("in.msh", quadrilaterals(|_| 1, &[])),
        ("materials.msh", quadrilaterals(|column| 1 + column / 2, &[])),
        ("lines.msh", quadrilaterals(|_| 1, &[[7, 12], [12, 17]])),
    ];
    let folder = Folder::new(&meshes.each_ref().map(|(name, text)| (*name, &**text)));
    let before = folder.content();
    for (out, _) in &meshes[1..] {
        let told = format!("{out}: holds another mesh than in.msh: its fixed vertices are others");
        folder.line(&format!("in.msh {out} --engine cpu")).refused(&[&told, "--force"]);
        assert!(folder.content() == before, "files have changed");
    }
    for (input, _) in &meshes {
        for _ in 0..2 {
            folder.line(&format!("{input} out_{input} --engine cpu -q")).clean();
        }
    }
}

#[test]
fn a_file_that_is_no_mesh_is_replaced_by_force_only() {
    let folder = small();
    for name in ["notes", "half.node", "half.ele"] {
        fs::write(folder.path(name), "5 2 0 0\n1 0 0\n").unwrap();
    }
    fs::write(folder.path("alone.ele"), "1 3 0\n1 1 2 3\n").unwrap();
    fs::write(folder.path("a.msh"), support::write_msh22(&disturbed())).unwrap();
    let before = folder.content();
    for (line, file) in
        [("a.msh notes", "notes"), ("in half", "half.node"), ("in alone", "alone.ele")]
    {
        let part = format!("{file}: exists, and cannot be read as a mesh: ");
        folder.line(&format!("{line} --engine cpu")).refused(&[&part, "--force"]);
        assert!(folder.content() == before, "{line} has changed files");
    }
    folder.line("a.msh notes --engine cpu -q --force").clean();
    folder.line("in half --engine cpu -q --force").clean();
    folder.line("in alone --engine cpu -q --force").clean();
}

#[test]
fn many_meshes_replace_no_others_of_their_names() {
    let folder = two_meshes();
    fs::create_dir(folder.path("out")).unwrap();
    fs::copy(folder.path("a.msh"), folder.path("out/b.msh")).unwrap();
    let run = folder.line("a.msh b.msh --out-dir out --engine cpu -q");
    assert_eq!(run.code, Some(1));
    assert_holds(&run.err, &["out/b.msh: holds another mesh than b.msh", "--force"]);
    assert_eq!(folder.text("out/b.msh"), folder.text("a.msh"));
    folder.line("a.msh b.msh --out-dir out --engine cpu -q --force").clean();
}

#[test]
fn a_conversion_replaces_its_own_result_and_no_other_mesh() {
    let folder = two_meshes();
    for out in
        ["out.vtk", "out.su2", "out.node", "out.vtu", "out.ply", "out.off", "out.inp", "out.exo"]
    {
        folder.line(&format!("convert a.msh {out} -q --lossy")).clean();
        folder.line(&format!("convert a.msh {out} -q --lossy")).clean();
        let refused = folder.line(&format!("convert b.msh {out} -q --lossy"));
        refused.refused(&[out, ": holds another mesh than b.msh: ", "--force"]);
    }
    folder.line("convert b.msh out.vtk -q --lossy --force").clean();
    fs::write(folder.path("notes.vtk"), "notes\n").unwrap();
    folder.line("convert a.msh notes.vtk -q --lossy").refused(&["notes.vtk: exists, and cannot"]);
}

/// A user may mistake the two files of a Triangle mesh for IN and OUT.
#[test]
fn a_file_of_the_mesh_beside_in_is_no_place_for_out() {
    let folder = small();
    let before = folder.content();
    for (input, out) in [("in.node", "in.ele"), ("in.ele", "in.node"), ("in", "./in.ele")] {
        let file = format!("{out}: this file belongs to the mesh of {input}");
        let parts = [&file, "name one file twice", "give OUT another name"];
        folder.line(&format!("{input} {out} --engine cpu --force")).refused(&parts);
        assert!(folder.content() == before, "files have changed");
    }
    for line in ["in.ele in.ele", "in in", "in in.node", "in.node ./in.node"] {
        folder.line(&format!("{line} --engine cpu -q")).clean();
    }
}

/// A signal ends the run after another program has edited the mesh, which is smoothed in place.
#[cfg(unix)]
#[test]
fn a_mesh_that_another_program_has_changed_meanwhile_is_not_replaced() {
    let folder = small();
    let lasting = ["-v", "--tolerance", "0", "--max-sweeps", "100000000"];
    let args = [&["in", "in", "--engine", "cpu"][..], &lasting].concat();
    for name in ["in.node", "in.ele"] {
        let mut run = Started::new(&folder, &args);
        run.first_of("gpu-smooth: sweep ");
        let edited = folder.text(name) + "# edited\n";
        fs::write(folder.path(name), &edited).unwrap();
        let before = folder.content();
        run.signal("-INT");
        let (code, out, err) = run.end();
        assert_eq!((code, out.as_str()), (Some(4), ""), "{err}");
        let problem =
            format!("error: {name}: another program has changed this file after the file was read");
        assert_holds(&err, &[&problem, "Give OUT another name"]);
        assert!(folder.content() == before, "files have changed");
    }
}
