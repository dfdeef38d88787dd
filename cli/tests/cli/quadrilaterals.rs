//! Meshes with quadrilaterals, whose vertices move, and stay by `--quadrilaterals keep`.

use super::{Folder, assert_holds};
use std::fmt::Write;

/// Returns a square of `n` times `n` cells as a legacy VTK file, with vertices inside displaced. `is_cut` tells which cells are
/// two triangles, and `region` numbers the material of a cell.
fn vtk(n: usize, is_cut: impl Fn(usize) -> bool, region: impl Fn(usize) -> usize) -> String {
    let mut text =
        String::from("# vtk DataFile Version 3.0\ncells\nASCII\nDATASET UNSTRUCTURED_GRID\n");
    writeln!(text, "POINTS {} double", (n + 1) * (n + 1)).unwrap();
    for v in 0..(n + 1) * (n + 1) {
        let (i, j) = (v % (n + 1), v / (n + 1));
        let is_inside = (1..n).contains(&i) && (1..n).contains(&j);
        let off = |k: f64| if is_inside { 0.3 * (k * v as f64).sin() } else { 0.0 };
        writeln!(text, "{} {} 0", i as f64 + off(1.7), j as f64 + off(2.9)).unwrap();
    }
    let (mut cells, mut types, mut materials) = (Vec::new(), String::new(), String::new());
    for k in 0..n * n {
        let a = k / n * (n + 1) + k % n;
        let [b, c, d] = [a + 1, a + n + 2, a + n + 1];
        match is_cut(k) {
            true => cells.extend([format!("3 {a} {b} {c}"), format!("3 {a} {c} {d}")]),
            false => cells.push(format!("4 {a} {b} {c} {d}")),
        }
        for _ in 0..if is_cut(k) { 2 } else { 1 } {
            types += if is_cut(k) { "5\n" } else { "9\n" };
            writeln!(materials, "{}", region(k)).unwrap();
        }
    }
    let numbers: usize = cells.iter().map(|cell| cell.split(' ').count()).sum();
    writeln!(text, "CELLS {} {numbers}\n{}", cells.len(), cells.join("\n")).unwrap();
    write!(text, "CELL_TYPES {}\n{types}CELL_DATA {}\n", cells.len(), cells.len()).unwrap();
    write!(text, "SCALARS MaterialIDs int 1\nLOOKUP_TABLE default\n{materials}").unwrap();
    text
}

#[test]
fn quadrilaterals_alone_move_and_are_refused_if_all_are_kept() {
    let folder = Folder::new(&[("in.vtk", &vtk(10, |_| false, |_| 1))]);
    let refused = folder.line("in.vtk out.vtk --engine cpu --quadrilaterals keep");
    refused.refused(&[
        "121 vertices and 100 quadrilaterals, but no triangle",
        "leave out --quadrilaterals keep",
    ]);
    let run = folder.line("in.vtk out.vtk --engine cpu --report r.json");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &["100 quadrilaterals, whose vertices may move"]);
    assert_holds(&run.out, &["121 vertices (81 free, 4 colors), 100 quadrilaterals", "1.00000"]);
    let report = folder.json("r.json");
    assert_eq!(report["mesh"]["quadrilaterals"], 100);
    let compared = folder.line("compare in.vtk out.vtk");
    assert_eq!(compared.code, Some(0), "{}", compared.err);
    assert_holds(
        &compared.out,
        &["81 of 121 vertices have moved", "each of 100 quadrilaterals is convex"],
    );
}

#[test]
fn vertices_of_mixed_meshes_move_or_stay_and_compare_knows() {
    let cut = |k: usize| k % 10 < 5;
    let folder = Folder::new(&[("in.vtk", &vtk(10, cut, |_| 1))]);
    folder.line("in.vtk kept.vtk --engine cpu --quiet --quadrilaterals keep").clean();
    folder.line("in.vtk moved.vtk --engine cpu --quiet --html p.html").clean();
    assert_holds(
        &folder.text("p.html"),
        &[
            "0 of 100 triangles are inverted or flat and 0 of 50 quadrilaterals are not convex, by exact",
            "All 100 triangles and 50 quadrilaterals.",
        ],
    );
    let kept = folder.line("compare in.vtk kept.vtk --quadrilaterals keep");
    assert_holds(&kept.out, &["36 of 121 vertices have moved", "none of 100 triangles"]);
    let moved = folder.line("compare in.vtk moved.vtk");
    assert_holds(
        &moved.out,
        &["81 of 121", "none of 100 triangles is inverted or flat, and each of 50"],
    );
    let unlike = folder.line("compare in.vtk moved.vtk --quadrilaterals keep");
    unlike.refused(&["45 vertices have moved that must not", "leave the option out here too"]);
}

