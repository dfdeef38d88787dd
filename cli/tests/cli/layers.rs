//! Boundary layers that stay, by `--keep-layers`.

use crate::{Folder, assert_holds, number};
use std::fmt::Write;

const COLUMNS: usize = 24;
const ROWS: usize = 10;

/// Returns a mesh on a flat wall with a layer of ten rows, as an SU2 file with the markers `wall` and `far`, and its points.
/// `beyond` is the number of rows above the layer.
fn layer(beyond: usize) -> (String, Vec<[f64; 2]>) {
    let mut heights = vec![0.0];
    for row in 0..ROWS + beyond {
        let step = if row < ROWS { 0.05 * 1.3_f64.powi(row as i32) } else { 1.1 };
        heights.push(heights[row] + step);
    }
    let last = heights.len() - 1;
    let mut points = Vec::new();
    for (k, height) in heights.iter().enumerate() {
        for i in 0..=COLUMNS {
            let is_free = 0 < i && i < COLUMNS && ROWS < k && k < last;
            let noise = if is_free { 0.2 * ((7 * i + 3 * k) as f64).sin() } else { 0.0 };
            points.push([i as f64 + noise, height - noise]);
        }
    }
    let at = |i: usize, k: usize| k * (COLUMNS + 1) + i;
    let mut triangles = Vec::new();
    for (k, i) in (0..last).flat_map(|k| (0..COLUMNS).map(move |i| (k, i))) {
        let [p, q, r, s] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
        triangles.extend(match (i + k) % 2 == 0 {
            true => [[p, q, r], [p, r, s]],
            false => [[p, q, s], [q, r, s]],
        });
    }
    let wall: Vec<_> = (0..COLUMNS).map(|i| [at(i, 0), at(i + 1, 0)]).collect();
    let mut far: Vec<_> = (0..COLUMNS).map(|i| [at(i, last), at(i + 1, last)]).collect();
    far.extend((0..last).flat_map(|k| [0, COLUMNS].map(|i| [at(i, k), at(i, k + 1)])));
    let mut text = format!("NDIME= 2\nNELEM= {}\n", triangles.len());
    triangles.iter().for_each(|[a, b, c]| writeln!(text, "5 {a} {b} {c}").unwrap());
    writeln!(text, "NPOIN= {}", points.len()).unwrap();
    points.iter().for_each(|[x, y]| writeln!(text, "{x} {y}").unwrap());
    text += "NMARK= 2\n";
    for (name, edges) in [("wall", wall), ("far", far)] {
        writeln!(text, "MARKER_TAG= {name}\nMARKER_ELEMS= {}", edges.len()).unwrap();
        edges.iter().for_each(|[a, b]| writeln!(text, "3 {a} {b}").unwrap());
    }
    (text, points)
}

/// Returns the numbers of the vertices that `is_in` holds for, a line each.
fn numbers(points: &[[f64; 2]], is_in: impl Fn([f64; 2]) -> bool) -> String {
    let found = points.iter().enumerate().filter(|(_, p)| is_in(**p));
    found.map(|(v, _)| format!("{v}\n")).collect()
}

