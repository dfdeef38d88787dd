//! Ends of groups (`--slide`): a vertex at which a group of the boundary ends stays, so that the group keeps its extent.

use super::{Folder, assert_holds};

/// x of the vertices at the bottom of the square. The inlet ends and the wall begins at the vertex 4.
const X: [f64; 9] = [0.0, 0.15, 0.3, 0.45, 0.62, 0.7, 0.8, 0.9, 1.0];

/// Returns the vertices of a unit square: five rows of nine.
fn points() -> impl Iterator<Item = (usize, f64, f64)> {
    (0..45).map(|v| (v, X[v % 9], 0.25 * (v / 9) as f64))
}

fn triangles() -> impl Iterator<Item = [usize; 3]> {
    (0..32).flat_map(|cell| {
        let a = cell / 8 * 9 + cell % 8;
        [[a, a + 1, a + 10], [a, a + 10, a + 9]]
    })
}

/// The square as a file of SU2, of whose bottom the marker `inlet` has the first `edges` edges, and `wall` the rest.
fn su2(edges: usize) -> String {
    let points: String = points().map(|(_, x, y)| format!("{x} {y}\n")).collect();
    let triangles: String = triangles().map(|[a, b, c]| format!("5 {a} {b} {c}\n")).collect();
    let marker = |name: &str, from: usize, to: usize| {
        let lines: String = (from..to).map(|a| format!("3 {a} {}\n", a + 1)).collect();
        format!("MARKER_TAG= {name}\nMARKER_ELEMS= {}\n{lines}", to - from)
    };
    let (inlet, wall) = (marker("inlet", 0, edges), marker("wall", edges, 8));
    format!("NDIME= 2\nNELEM= 64\n{triangles}NPOIN= 45\n{points}NMARK= 2\n{inlet}{wall}")
}

/// The square as a mesh of MIKE, whose codes are 2 up to the vertex 4 and 1 on the rest of the boundary.
fn mike() -> String {
    let code = |v: usize, y: f64| match v {
        0..=4 => 2,
        _ if v.is_multiple_of(9) || v % 9 == 8 || y == 0.0 || y == 1.0 => 1,
        _ => 0,
    };
    let row = |(v, x, y)| format!("{} {x} {y} -5 {}\n", v + 1, code(v, y));
    let points: String = points().map(row).collect();
    let element =
        |(k, [a, b, c]): (usize, [usize; 3])| format!("{} {} {} {}\n", k + 1, a + 1, b + 1, c + 1);
    let elements: String = triangles().enumerate().map(element).collect();
    format!("45 LONG/LAT\n{points}64 3 21\n{elements}")
}

#[test]
fn a_vertex_where_groups_meet_stays_and_is_counted() {
    let folder = Folder::new(&[("in.su2", &su2(4)), ("all.su2", &su2(8)), ("in.mesh", &mike())]);
    for (mesh, held, told) in [
        ("in.su2", &[4][..], "1 vertex stays as an end of groups"),
        // No code has the edges from 4 to 5 and from 0 to 9.
        ("in.mesh", &[4, 5, 9], "3 vertices stay as ends of groups"),
    ] {
        let out = format!("out-{mesh}");
        let line = format!("{mesh} {out} --engine cpu --slide --report r.json");
        let run = folder.line(&line);
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.out, &[told]);
        assert_holds(&run.err, &[told]);
        assert_eq!(folder.json("r.json")["slid"]["ends"], held.len());
        let [before, after] = [mesh, &out].map(|name| folder.mesh(name).points);
        for v in (1..8_usize).chain([9, 18, 27]) {
            assert_eq!(before[v] == after[v], held.contains(&v), "{mesh}: {v}");
        }
        folder.line(&format!("compare {mesh} {out} --slide")).clean();
    }
    // A file in which the end of the inlet has moved, as a run on one marker moves the vertex.
    let run = folder.line("all.su2 moved.su2 --engine cpu --slide");
    assert!(!run.out.contains("of groups") && !run.err.contains("of groups"), "{}", run.err);
    let moved = folder.text("moved.su2").lines().take(112).collect::<Vec<_>>().join("\n");
    let markers = su2(4).lines().skip(112).collect::<Vec<_>>().join("\n");
    std::fs::write(folder.path("moved.su2"), format!("{moved}\n{markers}\n")).unwrap();
    folder
        .line("compare in.su2 moved.su2 --slide")
        .refused(&["1 vertex has moved that must not", "vertex 4"]);
}
