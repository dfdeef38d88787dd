//! `--surface sphere`: meshes across the date line, around the globe, and at a pole.

use super::{Folder, assert_holds, number, support};
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
        (COLUMNS, true, &[line, "18 triangles at a pole stay, with all vertices"]),
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
    assert_holds(&run.err, &[&format!("in.gr3: none of the {count} vertices is free to move.")]);
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
