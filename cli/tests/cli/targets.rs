//! Target sizes and shapes: kept, given, or measured on the sphere.

use super::{Folder, assert_holds, assert_smoothed, disturbed, number};
use gpu_smooth::Mesh;
use mesh_io::MeshFile;
use std::fmt::Write;
use std::fs;

fn node_ele(mesh: &Mesh) -> [String; 2] {
    support::triangle_text(mesh, "")
}

fn folder(more: &[(&str, &str)]) -> Folder {
    let [node, ele] = node_ele(&disturbed());
    let files = [("in.node", node.as_str()), ("in.ele", ele.as_str())];
    Folder::new(&[&files, more].concat())
}

/// Returns a size for each vertex, growing from left to right.
fn sizes() -> Vec<f64> {
    disturbed().points.iter().map(|&[x, _]| 1.0 + x.abs()).collect()
}

fn listed(values: &[f64], per_row: usize) -> String {
    let mut text = String::new();
    for row in values.chunks(per_row) {
        let row: Vec<String> = row.iter().map(f64::to_string).collect();
        writeln!(text, "{}", row.join(" ")).unwrap();
    }
    text
}

#[test]
fn targets_are_kept_and_reported_on_both_engines() {
    for (target, scheme) in [("keep-size", "tmop-94"), ("keep-shape", "imr")] {
        let starts = ["cpu", "gpu"].map(|engine| {
            let folder = folder(&[]);
            let line = format!("in out --engine {engine} --target {target} --report r.json");
            let run = folder.line(&line);
            assert_eq!(run.code, Some(0), "{}", run.err);
            assert_smoothed(&folder.mesh("in.node"), &folder.mesh("out.node"));
            assert_holds(&run.out, &[scheme, "f of targets", "f imr", "vertices moved"]);
            let report = folder.json("r.json");
            assert_eq!(report["scheme"], scheme);
            let told = &report["target"];
            assert_eq!((&told["kind"], &told["surface"]), (&target.into(), &"plane".into()));
            let [before, after] = [0, 1].map(|i| number(&told["f"][i]));
            assert!(after < before, "{told}");
            // The history of a device is in single precision.
            let off = if engine == "cpu" { 1e-12 } else { 1e-4 };
            assert!((number(&report["history"][0]["f"]) - before).abs() <= off * before);
            before
        });
        assert_eq!(starts[0], starts[1], "{target}");
    }
}

/// Poor meshes without adaptation get no note; see [`Run::clean`](super::Run::clean) in other tests.
#[test]
fn the_target_that_keeps_an_adapted_mesh_is_named_before_the_run() {
    for (mesh, part) in [
        (support::layered(24, 60.0), "--target keep-shape keeps their stretching"),
        (support::graded(12, 0.05), "--target keep-size keeps them"),
    ] {
        let [node, ele] = node_ele(&mesh);
        let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
        let run = folder.line("in out --engine cpu");
        assert_eq!(run.code, Some(0), "{}", run.err);
        let remarks: Vec<&str> =
            run.err.lines().filter(|line| line.contains("the mesh is ")).collect();
        assert!(remarks.len() == 1 && remarks[0].contains(part), "{remarks:?}");
        let target = part.split_whitespace().nth(1).unwrap();
        let run = folder.line(&format!("in out --engine cpu --target {target} --force"));
        assert!(!run.err.contains("the mesh is "), "{}", run.err);
    }
}

