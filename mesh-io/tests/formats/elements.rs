//! The quadrilaterals of each format: found by the reader, moved, and rewritten.

use super::Folder;
use super::made::{QUADRILATERAL, all, base};
use super::others::{folder, for_each};
use mesh_io::{Conversion, Format, MeshFile, ReadOptions};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Mutex;

/// Moves the vertices of the quadrilaterals of a file. Reads the written file, and checks that it has the same elements and the
/// moved points, and that the bytes of the file come back if nothing has moved. Returns whether the file has quadrilaterals.
fn moves_quadrilaterals(folder: &Folder, file: &MeshFile, name: &str) -> bool {
    if file.quadrilaterals().is_empty() {
        return false;
    }
    fs::create_dir_all(folder.path("moved")).unwrap();
    let out = folder.path("moved").join(name);
    let bytes = || fs::read(file.path()).unwrap();
    file.write(&out, file.points()).unwrap();
    assert!(fs::read(&out).unwrap() == bytes(), "the bytes have changed");
    let mut points = file.points().to_vec();
    for &v in file.quadrilaterals().as_flattened() {
        points[v as usize] = points[v as usize].map(|x| file.precision().rounded(x + 0.015625));
    }
    file.write(&out, &points).unwrap();
    let again = read(&out);
    assert_eq!(again.quadrilaterals(), file.quadrilaterals());
    assert_eq!(again.triangles(), file.triangles());
    let off = again.points().iter().zip(&points).flat_map(|(p, q)| [p[0] - q[0], p[1] - q[1]]);
    assert!(off.map(f64::abs).fold(0.0, f64::max) < 1e-6);
    assert_ne!(again.points(), file.points());
    true
}

fn read(path: &Path) -> MeshFile {
    ReadOptions::new().weld(true).allow_quadrilaterals_alone(true).read(path).unwrap()
}

#[test]
fn the_document_tells_the_elements_of_each_format() {
    let found = Mutex::new(BTreeSet::new());
    for_each(&base(), |made| {
        let folder = folder(made, &made.bytes);
        let file = read(&folder.path(made.name));
        if moves_quadrilaterals(&folder, &file, made.name) {
            assert_eq!(file.quadrilaterals().len(), 1, "{:?}", file.quadrilaterals());
            assert!(file.quadrilaterals()[0].iter().all(|v| QUADRILATERAL.contains(v)));
            found.lock().unwrap().insert(made.format.to_string());
        }
    });
    // Formats without a sample among the others are made from one.
    let all = all(&base());
    let sample = all.iter().find(|made| made.format == Format::Vtk).unwrap();
    let folder = folder(sample, &sample.bytes);
    let file = read(&folder.path(sample.name));
    assert_eq!(file.quadrilaterals().len(), 1);
    for (name, format) in Conversion::targets() {
        let Ok(conversion) = Conversion::new(&file, format) else { continue };
        let Some(conversion) = conversion else { continue };
        let ending = format.extensions()[0];
        let out = folder.path(&format!("{name}{ending}"));
        conversion.write(&out).unwrap();
        let converted = read(&conversion.destinations(&out)[0]);
        let name = converted.path().file_name().unwrap().to_str().unwrap().to_owned();
        if moves_quadrilaterals(&folder, &converted, &name) {
            found.lock().unwrap().insert(format.to_string());
        }
    }
    let found = found.into_inner().unwrap();
    let document = include_str!("../../../docs/formats.md");
    let table = document.split("<!-- formats: begin -->").nth(1).unwrap();
    let rows = table.split("<!-- formats: end -->").next().unwrap().lines().skip(3);
    let mut named = 0;
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let formats: Vec<&str> = cells[0].split(", ").collect();
        let has = formats.iter().any(|format| found.contains(*format));
        let expected = if has { "triangles, quadrilaterals" } else { "triangles" };
        assert_eq!(cells[3], expected, "{}", cells[0]);
        named += usize::from(has);
    }
    assert!(named > 15, "{named}");
}
