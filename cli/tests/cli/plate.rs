//! The example of the README: the program smooths the plate of `meshes/`.

use super::{Folder, assert_holds, assert_smoothed, number, plate_path};
use mesh_io::MeshFile;
use std::fs;

#[test]
fn plate_is_smoothed_alike_on_gpu_and_cpu() {
    let folder = Folder::new(&[]);
    let plate = MeshFile::read(plate_path()).unwrap();
    let plate_text = fs::read_to_string(plate_path()).unwrap();
    let reports = ["gpu", "cpu"].map(|engine| {
        let (out, json) = (format!("{engine}.node"), format!("{engine}.json"));
        let plate_name = plate_path().to_str().unwrap();
        let args = [plate_name, &out, "--engine", engine, "--report", &json];
        let summary = folder.run(args).clean().out;
        assert_holds(&summary, &[&format!("imr on {engine} ("), "\nf imr ", "\nconverged after "]);

        let (after, report) = (folder.mesh(&out), folder.json(&json));
        assert_smoothed(&support::mesh_of(&plate), &after);
        assert!(support::worst_imr(&after) < 2.0 && support::min_angle(&after) > 20.0);
        for (state, mesh) in [("before", &support::mesh_of(&plate)), ("after", &after)] {
            let (told, oracle) = (number(&report[state]["f"]["imr"]), support::f_imr(mesh));
            assert!((told / oracle - 1.0).abs() < 1e-9, "{state}: {told} instead of {oracle}");
        }

        let ele = fs::read(plate_path().with_extension("ele")).unwrap();
        assert_eq!(fs::read(folder.path(&format!("{engine}.ele"))).unwrap(), ele);
        assert_rows_kept(&plate_text, &folder.text(&out));
        report
    });
    let [gpu, cpu] = &reports;
    assert_eq!(gpu["before"], cpu["before"]);
    assert_eq!(gpu["mesh"], cpu["mesh"]);
    for metric in ["imr", "ar"] {
        let [gpu, cpu] = [gpu, cpu].map(|report| number(&report["after"]["f"][metric]));
        assert!((gpu / cpu - 1.0).abs() < 1e-6, "f {metric}: {gpu} on the GPU, {cpu} on the CPU");
    }
}

/// Checks that comments, header, numbers, markers and boundary coordinates are unchanged.
fn assert_rows_kept(before: &str, after: &str) {
    assert_eq!(before.lines().count(), after.lines().count());
    let rows = before.lines().zip(after.lines());
    assert!(rows.clone().take(2).all(|(old, new)| old == new));
    for (old, new) in rows.skip(2) {
        let [old_row, new_row] = [old, new].map(|row| row.split(' ').collect::<Vec<_>>());
        assert_eq!([old_row[0], old_row[3]], [new_row[0], new_row[3]]);
        assert!(new_row.len() == 4 && (old_row[3] == "0" || old == new), "{old} became {new}");
    }
}

#[test]
fn engine_and_scheme_have_defaults() {
    let folder = Folder::new(&[]);
    let plate = plate_path().to_str().unwrap();
    folder.run([plate, "a"]).clean();
    folder.run([plate, "b", "--engine", "cpu", "--scheme", "imr", "--tolerance", "1e-6"]).clean();
    assert!(folder.text("a.node") == folder.text("b.node"));
}