#[test]
fn vertices_between_regions_of_quadrilaterals_stay() {
    let halves = |k: usize| usize::from(k % 10 < 5);
    for cut in [(|_| false) as fn(usize) -> bool, |k| k % 10 < 5, |k| k % 3 == 0] {
        let folder = Folder::new(&[("in.vtk", &vtk(10, cut, halves))]);
        let run = folder.line("in.vtk out.vtk --engine cpu --picture p.svg");
        assert_holds(&run.err, &["9 vertices between regions stay fixed"]);
        assert_holds(&folder.text("p.svg"), &[">between regions</text>"]);
        let compared = folder.line("compare in.vtk out.vtk");
        assert_holds(&compared.out, &["72 of 121 vertices have moved"]);
        let freed = folder.line("in.vtk free.vtk --engine cpu --free-interfaces");
        assert_eq!(freed.code, Some(0), "{}", freed.err);
        let compared = folder.line("compare in.vtk free.vtk --free-interfaces");
        assert_holds(&compared.out, &["81 of 121 vertices have moved"]);
    }
}

#[test]
fn groups_have_quadrilaterals_and_choose_which_vertices_move() {
    let halves = |k: usize| 1 + usize::from(k % 10 >= 5);
    for cut in [(|_| false) as fn(usize) -> bool, |k| k % 10 < 5] {
        let folder = Folder::new(&[("in.vtk", &vtk(10, cut, halves))]);
        let listed = folder.line("groups in.vtk --json");
        let told: serde_json::Value = serde_json::from_str(&listed.out).unwrap();
        assert_eq!(told["groups"][1]["quadrilaterals"], 50, "{told}");
        let run = folder.line("in.vtk out.vtk --engine cpu --only 2");
        assert_holds(&run.err, &["--only 2 (MaterialIDs surface 2): 36 of 72 free vertices"]);
        let compared = folder.line("compare in.vtk out.vtk --only 2");
        assert_holds(&compared.out, &["36 of 121 vertices have moved"]);
        // Vertices of quadrilaterals that stay let no vertex of such a group move.
        if cut(0) {
            let kept = folder.line("in.vtk out.vtk --only 2 --quadrilaterals keep --force");
            kept.refused(&["--only: MaterialIDs surface 2 has no triangles"]);
        }
    }
}