#[test]
fn a_layer_stays_as_if_its_vertices_were_listed() {
    let (mesh, points) = layer(8);
    let height = points[ROWS * (COLUMNS + 1)][1];
    let all = numbers(&points, |[_, y]| y <= height);
    let three = numbers(&points, |[_, y]| y <= points[3 * (COLUMNS + 1)][1]);
    let near = numbers(&points, |[_, y]| y <= 0.4);
    let files = [("in.su2", &*mesh), ("all", &*all), ("three", &*three), ("near", &*near)];
    let folder = Folder::new(&files);
    let out = |args: &str| {
        let run = folder.line(&format!("in.su2 out.su2 --force --engine cpu {args}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        (run.err, folder.mesh("out.su2").points)
    };
    let kinds = [
        ("", "all", ""),
        ("", "all", "--target keep-shape"),
        ("", "all", "--slide --improve-worst"),
        ("--keep-layers auto,wall", "all", ""),
        ("--keep-layers rows=3", "three", ""),
        ("--keep-layers rows=3,wall", "three", "--only-bad 1.05"),
        ("--keep-layers within=0.4,wall", "near", ""),
    ];
    let free = out("--keep-layers none").1;
    for (keep, list, others) in kinds {
        let (notes, kept) = out(&format!("{keep} {others}"));
        let listed = out(&format!("--keep-layers none --fix-vertices {list} {others}")).1;
        assert!(kept == listed, "{keep} {others}");
        assert!(kept != points && kept != free);
        assert_holds(&notes, &["layers: ", "wall stay (--keep-layers none lets them move)"]);
    }
    let count = 23 * ROWS;
    assert_holds(&out("").0, &[&format!("layers: {count} vertices in {ROWS} rows at wall stay")]);
}

#[test]
fn the_spacing_at_walls_is_stated_before_and_after() {
    let (mesh, points) = layer(8);
    let folder = Folder::new(&[("in.su2", &*mesh)]);
    let run = |args: &str| {
        let line =
            format!("in.su2 out.su2 --force --engine cpu --report r.json --html p.html {args}");
        let run = folder.line(&line);
        assert_eq!(run.code, Some(0), "{}", run.err);
        let walls = folder.json("r.json")["spacing"].as_array().unwrap().clone();
        assert_eq!(walls.iter().map(|wall| &wall["wall"]).collect::<Vec<_>>(), ["wall", "far"]);
        assert_eq!([&walls[0]["flat"], &walls[1]["flat"]], [true, false]);
        assert!(!run.out.contains("spacing at far"));
        let page = std::fs::read_to_string(folder.path("p.html")).unwrap();
        let line = run.out.lines().find(|line| line.starts_with("spacing at wall: ")).unwrap();
        assert!(page.contains(line), "{line}");
        (walls[0].clone(), line.to_owned())
    };
    let (wall, line) = run("");
    assert_eq!((&wall["count"], &wall["changed"]), (&23.into(), &0.0.into()));
    assert_eq!(wall["ratios"], serde_json::json!([1.0, 1.0, 1.0]));
    assert_eq!(number(&wall["medians"][1]), points[COLUMNS + 1][1]);
    assert_holds(
        &line,
        &["0.050000 before, 0.050000 after (median of 23 vertices)", "1.000 (most); 0 %"],
    );
    let (wall, line) = run("--keep-layers none");
    let most = number(&wall["ratios"][2]);
    assert!(most > 2.0 && number(&wall["changed"]) > 0.9, "{wall}");
    // The first row is that of the file, as the wall does not move.
    let after = folder.mesh("out.su2").points;
    let heights = (1..COLUMNS).map(|i| after[COLUMNS + 1 + i][1] / 0.05).fold(0.0, f64::max);
    assert!((most - heights).abs() < 1e-9 * heights, "{most} {heights}");
    assert_holds(&line, &[&format!("{most:.3} (most)")]);
    let tried = folder.line("try in.su2 --engine cpu --keep-layers none");
    assert_holds(&tried.out, &["max angle", "spacing", &format!("{most:.1} times")]);
}

#[test]
fn vertices_beside_kept_rows_do_not_slide() {
    let (mesh, points) = layer(8);
    let folder = Folder::new(&[("in.su2", &*mesh)]);
    let run = folder.line("in.su2 out.su2 --engine cpu --slide");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let after = folder.mesh("out.su2").points;
    let in_layer = (ROWS + 1) * (COLUMNS + 1);
    assert_eq!(after[..in_layer], points[..in_layer]);
    let is_side = |v: &usize| [0, COLUMNS].contains(&(v % (COLUMNS + 1)));
    let slid = (in_layer..points.len()).filter(is_side).filter(|&v| after[v] != points[v]);
    assert!(slid.count() > 8);
}

/// A former defect: the command took the whole boundary for curves, and found vertices beside their curves.
#[test]
fn compare_with_slide_keeps_layers_as_a_run_does() {
    let (mesh, points) = layer(8);
    // The sides of the mesh are curved.
    let height = points.last().unwrap()[1];
    let columns = COLUMNS as f64;
    let bent = points.iter().enumerate().map(|(v, [x, y])| {
        let (row, is_side) = (v / (COLUMNS + 1), [0, COLUMNS].contains(&(v % (COLUMNS + 1))));
        let is_moved = is_side && row > ROWS && row < ROWS + 8;
        let y = y + if is_moved { 0.5 * ((5 * row) as f64).sin() } else { 0.0 };
        let bow = 5.0 * (std::f64::consts::PI * y / height).sin();
        format!("{} {y}", x + bow * (2.0 * x / columns - 1.0))
    });
    let bent = bent.collect::<Vec<_>>().join("\n");
    let (elements, rest) = mesh.split_once("NPOIN=").unwrap();
    let (_, markers) = rest.split_once("NMARK").unwrap();
    let mesh = format!("{elements}NPOIN= {}\n{bent}\nNMARK{markers}", points.len());
    let folder = Folder::new(&[("in.su2", &*mesh)]);
    let run = folder.line("in.su2 out.su2 --engine cpu --slide");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let same = folder.line("compare in.su2 out.su2 --slide");
    assert_eq!(same.code, Some(0), "{}", same.err);
    let other = folder.line("compare in.su2 out.su2 --slide --keep-layers none");
    assert_eq!(other.code, Some(1), "{}", other.out);
    assert_holds(&other.err, &["moved that must not", "--keep-layers none"]);
}

#[test]
fn a_mesh_whose_free_vertices_are_all_in_layers_is_not_changed() {
    let (mesh, points) = layer(1);
    let folder = Folder::new(&[("in.su2", &*mesh)]);
    for slide in ["", "--slide"] {
        let run = folder.line(&format!("in.su2 out.su2 --force --engine cpu --strict {slide}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.out, &["every free vertex is in a boundary layer that stays"]);
        assert_eq!(folder.mesh("out.su2").points, points);
    }
}

#[test]
fn walls_with_flat_triangles_and_no_layer_are_named() {
    // Rows of equal height are no layer by themselves.
    let (mesh, points) = layer(8);
    let mut lines: Vec<String> = mesh.lines().map(str::to_owned).collect();
    let first = lines.iter().position(|line| line.starts_with("NPOIN")).unwrap() + 1;
    for (v, [x, _]) in points.iter().enumerate().take((ROWS + 1) * (COLUMNS + 1)) {
        lines[first + v] = format!("{x} {}", (v / (COLUMNS + 1)) as f64 * 0.2);
    }
    let folder = Folder::new(&[("in.su2", &lines.join("\n"))]);
    let run = folder.line("in.su2 out.su2 --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &["--keep-layers rows=N,wall keeps the first N rows"]);
    folder.line("in.su2 out2.su2 --engine cpu --keep-layers rows=2,none").refused(&[
        "--keep-layers",
        "none",
        "`gpu-smooth groups`",
    ]);
    for (value, part) in [("rows=0", "1 to 1000"), ("none,wall", "no groups"), ("x", "auto")] {
        let run = folder.line(&format!("in.su2 out3.su2 --keep-layers {value}"));
        assert_eq!(run.code, Some(2));
        assert_holds(&run.err, &[part]);
    }
}

/// Returns a mesh of quadrilaterals and, in the first three columns, of triangles on a flat wall, as gmsh 2.2. Its lines are
/// the physical groups 1 (`wall`, the first two columns of entity 11, the others of entity 12) and 2 (all other sides).
fn mixed() -> String {
    let mut text = String::from(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 1 \"wall\"\n$EndPhysicalNames\n$Nodes\n84\n",
    );
    for v in 0..84 {
        let (i, j) = (v % 12, v / 12);
        let is_inside = (1..11).contains(&i) && (1..6).contains(&j);
        let noise = if is_inside { 0.05 * ((7 * i + 3 * j) as f64).sin() } else { 0.0 };
        let height = 0.1 * (j * j) as f64;
        writeln!(text, "{} {} {} 0", v + 1, i as f64 + noise, height * (1.0 + noise)).unwrap();
    }
    let mut elements = Vec::new();
    for i in 0..11 {
        let entity = if i < 2 { 11 } else { 12 };
        elements.push(format!("1 2 1 {entity} {} {}", i + 1, i + 2));
        elements.push(format!("1 2 2 2 {} {}", 73 + i, 74 + i));
    }
    for j in 0..6 {
        elements.extend([1, 12].map(|i| format!("1 2 2 2 {} {}", 12 * j + i, 12 * (j + 1) + i)));
        for i in 0..11 {
            let a = 12 * j + i + 1;
            let [b, c, d] = [a + 1, a + 13, a + 12];
            match i < 3 {
                true => elements
                    .extend([format!("2 2 5 1 {a} {b} {c}"), format!("2 2 5 1 {a} {c} {d}")]),
                false => elements.push(format!("3 2 5 1 {a} {b} {c} {d}")),
            }
        }
    }
    writeln!(text, "$EndNodes\n$Elements\n{}", elements.len()).unwrap();
    for (k, element) in (1..).zip(elements) {
        writeln!(text, "{k} {element}").unwrap();
    }
    text + "$EndElements\n"
}

#[test]
fn the_spacing_at_walls_counts_the_vertices_of_quadrilaterals_that_move() {
    let folder = Folder::new(&[("in.msh", &mixed())]);
    for quadrilaterals in ["move", "keep"] {
        let run = folder.line(&format!(
            "in.msh out.msh --force --engine cpu --keep-layers none --report r.json --quadrilaterals {quadrilaterals}"
        ));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let walls = folder.json("r.json")["spacing"].as_array().unwrap().clone();
        let wall = walls.iter().find(|wall| wall["wall"] == "wall").unwrap();
        assert_eq!(wall["count"], 10, "{quadrilaterals}: {wall}");
    }
}

#[test]
fn a_note_on_layers_names_the_groups_of_the_option_or_each_wall_once() {
    let folder = Folder::new(&[("in.msh", &mixed())]);
    for (option, walls) in [
        ("within=0.4,wall", "wall"),
        ("within=0.4,physical:1", "physical:1"),
        ("within=0.4,entity:11", "entity:11"),
        ("within=0.4,wall,physical:2", "wall, physical:2"),
        // The entities have no vertices beside those of the physical groups.
        ("within=0.4", "wall"),
    ] {
        let line = format!("in.msh out.msh --force --engine cpu --keep-layers {option}");
        let run = folder.line(&line);
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.err, &[&format!(" within 0.4 of {walls} stay (--keep")]);
    }
}

#[test]
fn all_vertices_near_a_wall_with_flat_elements_stay() {
    // At the right half of the wall, edges are less than twice as long as the elements are high.
    let (mesh, points) = layer(8);
    let mut lines: Vec<String> = mesh.lines().map(str::to_owned).collect();
    let first = lines.iter().position(|line| line.starts_with("NPOIN")).unwrap() + 1;
    let half = COLUMNS as f64 / 2.0;
    let mut moved = points.clone();
    for (v, [x, y]) in moved.iter_mut().enumerate() {
        let column = (v % (COLUMNS + 1)) as f64;
        let noise = *x - column;
        *x = column;
        *y = if *x < half { *y } else { 0.7 * (v / (COLUMNS + 1)) as f64 - 0.25 * noise };
        lines[first + v] = format!("{x} {y}");
    }
    let folder = Folder::new(&[("in.su2", &lines.join("\n"))]);
    for (option, limit) in [("within=1.3", 1.3), ("within=1.3,wall", 1.3)] {
        let run = folder
            .line(&format!("in.su2 out.su2 --force --engine cpu --slide --keep-layers {option}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        let after = folder.mesh("out.su2").points;
        let near = (0..moved.len()).filter(|&v| moved[v][1] <= limit);
        let slid: Vec<usize> = near.filter(|&v| after[v] != moved[v]).collect();
        assert!(slid.is_empty(), "{option}: {slid:?}");
        assert!(after != moved);
        assert_holds(&run.err, &["within 1.3 of wall stay"]);
    }
}
