//! The command `gpu-smooth try`: its rows are those of runs, and the best row suits the mesh.

use super::output::INVERTED;
use super::report::right_triangles;
use super::untangle::tangled;
use super::{Folder, assert_holds, number, small};
use serde_json::Value;
use support::SplitMix64;

fn tried(folder: &Folder, line: &str) -> Value {
    let run = folder.line(&format!("try {line} --json --engine cpu"));
    assert_eq!(run.code, Some(0), "{}", run.err);
    serde_json::from_str(&run.out).unwrap()
}

/// Returns the options of the best row, and checks that exactly one row is the best.
#[track_caller]
fn best(tried: &Value) -> Vec<&str> {
    let rows = tried["runs"].as_array().unwrap().iter();
    let best: Vec<_> = rows.filter(|row| row["best"] == true).collect();
    assert_eq!(best.len(), 1, "{tried}");
    assert_eq!(tried["command"], best[0]["command"]);
    best[0]["options"].as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect()
}

#[test]
fn rows_have_the_values_of_runs_and_no_file_is_written() {
    let folder = small();
    let before = folder.content();
    let tried = tried(&folder, "in.node --slide --fix-box -1,-1,0.5,0.5");
    let text = folder.line("try in.node --slide --fix-box -1,-1,0.5,0.5 --engine cpu");
    assert_eq!(folder.content(), before);
    let rows = tried["runs"].as_array().unwrap();
    assert_eq!(rows.len(), 9);
    for (i, row) in rows.iter().enumerate() {
        let command = row["command"].as_str().unwrap();
        let line = command.strip_prefix("gpu-smooth ").unwrap();
        assert!(line.starts_with("in.node in-smooth.node"), "{line}");
        assert_holds(line, &["--slide", "--fix-box=-1,-1,0.5,0.5", "--engine cpu"]);
        let run = folder.line(&format!("{line} --report {i}.json"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let report = folder.json(&format!("{i}.json"));
        for key in ["after", "change", "sweeps", "stop"] {
            assert_eq!(report[key], row[key], "{key} of {line}");
        }
        assert_eq!(report["before"], tried["before"]);
        let options: Vec<_> =
            row["options"].as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
        let label = if i == 0 { "without options".to_owned() } else { options.join(" ") };
        let mark = if row["best"] == true { "*" } else { " " };
        let shown =
            text.out.lines().find_map(|line| line.strip_prefix(&format!("{mark} {label}  ")));
        let shown = shown.unwrap_or_else(|| panic!("no row {mark} {label}:\n{}", text.out));
        let angle = format!("{:.2}°", number(&row["after"]["min_angle"]));
        let moved = format!("{:.2}", number(&row["change"]["moved"]["p95"]));
        assert_holds(shown, &[&angle, &moved]);
    }
    assert_holds(&text.out, &["* the best row: "]);
    assert_eq!(text.out.lines().last(), tried["command"].as_str());
}

/// A mesh of rows that grow from a wall, each vertex moved by up to a quarter of its row: a boundary layer.
fn layer() -> (String, String) {
    let mut random = SplitMix64::new(3);
    let heights: Vec<f64> = (0..24).map(|row| 0.04 * (1.15f64.powi(row) - 1.0)).collect();
    let (mut node, mut ele) = ("504 2 0 0\n".to_owned(), "920 3 0\n".to_owned());
    for (j, &y) in heights.iter().enumerate() {
        for i in 0..21 {
            let is_inside = (1..20).contains(&i) && (1..23).contains(&j);
            let mut shift = |size: f64| if is_inside { size * (random.unit() - 0.5) } else { 0.0 };
            let (dx, dy) = (shift(0.05), shift(0.5 * (y - heights[j.saturating_sub(1)])));
            let (x, y) = (0.1 * f64::from(i) + dx, y + dy);
            node += &format!("{} {x} {y}\n", 21 * j + i as usize + 1);
        }
    }
    for t in 0..460 {
        let a = t / 20 * 21 + t % 20 + 1;
        ele += &format!("{} {a} {} {}\n", 2 * t + 1, a + 1, a + 22);
        ele += &format!("{} {a} {} {}\n", 2 * t + 2, a + 22, a + 21);
    }
    (node, ele)
}

#[test]
fn the_best_row_keeps_a_boundary_layer_and_improves_an_even_mesh() {
    let (node, ele) = layer();
    let folder = Folder::new(&[("layer.node", &node), ("layer.ele", &ele)]);
    let tried_layer = tried(&folder, "layer");
    let options = best(&tried_layer);
    assert_eq!(options[..2], ["--target", "keep-shape"], "{tried_layer:#}");
    // An even lattice, slightly disturbed.
    let mesh = support::perturb_random(&support::lattice(12, 10), 0.3, 7);
    let [node, ele] = support::triangle_text(&mesh, "made for a test");
    let folder = Folder::new(&[("even.node", &node), ("even.ele", &ele)]);
    let tried_even = tried(&folder, "even");
    assert_eq!(tried_even["runs"][0]["keeps_mesh"], true, "{tried_even:#}");
    assert!(!best(&tried_even).contains(&"keep-shape"), "{tried_even:#}");
}

#[test]
fn no_row_is_marked_where_every_run_makes_an_angle_sharper_or_moves_nothing() {
    let [node, ele] = right_triangles();
    let folder = Folder::new(&[("right.node", &node), ("right.ele", &ele)]);
    let tried = tried(&folder, "right");
    let rows = tried["runs"].as_array().unwrap();
    for row in rows {
        let [before, after] = [&tried["before"], &row["after"]];
        let is_sharper = number(&after["min_angle"]) < number(&before["min_angle"]);
        assert!(is_sharper || after["f"] == before["f"], "{row:#}");
        assert_eq!(row["best"], false);
    }
    assert!(rows.iter().any(|row| number(&row["after"]["min_angle"]) < 44.0), "{tried:#}");
    assert_eq!(tried["command"], Value::Null);
    let text = folder.line("try right --engine cpu").out;
    assert_holds(&text, &["no row helps: "]);
    assert!(!text.contains('*'), "{text}");
}

#[test]
fn the_best_row_for_a_solver_has_the_fewest_parts_beyond_its_limits() {
    let folder = small();
    let tried = tried(&folder, "in.node --for dflowfm");
    let counts = |profile: &Value| {
        let limits = profile["limits"].as_array().unwrap().iter();
        limits.fold([0, 0], |[failed, warned], limit| {
            let count = |key: &str| limit[key].as_u64().unwrap();
            [failed + count("failed"), warned + count("warned")]
        })
    };
    let rows = tried["runs"].as_array().unwrap();
    assert_eq!(rows.len(), 11);
    let options = best(&tried);
    let of_best = counts(&rows.iter().find(|row| row["best"] == true).unwrap()["profile"]);
    for row in rows {
        let [failed, warned] = counts(&row["profile"]);
        assert!(
            of_best[0] < failed || of_best[0] == failed && of_best[1] as f64 <= 1.1 * warned as f64,
            "{row:#}"
        );
    }
    assert!(counts(&tried["profile"]) > of_best, "{options:?}");
    let command = tried["command"].as_str().unwrap();
    assert_holds(command, &["--for dflowfm"]);
    assert_holds(
        tried["rule"].as_str().unwrap(),
        &["with the fewest failed and about the fewest warned (within 10 %)"],
    );
    // The command of the best row gives the counts of the row.
    folder
        .line(&format!("{} --report r.json", command.strip_prefix("gpu-smooth ").unwrap()))
        .clean();
    assert_eq!(counts(&folder.json("r.json")["profile"]["after"]), of_best);
    let text = folder.line("try in.node --for dflowfm --engine cpu").clean().out;
    assert_holds(
        &text,
        &[
            "failed  warned ",
            "beyond the limits of dflowfm\n",
            " with the fewest failed and about the fewest warned (within 10 %)",
        ],
    );
    let row = text.lines().find(|line| line.starts_with("* ")).unwrap();
    let words: Vec<&str> = row.split_whitespace().skip(1 + options.len().max(1)).collect();
    let skipped = if options.is_empty() { 1 } else { 0 };
    assert_eq!(words[skipped..skipped + 2], of_best.map(|count| count.to_string()));
    folder.line("try in.node --for none.toml").refused(&["none.toml: "]);
}

#[test]
fn a_mesh_without_bad_triangles_is_not_tried_and_is_no_error() {
    let folder = small();
    let nothing = "no triangle has an imr above 1000";
    let run = folder.line("try in --only-bad 1000 --engine cpu").clean();
    assert_holds(&run.out, &["in: nothing to do: ", nothing]);
    let tried = tried(&folder, "in --only-bad 1000");
    assert_holds(tried["nothing_to_do"].as_str().unwrap(), &[nothing]);
    assert_eq!((&tried["runs"], &tried["command"]), (&Value::Array(Vec::new()), &Value::Null));
}

#[test]
fn a_mesh_that_no_run_can_smooth_is_refused_once() {
    let [node, ele] = INVERTED;
    let folder = Folder::new(&[("in.node", node), ("in.ele", ele)]);
    folder.line("try in --engine cpu").refused(&["inverted", "--untangle"]);
    let [node, ele] = support::triangle_text(&tangled(), "tangled");
    let many = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    many.line("try in --engine cpu").refused(&["more; gpu-smooth quality --json lists all"]);
    folder.line("try none").refused(&["none"]);
    folder.line("try -").misused(&["standard input", "Name a file"]);
    let run = folder.line("try in --max-move 0.5 --untangle");
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
    assert_holds(&run.err, &["--max-move", "--untangle"]);
    let run = folder.line("try in --keep-altitude --untangle");
    assert_holds(&run.err, &["--keep-altitude", "--untangle"]);
}
