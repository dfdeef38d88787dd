//! `--surface sphere`: meshes across the date line, around the globe, and at a pole.

use super::{Folder, assert_holds, number};
use std::fmt::Write;

const COLUMNS: u32 = 18;
const ROWS: u32 = 5;

/// Returns a SCHISM grid of a band around the globe, or of a part of one, from 10 to 60 degrees north. The band is
/// `fields` cells of 20 degrees wide, with longitudes from -180 to 180. With `has_pole`, triangles join the top row to
/// a vertex at the pole.
fn band(fields: u32, has_pole: bool) -> String {
    let mut random = support::SplitMix64::new(4);
    let across = if fields == COLUMNS { fields } else { fields + 1 };
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..=ROWS {
        for column in 0..across {
            let is_inside =
                row % ROWS != 0 && (fields == COLUMNS || !column.is_multiple_of(fields));
            let mut off = || if is_inside { random.range(-0.25, 0.25) } else { 0.0 };
            let x: f64 = 130.0 + 20.0 * (f64::from(column) + off());
            points
                .push([(x + 180.0).rem_euclid(360.0) - 180.0, 10.0 * (f64::from(row + 1) + off())]);
            if row < ROWS && column < fields {
                let at = |c: u32, r: u32| (row + r) * across + (column + c) % across;
                triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
                triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
    }
    if has_pole {
        let (top, pole) = (ROWS * across, (ROWS + 1) * across);
        points.push([0.0, 90.0]);
        triangles.extend((0..fields).map(|k| [top + k, top + (k + 1) % across, pole]));
    }
    let mut text = format!("band\n{} {}\n", triangles.len(), points.len());
    for (i, [x, y]) in points.iter().enumerate() {
        writeln!(text, "{} {x} {y} {}", i + 1, x.abs()).unwrap();
    }
    for (i, [a, b, c]) in triangles.iter().enumerate() {
        writeln!(text, "{} 3 {} {} {}", i + 1, a + 1, b + 1, c + 1).unwrap();
    }
    text + "0 = Number of open boundaries\n"
}

#[test]
fn triangles_across_the_date_line_are_smoothed_and_proved() {
    let line = "longitudes are continued for";
    for (fields, has_pole, notes) in [
        (9, false, &[line][..]),
        (COLUMNS, false, &[line, "closes around the globe, so 6 vertices at that line stay"]),
        (COLUMNS, true, &[line, "18 elements at a pole stay, with all vertices"]),
    ] {
        let folder = Folder::new(&[("in.gr3", &band(fields, has_pole))]);
        let options = "--engine cpu --surface sphere --slide --interpolate depth";
        let run = folder.line(&format!("in.gr3 out.gr3 {options} --report r.json --html p.html"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.err, notes);
        let (report, certificate) = (folder.json("r.json"), &folder.json("r.json")["certificate"]);
        assert_eq!((&certificate["inverted"], &certificate["fixed_moved"]), (&0.into(), &0.into()));
        assert!(number(&certificate["moved"]) > 25.0, "{certificate}");
        let f = |state: &str| number(&report[state]["f"]["imr"]);
        assert!(f("after") < f("before"), "{} {}", f("before"), f("after"));
        let (before, after) = (folder.mesh("in.gr3"), folder.mesh("out.gr3"));
        assert_eq!(report["mesh"]["vertices"], before.points.len());
        // Longitudes stay in the range of the file, and depths are interpolated at new positions.
        assert!(after.points.iter().all(|point| (-180.0..=180.0).contains(&point[0])));
        let compared =
            folder.line("compare in.gr3 out.gr3 --surface sphere --slide --interpolate depth");
        assert_eq!(compared.code, Some(0), "{}", compared.err);
        // `gpu-smooth quality` measures the same angles on the sphere.
        let quality = folder.line("quality out.gr3 --surface sphere --json --picture q.png");
        let quality: serde_json::Value = serde_json::from_str(&quality.out).unwrap();
        assert_eq!(quality["vertices"], before.points.len());
        assert_eq!(quality["unused_vertices"], 0, "a vertex at a pole has triangles");
        let measures = &quality["measures"];
        for (key, [measure, extreme]) in [
            ("min_angle", ["min-angle", "min"]),
            ("max_angle", ["max-angle", "max"]),
            ("worst_imr", ["condition", "max"]),
        ] {
            let told = number(&report["after"][key]);
            assert!((number(&quality[key]) / told - 1.0).abs() < 1e-12, "{key}");
            let measured = number(&measures[measure][extreme]);
            assert!((measured / told - 1.0).abs() < 1e-9, "{key}: {measured} {told}");
        }
        // Moves a vertex across its triangles, which `compare` must detect.
        let text = folder.text("out.gr3");
        let inside = (fields + usize::from(fields < COLUMNS) as u32) as usize + 1;
        let row = text.lines().nth(2 + inside).unwrap();
        let number: Vec<&str> = row.split_whitespace().collect();
        let spoiled = format!("{} 0 {} {}", number[0], number[2], number[3]);
        std::fs::write(folder.path("bad.gr3"), text.replacen(row, &spoiled, 1)).unwrap();
        folder
            .line("compare -q in.gr3 bad.gr3 --surface sphere --slide --interpolate depth")
            .refused(&["inverted or flat"]);
    }
}

/// Triangles across the date line are measured with continued longitudes, and printed with longitudes of the file.
#[test]
fn the_worst_triangles_are_where_the_file_has_them() {
    for has_pole in [false, true] {
        let folder = Folder::new(&[("in.gr3", &band(COLUMNS, has_pole))]);
        let points = folder.mesh("in.gr3").points;
        let line = "quality in.gr3 --surface sphere --measure min-angle --worst 500";
        let json = folder.line(&format!("{line} --json"));
        let json: serde_json::Value = serde_json::from_str(&json.out).unwrap();
        let worst = json["worst"].as_array().unwrap();
        assert_eq!(worst.len(), folder.mesh("in.gr3").triangles.len());
        for triangle in worst {
            for corner in 0..3 {
                let vertex = triangle["vertices"][corner].as_u64().unwrap() as usize;
                let own = [0, 1].map(|axis| number(&triangle["corners"][corner][axis]));
                assert_eq!(own, points[vertex - 1], "{triangle}");
            }
        }
        let text = folder.line(line).out;
        let mut count = 0;
        for row in text.lines().filter(|row| row.contains("; at ")) {
            let x = row.split("; at ").nth(1).unwrap().split(' ').next().unwrap();
            assert!(x.parse::<f64>().unwrap().abs() <= 180.0, "{row}");
            count += 1;
        }
        assert_eq!(count, worst.len());
    }
}

/// Triangles at a pole and at a cut of the globe use copies of vertices, which must not be counted.
#[test]
fn vertices_are_counted_as_the_file_has_them() {
    let folder = Folder::new(&[("in.gr3", &band(COLUMNS, true))]);
    let count = (ROWS + 1) * COLUMNS + 1;
    let run = folder.line("in.gr3 out.gr3 --surface sphere --fix-box -180,0,180,90");
    assert_eq!(run.code, Some(3));
    let reasons = format!(
        "in.gr3: none of the {count} vertices is free to move: 1 in no triangle, 40 on the boundary, {} by options such as --fix",
        count - 41
    );
    assert_holds(&run.err, &[&reasons]);
}

#[test]
fn a_mesh_across_the_date_line_is_refused_in_the_plane_with_a_remedy() {
    let folder = Folder::new(&[("in.gr3", &band(9, false))]);
    folder
        .line("in.gr3 out.gr3 --engine cpu -q")
        .refused(&["10 triangles are inverted or flat", "--surface sphere continues longitudes"]);
    let north = "cap\n1 3\n1 -120 80 1\n2 0 80 1\n3 120 80 1\n1 3 1 2 3\n";
    let folder = Folder::new(&[("in.gr3", north)]);
    folder
        .line("in.gr3 out.gr3 --engine cpu --surface sphere -q")
        .refused(&["in.gr3:6: triangle 1 has a pole of the sphere inside of it", "projection"]);
}

/// The sizes of a background do not depend on its range of longitudes, nor on whether the background surrounds the
/// globe.
#[test]
fn a_background_and_its_mesh_may_both_be_across_the_date_line() {
    // Depths serve as sizes, so all must be positive. Longitudes lie in the 360 degrees after `from`.
    let rewritten = |text: &str, from: f64| {
        let row = |row: &str| match row.split(' ').collect::<Vec<_>>()[..] {
            [number, x, y, depth] => {
                let [x, depth] = [x, depth].map(|number| number.parse::<f64>().unwrap());
                format!("{number} {} {y} {}\n", (x - from).rem_euclid(360.0) + from, depth + 100.0)
            }
            _ => format!("{row}\n"),
        };
        text.lines().map(row).collect::<String>()
    };
    let part = rewritten(&band(9, false), -180.0);
    // In this range of longitudes, no triangle is across the line.
    let turned = rewritten(&band(9, false), 0.0);
    let view = |text: &str| {
        let rows: Vec<Vec<f64>> = text
            .lines()
            .skip(2)
            .filter_map(|row| row.split(' ').map(|x| x.parse().ok()).collect())
            .collect();
        let triangles = rows.iter().filter(|row| row.len() == 5);
        let one = |row: &Vec<f64>| {
            let corners = [2, 3, 4].map(|k| &rows[row[k] as usize - 1]);
            let places = corners.map(|row| format!("{},{},0", row[1], row[2])).join(",");
            format!("ST({places}){{{}}};\n", corners.map(|row| row[3].to_string()).join(","))
        };
        format!("View \"sizes\" {{\n{}}};\n", triangles.map(one).collect::<String>())
    };
    let folder = Folder::new(&[
        ("in.gr3", &part),
        ("turned.gr3", &turned),
        ("globe.gr3", &rewritten(&band(COLUMNS, true), -180.0)),
        ("sizes.pos", &view(&part)),
    ]);
    let f = |mesh: &str, target: &str| {
        let options = "--engine cpu --surface sphere --report r.json --force";
        let run = folder.line(&format!("{mesh} out.gr3 {options} --target {target}"));
        assert_eq!(run.code, Some(0), "{target}: {}", run.err);
        assert!(!run.err.contains("outside of"), "{}", run.err);
        let report = folder.json("r.json");
        assert!(number(&report["certificate"]["moved"]) > 25.0);
        let f = &report["target"]["f"];
        [number(&f[0]), number(&f[1])]
    };
    let own = f("in.gr3", "size=depth --target-of place");
    assert!(own[1] < own[0], "{own:?}");
    for (mesh, target) in [
        ("in.gr3", "size=in.gr3:depth"),
        ("in.gr3", "size=turned.gr3:depth"),
        ("turned.gr3", "size=in.gr3:depth"),
        ("in.gr3", "size=sizes.pos"),
        ("turned.gr3", "size=sizes.pos"),
    ] {
        let f = f(mesh, target);
        assert!((0..2).all(|k| (f[k] / own[k] - 1.0).abs() < 1e-6), "{target}: {f:?} {own:?}");
    }
    // A background around the globe with a pole, whose other vertices are at other positions.
    let around = f("in.gr3", "size=globe.gr3:depth");
    assert!((around[0] / own[0] - 1.0).abs() < 0.1, "{around:?} {own:?}");
    let both = f("globe.gr3", "size=globe.gr3:depth");
    assert!(both[1] < both[0], "{both:?}");
}

/// A lattice of `FIELDS` by `FIELDS` squares of equal size in degrees, each of two triangles.
const FIELDS: usize = 12;

fn lattice(south: f64, north: f64) -> (Vec<[f64; 2]>, Vec<[usize; 3]>) {
    let step = (north - south) / FIELDS as f64;
    let at =
        |k: usize| [step * (k % (FIELDS + 1)) as f64, south + step * (k / (FIELDS + 1)) as f64];
    let points = (0..(FIELDS + 1).pow(2)).map(at).collect();
    let fields =
        (0..FIELDS).flat_map(|row| (0..FIELDS).map(move |column| row * (FIELDS + 1) + column));
    let halves = |k| [[k, k + 1, k + FIELDS + 2], [k, k + FIELDS + 2, k + FIELDS + 1]];
    (points, fields.flat_map(halves).collect())
}

/// Returns imr² of a triangle of longitudes and latitudes, whose longitudes have the lengths of those at its center.
fn imr_squared(corners: [[f64; 2]; 3]) -> f64 {
    let scale = (corners.iter().map(|p| p[1]).sum::<f64>() / 3.0).to_radians().cos();
    let [p, q, r] = corners.map(|[x, y]| [scale * x, y]);
    let area = 0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]));
    let squares =
        [[p, q], [q, r], [r, p]].map(|[a, b]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2));
    let imr = squares.iter().sum::<f64>() / (4.0 * 3_f64.sqrt() * area);
    if area > 0.0 { imr * imr } else { f64::INFINITY }
}