#[test]
fn sizes_weigh_more_on_a_stretched_mesh_and_the_weight_is_reported() {
    let [node, ele] = node_ele(&support::layered(24, 60.0));
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    let run = |scheme: &str| {
        let args = "in out --engine cpu --target keep-size --force --report r.json";
        let run = folder.line(&format!("{args} {scheme}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        (run, folder.json("r.json"))
    };
    let mut changes = Vec::new();
    for scheme in ["--scheme tmop-80", "", "--scheme soft-size"] {
        let (run, report) = run(scheme);
        let weight = number(&report["target"]["size_weight"]);
        assert!((2.0..100.0).contains(&weight), "{weight}");
        assert_holds(&run.err, &[&format!("term of size has a weight of {weight:.2}")]);
        let change = number(&report["change"]["size"]["p95"]);
        let hint = "--scheme tmop-80 keeps sizes closer";
        assert_eq!(run.out.contains(hint), change > 1.25, "{}", run.out);
        changes.push(change);
    }
    // The first scheme lets shapes give way to sizes, and the last scheme sizes to shapes.
    assert!(changes.is_sorted() && changes[1] < 1.3 && changes[2] > 1.3, "{changes:?}");
    // SHAPE-SIZE has no weight.
    let (run, report) = run("--scheme shape-size");
    assert!(report["target"].get("size_weight").is_none() && !run.err.contains("weight"));
    // On an ordinary mesh, the weight is 1, and no remark names it.
    let folder = self::folder(&[]);
    folder.line("in out --engine cpu --target keep-size --report r.json").clean();
    assert_eq!(folder.json("r.json")["target"]["size_weight"], 1.0);
}

#[test]
fn a_target_of_sizes_is_not_given_to_a_metric_that_sees_none() {
    let folder = folder(&[]);
    let run = folder.line("in out --target keep-size --scheme imr");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["--target keep-size has no effect on imr", "soft-size"]);
    folder.line("in out --engine cpu --target keep-size --scheme shape-size").clean();
}

#[test]
fn sizes_and_tensors_come_from_files_of_medit_and_bamg_and_from_point_data() {
    let (sizes, count) = (sizes(), sizes().len());
    let tensors: Vec<f64> =
        sizes.iter().flat_map(|h| [1.0 / (h * h), 0.0, 1.0 / (h * h)]).collect();
    let medit = |kind: u32, rows: &str| {
        format!(
            "MeshVersionFormatted 2\n\nDimension 2\n\nSolAtVertices\n{count}\n1 {kind}\n{rows}End\n"
        )
    };
    let (scalars, rows) = (listed(&sizes, 1), listed(&tensors, 3));
    let files = [
        ("h.sol", medit(1, &scalars)),
        ("m.sol", medit(3, &rows)),
        ("h.mtr", format!("{count} 1\n{scalars}")),
        ("m.mtr", format!("{count} 3\n{rows}")),
    ];
    let files: Vec<(&str, &str)> =
        files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let folder = folder(&files);
    let mut ends = Vec::new();
    for target in ["size=h.sol", "metric=m.sol", "size=h.mtr", "metric=m.mtr"] {
        let line = format!("in out --engine cpu --scheme soft-size --target {target}");
        folder.line(&line).clean();
        ends.push(folder.mesh("out.node").points);
    }
    // A size h is the tensor 1 / h² times the identity, so the meshes agree up to rounding.
    for other in &ends {
        let apart = ends[0].iter().zip(other).map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]));
        assert!(apart.fold(0.0, f64::max) < 1e-9);
    }
    // Without targets, the result differs.
    folder.line("in even --engine cpu --scheme soft-size").clean();
    assert_ne!(folder.mesh("even.node").points, ends[0]);

    let mut vtk = "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\n".to_owned();
    let mesh = disturbed();
    writeln!(vtk, "POINTS {count} double").unwrap();
    for [x, y] in &mesh.points {
        writeln!(vtk, "{x:?} {y:?} 0").unwrap();
    }
    let triangles = mesh.triangles.len();
    writeln!(vtk, "CELLS {triangles} {}", 4 * triangles).unwrap();
    for [a, b, c] in &mesh.triangles {
        writeln!(vtk, "3 {a} {b} {c}").unwrap();
    }
    writeln!(vtk, "CELL_TYPES {triangles}\n{}", "5\n".repeat(triangles)).unwrap();
    writeln!(vtk, "POINT_DATA {count}\nSCALARS h double 1\nLOOKUP_TABLE default\n{scalars}")
        .unwrap();
    let folder = Folder::new(&[("in.vtk", &vtk)]);
    assert_eq!(folder.line("in.vtk out.vtk --engine cpu --target size=h").code, Some(0));
    let apart = folder.mesh("out.vtk").points;
    let apart = apart.iter().zip(&ends[0]).map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]));
    assert!(apart.fold(0.0, f64::max) < 1e-9);
}