#[test]
fn a_quadrilateral_that_lists_a_vertex_twice_shifts_no_place() {
    // The second quadrilateral loses a vertex, and the last is the only one of its region.
    let text = vtk(4, |_| false, |k| 1 + usize::from(k == 15));
    let degenerate = text.replacen("\n4 1 2 7 6\n", "\n4 1 7 7 6\n", 1);
    assert_ne!(degenerate, text);
    let folder = Folder::new(&[("in.vtk", &degenerate)]);
    let quality = folder.line("quality in.vtk --by-region --json --worst 16");
    assert_eq!(quality.code, Some(0), "{}", quality.err);
    let told: serde_json::Value = serde_json::from_str(&quality.out).unwrap();
    let last = told["worst"].as_array().unwrap().iter();
    let last = last
        .map(|worst| worst["quadrilateral"].as_u64().unwrap_or_else(|| panic!("{worst}")))
        .max();
    assert_eq!((told["worst"].as_array().unwrap().len(), last), (15, Some(15)), "{told}");
    let counts: Vec<u64> = told["regions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|region| region["quadrilaterals"].as_u64().unwrap())
        .collect();
    assert_eq!(counts, [14, 1], "{told}");
}

#[test]
fn runs_continue_from_checkpoints_to_the_same_bits() {
    let folder = Folder::new(&[("in.vtk", &vtk(10, |k| k % 3 == 0, |_| 1))]);
    for engine in ["cpu", "gpu"] {
        let line = format!("in.vtk {engine}.vtk --engine {engine} --tolerance 0 --quiet");
        assert_eq!(folder.line(&format!("{line} --max-sweeps 12")).code, Some(0));
        let whole = folder.text(&format!("{engine}.vtk"));
        std::fs::remove_file(folder.path(&format!("{engine}.vtk"))).unwrap();
        let begun = format!(
            "{line} --max-sweeps 12 --time-limit 1e-9 --checkpoint c --checkpoint-every 1e-9"
        );
        assert_eq!(folder.line(&begun).code, Some(0));
        let run = folder.line(&format!("{line} --max-sweeps 12 --continue c"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_eq!(folder.text(&format!("{engine}.vtk")), whole, "{engine}");
    }
}

#[test]
fn a_concave_quadrilateral_is_refused_with_its_place() {
    let text = vtk(4, |_| false, |_| 1);
    let line = text.lines().nth(5 + 6).unwrap();
    let folder = Folder::new(&[("in.vtk", &text.replacen(line, "1.9 1.9 0", 1))]);
    let run = folder.line("in.vtk out.vtk --engine cpu --quiet");
    run.refused(&[
        "in.vtk:",
        "quadrilateral ",
        "is concave at vertex",
        "--untangle",
        "--quadrilaterals keep",
    ]);
    let line = "in.vtk out.vtk --engine cpu --quiet --untangle";
    assert_eq!(folder.line(line).code, Some(0));
    let compared = folder.line("compare in.vtk out.vtk");
    assert_holds(&compared.out, &["each of 16 quadrilaterals is convex"]);
}

/// Most quadrilaterals of the input are inverted, so their windings say nothing on those of the result.
#[test]
fn a_mirrored_mesh_is_untangled_and_reported() {
    let mut text = vtk(12, |_| false, |_| 1);
    for (v, line) in text.clone().lines().skip(5).take(13 * 13).enumerate() {
        let (i, j) = (v % 13, v / 13);
        if (1..12).contains(&i) && (1..12).contains(&j) {
            text = text.replacen(&format!("\n{line}\n"), &format!("\n{} {j} 0\n", 12 - i), 1);
        }
    }
    let folder = Folder::new(&[("in.vtk", &text)]);
    let run = folder.line("in.vtk out.vtk --engine cpu --untangle --report r.json");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_eq!(folder.json("r.json")["certificate"]["inverted"], 0);
    let compared = folder.line("compare in.vtk out.vtk");
    assert_holds(&compared.out, &["each of 144 quadrilaterals is convex"]);
}

#[test]
fn stages_for_quadrilaterals_work_from_the_command_line() {
    let folder = Folder::new(&[("in.vtk", &vtk(12, |k| k % 4 == 0, |_| 1))]);
    for options in [
        "--slide",
        "--only-bad 1.2 --rings 1",
        "--improve-worst",
        "--max-move 0.1",
        "--keep-altitude",
        "--target keep-size",
        "--target keep-shape",
        "--scheme acute",
        "--scheme edge+imr",
        "--fix-box 0,0,3,3",
        "--surface sphere",
        "--picture p.png",
        "--html p.html",
    ] {
        let run = folder.line(&format!("in.vtk out.vtk --force --engine cpu --quiet {options}"));
        assert_eq!(run.code, Some(0), "{options}: {}", run.err);
        let slide = if options == "--slide" { options } else { "" };
        let compared = folder.line(&format!("compare in.vtk out.vtk --quiet {slide}"));
        assert_eq!(compared.code, Some(0), "{options}: {}", compared.err);
    }
}

#[test]
fn pictures_color_quadrilaterals_that_move() {
    let folder = Folder::new(&[("in.vtk", &vtk(8, |k| k % 8 < 4, |_| 1))]);
    let line = "in.vtk out.vtk --force --engine cpu --quiet --picture p.svg";
    assert_eq!(folder.line(&format!("{line} --quadrilaterals keep")).code, Some(0));
    assert!(folder.text("p.svg").contains("fixed quadrilateral"));
    assert_eq!(folder.line(line).code, Some(0));
    let text = folder.text("p.svg");
    assert!(!text.contains("quadrilateral") && text.contains("96 elements"), "{}", &text[..2000]);
    let line = format!("{line} --picture-measure schism-skewness");
    assert_eq!(folder.line(&line).code, Some(0));
    assert_holds(&folder.text("p.svg"), &["quadrilateral", "worst elements"]);
}

#[test]
fn quality_measures_and_lists_quadrilaterals() {
    let cut = |k: usize| k % 8 < 4;
    let few = "name = 'few'\n[[limits]]\nquantity = 'neighbors'\nfail = '< 6'\nsource = 's'\n";
    let concave = vtk(4, |_| false, |k| k % 2).replacen("\n0 0 0\n", "\n1.5 1.5 0\n", 1);
    let folder = Folder::new(&[
        ("block.vtk", &vtk(8, |_| false, |_| 1)),
        ("mixed.vtk", &vtk(8, cut, |k| k % 2)),
        ("concave.vtk", &concave),
        ("few.toml", few),
        ("own.toml", "name = \"own\"\n\n[[limits]]\nquantity = \"min-angle\"\nwarn = \"< 30\"\n"),
    ]);
    // A mesh without triangles needs no option.
    let run = folder.line("quality block.vtk --worst 2 --html p.html --picture p.png");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(
        &run.out,
        &["81 vertices (49 free), 64 quadrilaterals", "75 to 80", "worst elements by shape"],
    );
    assert_holds(&run.out, &["  quadrilateral ", "med-aspect-frobenius", "inverted or concave"]);
    assert!(!run.out.contains("schism-skewness"), "{}", run.out);

    let run = folder.line("quality mixed.vtk --json --quadrilaterals keep");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&run.out).unwrap()["triangles"], 64);
    let line = "quality mixed.vtk --json --by-region --threshold shape<0.99";
    let run = folder.line(line);
    assert_eq!(run.code, Some(1));
    let told: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!((&told["triangles"], &told["quadrilaterals"]), (&64.into(), &32.into()));
    let regions = told["regions"].as_array().unwrap();
    let counts: Vec<[u64; 2]> = regions
        .iter()
        .map(|of| ["triangles", "quadrilaterals"].map(|kind| of[kind].as_u64().unwrap()))
        .collect();
    assert_eq!(counts, [[32, 16]; 2]);
    let threshold = &told["thresholds"][0];
    let violating = threshold["elements"].as_u64().unwrap();
    assert!((33..=96).contains(&violating), "{threshold}");
    // Both kinds are among the worst elements, each with its corners.
    let run = folder.line("quality mixed.vtk --json --worst 96");
    let told: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let corners = |key: &str, corners: usize| {
        let worst = told["worst"].as_array().unwrap().iter();
        let of_kind = worst.filter(|part| !part[key].is_null());
        of_kind.filter(|part| part["vertices"].as_array().unwrap().len() == corners).count()
    };
    assert_eq!([corners("triangle", 3), corners("quadrilateral", 4)], [64, 32]);

    // Each kind of elements has limits of its own, and a mesh of one kind has no line for the other.
    let run = folder.line("quality mixed.vtk --for fea --json");
    let told: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let limits = told["profile"]["limits"].as_array().unwrap();
    assert_eq!(limits.len(), 10);
    for (i, limit) in limits.iter().enumerate() {
        let [parts, part] = [["triangles", "triangle"], ["quadrilaterals", "quadrilateral"]][i / 5];
        assert_eq!(limit[parts], if i < 5 { 64 } else { 32 }, "{limit}");
        assert!(limit["worst"][part].is_u64(), "{limit}");
    }
    let run = folder.line("quality block.vtk --for fea");
    assert_holds(&run.out, &["min-angle of quadrilaterals", "quadrilateral "]);
    assert!(!run.out.contains("triangle ") && !run.out.contains("no verdict"), "{}", run.out);
    let run = folder.line("quality block.vtk --for own.toml");
    assert_holds(
        &run.out,
        &["the limits of elements are of triangles: 64 quadrilaterals have no verdict"],
    );
    // All limits of D-Flow FM are of edges and of holes.
    let run = folder.line("quality block.vtk --for dflowfm");
    assert_holds(&run.out, &["orthogonality", "hole-edges"]);
    assert!(!run.out.contains("no verdict"), "{}", run.out);
    // Each vertex inside of `block.vtk` is in four quadrilaterals.
    let run = folder.line("quality block.vtk --threshold neighbors>4 --threshold neighbors<4 -q");
    assert_eq!((run.code, run.out), (Some(0), String::new()));
    let run = folder.line("quality mixed.vtk --for few.toml");
    assert_eq!(run.code, Some(0), "{}", run.err);

    let run = folder.line("quality concave.vtk");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.out, &["quadrilateral ", "is concave at vertex "]);
}