/// Moves each inner vertex of a lattice to the least sum of imr² over its triangles, in a pattern search that evaluates
/// only this sum, until no vertex moves by more than 1e-6 degrees.
fn optimum(points: &mut [[f64; 2]], triangles: &[[usize; 3]]) {
    let inner =
        |v: &usize| [v % (FIELDS + 1), v / (FIELDS + 1)].iter().all(|k| (1..FIELDS).contains(k));
    let mut step = 0.5;
    while step > 1e-6 {
        let mut has_moved = false;
        for v in (0..points.len()).filter(inner) {
            let around: Vec<_> =
                triangles.iter().filter(|triangle| triangle.contains(&v)).collect();
            let sum = |points: &[[f64; 2]]| -> f64 {
                around.iter().map(|triangle| imr_squared(triangle.map(|v| points[v]))).sum()
            };
            for [x, y] in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
                let (was, here) = (sum(points), points[v]);
                points[v] = [here[0] + step * x, here[1] + step * y];
                if sum(points) < was {
                    has_moved = true;
                } else {
                    points[v] = here;
                }
            }
        }
        if !has_moved {
            step *= 0.5;
        }
    }
}

#[test]
fn a_mesh_of_high_latitudes_ends_at_the_optimum_on_the_sphere() {
    // With the scale of longitudes frozen at the start, the excess is 0.015 and 0.06.
    for (south, north) in [(40.0, 75.0), (60.0, 85.0)] {
        let (points, triangles) = lattice(south, north);
        let mut text = format!("lattice\n{} {}\n", triangles.len(), points.len());
        for (i, [x, y]) in points.iter().enumerate() {
            writeln!(text, "{} {x} {y} 1", i + 1).unwrap();
        }
        for (i, corners) in triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| v + 1);
            writeln!(text, "{} 3 {a} {b} {c}", i + 1).unwrap();
        }
        let folder = Folder::new(&[("in.gr3", &(text + "0 = Number of open boundaries\n"))]);
        let run = folder.line("in.gr3 out.gr3 --surface sphere --engine cpu --report r.json");
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.out, &["in the projection; on the sphere, f may be"]);
        let written = folder.text("out.gr3");
        let rows = written.lines().skip(2).take(points.len());
        let point = |row: &str| -> [f64; 2] {
            let mut words = row.split_whitespace().skip(1);
            [(); 2].map(|()| words.next().unwrap().parse().unwrap())
        };
        let mut smoothed: Vec<[f64; 2]> = rows.map(point).collect();
        let f = |points: &[[f64; 2]]| {
            triangles.iter().map(|t| imr_squared(t.map(|v| points[v]))).sum::<f64>()
                / triangles.len() as f64
        };
        let reached = f(&smoothed);
        optimum(&mut smoothed, &triangles);
        let excess = reached / f(&smoothed) - 1.0;
        assert!(excess < 1e-4, "{south} to {north}: {excess} above the optimum");
        let remaining = number(&folder.json("r.json")["remaining"]);
        assert!(remaining > 0.5 * excess, "{south} to {north}: {excess} and {remaining}");
    }
}