#[test]
fn sizes_that_do_not_fit_are_refused_with_file_and_reason() {
    let count = sizes().len();
    let good = listed(&sizes(), 1);
    let cut = good.lines().take(7).collect::<Vec<_>>().join("\n");
    let files = [
        ("few.mtr", "3 1\n1 1 1\n".to_owned()),
        ("cut.mtr", format!("{count} 1\n{cut}")),
        ("wrong.mtr", format!("{count} 1\n{}", good.replacen('1', "x", 1))),
        ("zero.mtr", format!("{count} 1\n{}", "0\n".repeat(count))),
        ("two.mtr", format!("{count} 2\n{good}")),
        ("huge.mtr", "99999999999999 3\n1 0 1\n".to_owned()),
        (
            "vector.sol",
            format!("MeshVersionFormatted 2\nDimension 2\nSolAtVertices\n{count}\n1 2\n"),
        ),
        ("solid.sol", "MeshVersionFormatted 2\nDimension 3\n".to_owned()),
        ("none.sol", "MeshVersionFormatted 2\nDimension 2\nEnd\n".to_owned()),
        ("more.mtr", format!("{count} 1\n{good}0.5\n")),
        (
            "more.sol",
            format!(
                "MeshVersionFormatted 2\nDimension 2\nSolAtVertices\n{count}\n1 1\n{good}\n7 8\nEnd\n"
            ),
        ),
    ];
    let files: Vec<(&str, &str)> =
        files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let folder = folder(&files);
    for (target, parts) in [
        (
            "size=few.mtr",
            &["few.mtr: it has numbers for 3 vertices", "in the order of the mesh file"][..],
        ),
        ("size=in.node", &["or in.node:NAME for point data of this mesh"]),
        ("size=cut.mtr", &["cut.mtr:8: the file ends after 7 of"]),
        ("size=wrong.mtr", &["wrong.mtr:2", "not a number"]),
        (
            "size=zero.mtr",
            &["zero.mtr: in.node:3: vertex 1: its size is not positive", "Give sizes above 0"],
        ),
        ("size=two.mtr", &["two.mtr:1: a vertex has 2 numbers"]),
        ("metric=huge.mtr", &["huge.mtr:2: the file ends after 1 of 99999999999999 vertices"]),
        ("size=vector.sol", &["vector.sol:5: the solution is of kind 2"]),
        ("size=solid.sol", &["solid.sol:2: the solution is of a mesh of dimension 3"]),
        ("size=none.sol", &["there is no SolAtVertices"]),
        (
            "size=more.mtr",
            &[
                "more.mtr:",
                "`0.5` follows after one number for each of",
                "Correct the number of vertices",
            ],
        ),
        ("size=more.sol", &["more.sol:", "`7` follows after one number for each of"]),
        ("size=nowhere", &["nowhere: there is no such file"]),
    ] {
        folder.line(&format!("in out --engine cpu --target {target}")).refused(parts);
    }
    let run = folder.line("in out --engine cpu --target size=");
    assert_eq!(run.code, Some(2), "{}", run.err);
}

/// Returns the small mesh as a SCHISM grid. Latitudes start at `south` and grow by half of the heights.
fn gr3(south: f64) -> String {
    let mesh = disturbed();
    let mut text = format!("bay\n{} {}\n", mesh.triangles.len(), mesh.points.len());
    for (i, [x, y]) in mesh.points.iter().enumerate() {
        writeln!(text, "{} {} {} 1.5", i + 1, -70.0 + x, south + 0.5 * y).unwrap();
    }
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        writeln!(text, "{} 3 {} {} {}", i + 1, a + 1, b + 1, c + 1).unwrap();
    }
    text + "0 = Number of open boundaries\n"
}

