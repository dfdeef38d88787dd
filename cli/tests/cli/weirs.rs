//! Weirs of ADCIRC (`--slide`): vertices that face each other across a weir stay opposite.

use super::{Folder, assert_holds};

/// x of the columns of vertices on both banks.
const X: [f64; 9] = [0.0, 0.6, 1.1, 1.6, 2.4, 2.7, 3.2, 3.5, 4.0];

/// Returns a grid of two blocks of 9 by 3 vertices. The upper side of the first block and the lower side of the second
/// are the banks of a weir. `bank` moves the vertices of the second bank up.
fn grid(kind: u32, bank: impl Fn(usize) -> f64) -> String {
    let mut nodes = String::new();
    for v in 0..54 {
        let (row, column) = (v / 9, v % 9);
        let gap = if row < 3 { 0.0 } else { 0.2 } + if row == 3 { bank(column) } else { 0.0 };
        let y = 0.5 * (row - row / 3) as f64 + gap;
        nodes += &format!("{} {} {y} 1\n", v + 1, X[column]);
    }
    let mut elements = String::new();
    for (k, cell) in (0..32).enumerate() {
        let a = cell / 8 * 9 + cell / 16 * 9 + cell % 8 + 1;
        elements += &format!("{} 3 {a} {} {}\n", 2 * k + 1, a + 1, a + 10);
        elements += &format!("{} 3 {a} {} {}\n", 2 * k + 2, a + 10, a + 9);
    }
    let rows: String = (19..28).map(|v| format!("{v} {} 1.5 1.0 1.0\n", v + 9)).collect();
    format!("weir\n64 54\n{nodes}{elements}0\n0\n1\n18\n9 {kind}\n{rows}")
}

#[test]
fn pairs_across_a_weir_of_parallel_banks_slide_together() {
    let folder = Folder::new(&[]);
    for kind in [4, 24, 5, 25, 64] {
        std::fs::write(folder.path("in.14"), grid(kind, |_| 0.0)).unwrap();
        let run = folder.line("in.14 out.14 --engine cpu --slide --report r.json");
        assert_eq!(run.code, Some(0), "{}", run.err);
        let told = "14 of them in 7 pairs across weirs; 2 pairs across weirs stay, at corners";
        assert_holds(&run.err, &[told]);
        assert_holds(&run.out, &["7 pairs across weirs together"]);
        assert_eq!(folder.json("r.json")["slid"]["pairs"], 7);
        let [before, after] = ["in.14", "out.14"].map(|name| folder.mesh(name).points);
        assert!((19..26).all(|v| before[v] != after[v]), "{kind}");
        for v in 18..27 {
            let ([x, y], [a, b]) = (after[v], after[v + 9]);
            assert!((x - a).abs() < 1e-12 && (b - y - 0.2).abs() < 1e-12, "{kind}, {v}");
        }
        let compared = folder.line("compare in.14 out.14 --slide").clean();
        assert_holds(&compared.out, &["7 pairs across weirs of them together"]);
    }
}

#[test]
fn pairs_across_a_weir_stay_where_its_banks_are_not_parallel() {
    // The second bank rises from the fifth column on.
    let bank = |column: usize| 0.05 * (X[column] - X[4]).max(0.0);
    let folder = Folder::new(&[("in.14", &grid(24, bank))]);
    let run = folder.line("in.14 out.14 --engine cpu --slide");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &["6 of them in 3 pairs across weirs; 6 pairs across weirs stay"]);
    let [before, after] = ["in.14", "out.14"].map(|name| folder.mesh(name).points);
    for v in 18..36 {
        assert_eq!(before[v] != after[v], (1..=3).contains(&(v % 9)), "{v}");
    }
    folder.line("compare in.14 out.14 --slide").clean();
}

#[test]
fn both_banks_of_a_weir_are_fixed_by_the_name_of_its_boundary() {
    let folder = Folder::new(&[("in.14", &grid(24, |_| 0.0))]);
    let run = folder.line("in.14 out.14 --engine cpu --slide --fix land1");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &["18 vertices stay fixed; 14 of them would slide"]);
    let [before, after] = ["in.14", "out.14"].map(|name| folder.mesh(name).points);
    assert!((18..36).all(|v| before[v] == after[v]));
    folder.line("compare in.14 out.14 --slide --fix land1 -q").clean();
    let mixed = folder.line("in.14 mixed.14 --engine cpu --slide --fix-box -1,0.4,1,1.1");
    assert_holds(
        &mixed.err,
        &["4 vertices stay fixed; 1 of them would be free, and 2 would slide"],
    );
    let without = folder.line("in.14 without.14 --engine cpu --fix land1");
    assert_holds(&without.err, &["18 vertices stay fixed; none of them was free before"]);
}

#[test]
fn required_edges_of_medit_stay_where_others_slide() {
    let x = [0.0, 0.15, 0.3, 0.45, 0.62, 0.7, 0.8, 0.9, 1.0];
    let points: String = (0..27).map(|v| format!("{} {} 0\n", x[v % 9], v / 9)).collect();
    let triangles: String = (0..16)
        .map(|cell| {
            let a = cell / 8 * 9 + cell % 8 + 1;
            format!("{a} {} {} 1\n{a} {} {} 1\n", a + 1, a + 10, a + 10, a + 9)
        })
        .collect();
    let edges: String = (1..9).map(|v| format!("{v} {} 1\n", v + 1)).collect();
    for list in ["RequiredEdges", "Ridges"] {
        let text = format!(
            "MeshVersionFormatted 2\nDimension 2\nVertices\n27\n{points}Edges\n8\n{edges}\
             Triangles\n32\n{triangles}{list}\n1\n5\nEnd\n"
        );
        let folder = Folder::new(&[("in.mesh", &text)]);
        let run = folder.line("in.mesh out.mesh --engine cpu --slide");
        assert_eq!(run.code, Some(0), "{}", run.err);
        let [before, after] = ["in.mesh", "out.mesh"].map(|name| folder.mesh(name).points);
        for v in 1..8 {
            assert_eq!(before[v] == after[v], v == 4 || v == 5, "{list} {v}");
        }
        folder.line("compare in.mesh out.mesh --slide -q").clean();
    }
}
