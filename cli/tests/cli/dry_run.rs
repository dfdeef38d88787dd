//! `--dry-run`: the facts before a run, and no file.

use super::output::INVERTED;
use super::{Folder, assert_holds, small};
use gpu_smooth::Topology;
use std::fs;

/// Returns the count at the start of the line that contains `words`.
#[track_caller]
pub(super) fn count(text: &str, words: &str) -> usize {
    let line = text.lines().find(|line| line.contains(words));
    let line = line.unwrap_or_else(|| panic!("no {words:?} in:\n{text}"));
    line.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn a_dry_run_counts_vertices_and_writes_nothing() {
    let folder = small();
    let before = folder.content();
    let line = "in out --dry-run --engine cpu --report r.json --html p.html --picture p.png";
    let text = folder.line(line).clean().out;
    assert_eq!(folder.content(), before);
    let mesh = folder.mesh("in");
    let topology = Topology::new(&mesh).unwrap();
    let free = topology.free_count();
    assert_holds(
        &text,
        &["99 vertices, 160 triangles", "scheme imr, target equilateral, on the CPU"],
    );
    assert_holds(&text, &[&format!("up to {free} vertices would move\n")]);
    assert_eq!(count(&text, "on the boundary (--slide"), 99 - free);
    assert_holds(&text, &["would write out, r.json, p.png, p.html\n", "nothing was written"]);
    // Then the run itself writes the files that were named.
    folder.line(&line.replace("--dry-run ", "")).clean();
    for name in ["out.node", "r.json", "p.png", "p.html"] {
        assert!(folder.path(name).is_file(), "{name}");
    }
    let text = folder.line("in slid --dry-run --engine cpu --slide");
    folder.line("in slid --engine cpu --slide --report slid.json");
    let sliding = folder.json("slid.json")["slid"]["vertices"].clone();
    let told = format!("up to {free} vertices would move, and up to {sliding} would slide");
    assert_holds(&text.out, &[&told, &format!("{} on the boundary\n", 99 - free)]);
}

#[test]
fn a_dry_run_has_the_reason_of_each_fixed_vertex() {
    let mesh = super::disturbed();
    let regions: Vec<[i32; 2]> = (0..160).map(|t| if t < 60 { [4, 7] } else { [2, 7] }).collect();
    let folder = Folder::new(&[]);
    for (name, bytes) in &support::write_regions(&mesh, &regions)[1] {
        fs::write(folder.path(name), bytes).unwrap();
    }
    let topology = Topology::new(&mesh).unwrap();
    // A vertex on the boundary, and two in one region. The file counts vertices from 1.
    let is_inside =
        |v: &u32| topology.free()[*v as usize] && topology.star(*v).iter().all(|&t| t >= 60);
    let inside = (0..99).filter(is_inside).take(2).map(|v| format!("{}\n", v + 1));
    fs::write(folder.path("list"), format!("1\n{}", inside.collect::<String>())).unwrap();
    let run =
        |options: &str| folder.line(&format!("in.msh out.msh --dry-run --engine cpu {options}"));
    let (plain, fixed) = (run("").out, run("--fix-vertices list").out);
    let between = count(&plain, "between regions (--free-interfaces");
    assert!(between > 0 && !plain.contains("by options"), "{plain}");
    let counts = [count(&plain, "on the boundary"), between];
    let held = counts.iter().sum::<usize>();
    assert_eq!(counts[0], 99 - topology.free_count());
    assert_eq!(count(&plain, "vertices are not free:"), held);
    assert_holds(&plain, &[&format!("up to {} vertices would move\n", 99 - held)]);
    assert_eq!(count(&fixed, "by options such as --fix"), 2);
    assert!(!run("--free-interfaces").out.contains("between regions"));
}

#[test]
fn a_dry_run_fails_where_the_run_would_fail() {
    let [node, ele] = INVERTED;
    let folder = Folder::new(&[("in.node", node), ("in.ele", ele)]);
    let before = folder.content();
    let line = "in out --dry-run --engine cpu";
    folder.line(&format!("{line} --report r.json")).refused(&["inverted", "--untangle"]);
    let text = folder.line(&format!("{line} --untangle")).clean().out;
    assert_holds(&text, &["1 inverted or flat triangle would be untangled first"]);
    folder.line("in none/out --dry-run").refused(&["none"]);
    folder.line("in in.ele --dry-run --untangle").refused(&["in.ele"]);
    assert_eq!(folder.content(), before);
    let run = folder.line("in --out-dir d --dry-run");
    assert_eq!(run.code, Some(2), "{}", run.err);
}