#[test]
fn degrees_are_noticed_in_formats_of_ocean_models_and_smoothed_on_the_sphere() {
    let folder = Folder::new(&[("in.gr3", &gr3(60.0))]);
    let note = "the coordinates look like degrees: --surface sphere";
    let plane = folder.line("in.gr3 plane.gr3 --engine cpu --report plane.json");
    assert_holds(&plane.err, &[note]);
    let sphere = folder.line("in.gr3 out.gr3 --engine cpu --surface sphere --report r.json");
    assert_eq!(sphere.code, Some(0), "{}", sphere.err);
    assert!(!sphere.err.contains(note), "{}", sphere.err);
    let report = folder.json("r.json");
    assert_eq!(report["target"]["surface"], "sphere");
    // f and angles are measured on the sphere. Targets use lengths at vertices, f those in the middle of triangles.
    let [f, target] = [&report["after"]["f"]["imr"], &report["target"]["f"][1]].map(number);
    assert!((f / target - 1.0).abs() < 2e-3, "{f} {target}");
    let angle = number(&report["after"]["min_angle"]);
    assert!(angle > number(&folder.json("plane.json")["after"]["min_angle"]), "{angle}");

    let folder = Folder::new(&[("in.gr3", &gr3(89.0))]);
    folder
        .line("in.gr3 out.gr3 --engine cpu --surface sphere --quiet")
        .refused(&["its latitude is not between -90 and 90 degrees", "leave out --surface sphere"]);
}

/// In SELAFIN of TELEMAC, the length of each record precedes and follows its data. The mesh is the small one at 60
/// degrees north.
#[test]
fn degrees_are_noticed_in_selafin() {
    let mesh = disturbed();
    let (points, triangles) = (mesh.points.len(), mesh.triangles.len());
    let mut bytes: Vec<u8> = Vec::new();
    let mut record = |content: &[u8]| {
        let length = (content.len() as u32).to_be_bytes();
        bytes.extend([&length[..], content, &length[..]].concat());
    };
    let ints =
        |numbers: &[i32]| -> Vec<u8> { numbers.iter().flat_map(|n| n.to_be_bytes()).collect() };
    let reals =
        |numbers: Vec<f64>| -> Vec<u8> { numbers.iter().flat_map(|x| x.to_be_bytes()).collect() };
    record(format!("{:<72}SERAFIND", "bay").as_bytes());
    record(&ints(&[1, 0]));
    record(format!("{:<16}{:<16}", "BOTTOM", "M").as_bytes());
    record(&ints(&[1, 0, 0, 0, 0, 0, 0, 0, 0, 0]));
    record(&ints(&[triangles as i32, points as i32, 3, 1]));
    record(&ints(&mesh.triangles.as_flattened().iter().map(|&v| v as i32 + 1).collect::<Vec<_>>()));
    record(&ints(&vec![0; points]));
    record(&reals(mesh.points.iter().map(|p| p[0]).collect()));
    record(&reals(mesh.points.iter().map(|p| 60.0 + 0.5 * p[1]).collect()));
    record(&reals(vec![0.0]));
    record(&reals(vec![1.0; points]));
    let folder = Folder::new(&[]);
    std::fs::write(folder.path("in.slf"), bytes).unwrap();
    let run = folder.line("in.slf out.slf --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &["the coordinates look like degrees: --surface sphere"]);
}

/// Returns a gmsh file with two triangles around the small mesh. `h` is 1 at their left corners and 4 at the right
/// ones.
fn background(factor: f64) -> String {
    let points = disturbed().points;
    let most = |axis: usize| points.iter().fold(f64::MIN, |most, p| most.max(p[axis]));
    let least = |axis: usize| points.iter().fold(f64::MAX, |least, p| least.min(p[axis]));
    let (x, y) = ([least(0), factor * most(0)], [least(1), most(1)]);
    let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
    let nodes = corners.iter().zip(1..).map(|([x, y], tag)| format!("{tag} {x} {y} 0\n"));
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n{}$EndNodes\n$Elements\n2\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n$EndElements\n\
         $NodeData\n1\n\"h\"\n1\n0\n3\n0\n1\n4\n1 1\n2 4\n3 4\n4 1\n$EndNodeData\n",
        nodes.collect::<String>()
    )
}