/// Two former defects: `--lossy` wrote a mesh without elements, and a quadrilateral with a repeated vertex was said to move.
#[test]
fn quadrilaterals_that_cannot_be_written_or_moved_are_named() {
    let folder = Folder::new(&[("in.vtk", &vtk(4, |_| false, |_| 1))]);
    for args in ["in.vtk out.node --lossy --engine cpu", "convert in.vtk out.node --lossy"] {
        let refused = folder.line(args);
        refused.refused(&[
            "in.vtk: the mesh has quadrilaterals alone, and Triangle .node/.ele holds none",
        ]);
        assert!(!folder.path("out.node").exists());
    }
    let off = "OFF\n6 4 0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n1 1.1 0\n3 0 0\n\
               3 0 1 4\n3 1 2 4\n4 0 4 2 3\n4 1 5 2 5\n";
    let folder = Folder::new(&[("in.off", off)]);
    let run = folder.line("in.off out.off --engine cpu");
    assert_holds(&run.err, &["1 quadrilateral lists a vertex twice: its vertices stay fixed"]);
}

/// Meshes of quadrilaterals alone were compared by their vertices, as they have equal lists of triangles: none.
#[test]
fn meshes_with_other_quadrilaterals_are_neither_the_same_nor_replaced() {
    let whole = vtk(4, |_| false, |_| 1);
    let turned = whole.replacen("\n4 0 1 6 5\n", "\n4 6 1 0 5\n", 1);
    let other = whole.replacen("\n4 0 1 6 5\n", "\n4 0 1 6 7\n", 1);
    let folder = Folder::new(&[("a.vtk", &whole), ("turned.vtk", &turned), ("other.vtk", &other)]);
    for name in ["a", "turned", "other"] {
        folder.line(&format!("convert {name}.vtk {name}.vtu --quiet --lossy")).clean();
    }
    let same = folder.line("compare a.vtk turned.vtu");
    assert_eq!(same.code, Some(0), "{}", same.err);
    assert_holds(&same.out, &["the elements are the same: 0 of 25 vertices have moved"]);
    folder.line("compare a.vtk other.vtu").refused(&["the quadrilaterals are not the same"]);
    let before = folder.content();
    for line in ["a.vtk other.vtk", "convert a.vtk other.vtu --lossy", "a.vtk other.vtu --lossy"] {
        let told = ["holds another mesh than a.vtk: the vertices of its elements are others"];
        folder.line(line).refused(&told);
    }
    assert!(folder.content() == before);
    // A format without quadrilaterals has lost them.
    let mixed = vtk(4, |k| k < 8, |_| 1);
    std::fs::write(folder.path("mixed.vtk"), mixed).unwrap();
    folder.line("convert mixed.vtk mixed.slf --quiet --lossy").clean();
    folder.line("convert mixed.vtk mixed.slf --quiet --lossy").clean();
}