#[test]
fn sizes_come_from_a_mesh_of_their_own_and_belong_to_places() {
    let files = [
        ("bg.msh", background(1.0)),
        ("half.msh", background(0.5)),
        ("bg.mtr", "4 1\n1 4 4 1\n".into()),
    ];
    let files: Vec<(&str, &str)> =
        files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let folder = folder(&files);
    let mut ends = Vec::new();
    for target in ["size=bg.msh:h", "size=bg.msh:bg.mtr", "size=bg.msh:h --target-of vertex"] {
        folder.line(&format!("in out --engine cpu --target {target} --report r.json")).clean();
        let report = folder.json("r.json");
        let (told, is_of_vertex) = (&report["target"], target.ends_with("vertex"));
        assert_eq!(told["of"], if is_of_vertex { "vertex" } else { "place" });
        assert_eq!(
            (&report["scheme"], &report["stop"]),
            (&"soft-size".into(), &"converged".into())
        );
        assert!(number(&told["f"][1]) < number(&told["f"][0]), "{told}");
        assert_smoothed(&folder.mesh("in.node"), &folder.mesh("out.node"));
        ends.push(folder.mesh("out.node").points);
    }
    assert_eq!(ends[0], ends[1]);
    assert_ne!(ends[0], ends[2]);
    // Equal sizes in a view of gmsh, and files with other content.
    let points = MeshFile::read(&folder.path("bg.msh")).unwrap().points().to_vec();
    let corners = |t: [usize; 3]| {
        let places = t.map(|v| format!("{:?},{:?},0", points[v][0], points[v][1])).join(", ");
        format!("ST({places}){{{}}};\n", t.map(|v| [1, 4, 4, 1][v].to_string()).join(","))
    };
    let elements = corners([0, 1, 2]) + &corners([0, 2, 3]);
    let view = format!("// sizes\nView \"h\" {{\nTIME{{0}};\n{elements}}};\n");
    fs::write(folder.path("bg.pos"), &view).unwrap();
    folder.line("in out --engine cpu --target size=bg.pos").clean();
    assert_eq!(folder.mesh("out.node").points, ends[0]);
    for (text, told) in [
        (
            view.replacen("ST", "SP", 1),
            "bad.pos:4: an element of kind `SP` is not read. Save the view",
        ),
        (view.replacen("{1,4,4}", "{1,x,4}", 1), "bad.pos:4: `x` is not a number"),
        (view.replacen("{1,4,4}", "{1,4}", 1), "bad.pos:4: 2 numbers where 3 are needed"),
        (view.replacen("{1,4,4}", "{1,-4,4}", 1), "its size is not positive"),
        (view.replace("};", ""), "is missing"),
        ("$PostFormat\n".to_owned(), "bad.pos:1: no view begins here"),
        ("View \"h\" {\n};\n".to_owned(), "bad.pos: the view has no triangles"),
    ] {
        fs::write(folder.path("bad.pos"), text).unwrap();
        folder.line("in out --engine cpu --target size=bad.pos").refused(&[told]);
    }
    let run = folder.line("in out --engine cpu --target metric=bg.pos");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["bg.pos: a view of gmsh holds sizes, not tensors: give size=bg.pos"]);
    let run = folder.line("in out --engine cpu --target size=half.msh:h");
    assert_holds(
        &run.err,
        &["vertices are outside of half.msh, by up to", "the target of the nearest point"],
    );
    // The sizes of the mesh itself at its original positions.
    folder.line("in out --engine cpu --target keep-size --target-of place").clean();
    for (target, parts) in [
        ("size=bg.msh:g", &["no point data is called 'g'"][..]),
        ("metric=bg.msh:h", &["numbers per vertex: 1, needed: 3"]),
        ("size=in.node:attribute", &["no point data is called 'attribute'"]),
    ] {
        folder.line(&format!("in out --engine cpu --target {target}")).refused(parts);
    }
    let run = folder.line("in out --engine cpu --target size=bg.msh:h --slide");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["--target-of place does not go with --slide", "--target-of vertex"]);
}