#[test]
fn measures_of_triangles_alone_have_no_value() {
    let folder = Folder::new(&[("q.vtk", &vtk(4, |_| false, |_| 1))]);
    let json = folder.line("quality q.vtk --json");
    let json: serde_json::Value = serde_json::from_str(&json.out).unwrap();
    let measures = json["measures"].as_object().unwrap();
    assert!(!measures.contains_key("schism-skewness") && measures["shape"]["min"].is_number());
    let csv = folder.line("quality q.vtk --csv").out;
    assert_holds(&csv, &["\nq.vtk,,schism-skewness,0,,,,,,,"]);
    folder.line("quality q.vtk q.vtk --html pages.html --quiet").clean();
    folder.line("quality q.vtk --html page.html --quiet").clean();
    for page in ["page.html", "pages.html"] {
        assert!(!folder.text(page).contains(">NaN<"), "{page}");
    }
}

#[test]
fn a_table_has_a_dash_for_a_measure_that_a_mesh_or_region_lacks() {
    let mixed = vtk(4, |k| k < 8, |k| 1 + k / 8);
    let folder = Folder::new(&[("q.vtk", &vtk(4, |_| false, |_| 1)), ("t.vtk", &mixed)]);
    let row = |text: &str, at: usize| -> Vec<String> {
        let mut rows = text.lines().skip_while(|line| !line.starts_with("schism-skewness"));
        let line = rows.nth(at).unwrap_or_else(|| panic!("{text}"));
        line.split_whitespace().map(str::to_owned).collect()
    };
    let table = folder.line("quality t.vtk q.vtk -m schism-skewness").out;
    assert_eq!(row(&table, 2)[1..], ["-"; 7], "{table}");
    let table = folder.line("quality t.vtk -m schism-skewness --by-region").out;
    assert!(!table.contains("NaN") && table.matches(" -").count() >= 7, "{table}");
    let json = folder.line("quality t.vtk --json --by-region").out;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let has = |k: usize| {
        json["regions"][k]["measures"].as_object().unwrap().contains_key("schism-skewness")
    };
    assert_eq!([has(0), has(1)], [true, false]);
}

/// A quadrilateral that lists a vertex twice is no element, and has no place among the elements.
#[test]
fn the_worst_quadrilaterals_have_their_own_corners() {
    let text = vtk(4, |_| false, |_| 1).replacen("\n4 0 1 6 5\n", "\n4 0 1 1 5\n", 1);
    let folder = Folder::new(&[("q.vtk", &text)]);
    let json = folder.line("quality q.vtk --json --worst 3");
    let json: serde_json::Value = serde_json::from_str(&json.out).unwrap();
    let points: Vec<Vec<f64>> = text
        .lines()
        .skip(5)
        .take(25)
        .map(|line| line.split(' ').take(2).map(|x| x.parse().unwrap()).collect())
        .collect();
    let worst = json["worst"].as_array().unwrap();
    assert_eq!(worst.len(), 3);
    for worst in worst {
        let vertices = worst["vertices"].as_array().unwrap().iter();
        let expected: Vec<&Vec<f64>> =
            vertices.map(|v| &points[v.as_u64().unwrap() as usize]).collect();
        assert_eq!(worst["corners"], serde_json::json!(expected), "{worst}");
    }
}

#[test]
fn a_rehearsal_counts_concave_quadrilaterals() {
    let text = vtk(4, |_| false, |_| 1);
    let line = text.lines().nth(5 + 6).unwrap();
    let folder = Folder::new(&[("in.vtk", &text.replacen(line, "1.9 1.9 0", 1))]);
    let run = folder.line("in.vtk out.vtk --engine cpu --untangle --dry-run");
    assert_holds(&run.out, &["2 inverted or concave quadrilaterals would be untangled first"]);
}

#[test]
fn the_heading_of_tried_runs_counts_triangles_and_quadrilaterals() {
    let folder = Folder::new(&[("in.vtk", &vtk(6, |k| k % 2 == 0, |_| 1))]);
    let run = folder.line("try in.vtk --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.out, &[" free), 36 triangles, 18 quadrilaterals\n"]);
}

/// The name of the measure is longer than the first column.
#[test]
fn numbers_stand_below_the_heads_of_their_columns() {
    let folder = Folder::new(&[("in.vtk", &vtk(6, |k| k % 2 == 0, |_| 1))]);
    let run = folder.line("quality in.vtk --measure med-aspect-frobenius,shape");
    let ends = |line: &str| -> Vec<usize> {
        let is_end = |(i, c): (usize, char)| c != ' ' && line[i + 1..].starts_with([' ', '\n']);
        line.char_indices().filter(|&at| is_end(at)).map(|(i, _)| i).collect()
    };
    let mut lines = run.out.split_inclusive('\n').skip_while(|line| !line.starts_with("   "));
    let head = lines.next().unwrap();
    // The words `5 %` and `95 %` each have two ends.
    let heads: Vec<usize> =
        ends(head).into_iter().filter(|&i| !head[i + 1..].starts_with(" %")).collect();
    let rows: Vec<Vec<usize>> = lines
        .map(ends)
        .take_while(|ends| !ends.is_empty())
        .filter(|ends| ends.len() >= 7)
        .collect();
    assert_eq!(rows.len(), 2, "{}", run.out);
    for row in rows {
        assert_eq!(row[row.len() - 7..], heads, "{}", run.out);
    }
}
