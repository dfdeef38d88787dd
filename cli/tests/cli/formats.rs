//! Runs on files of other programs, with points as text and in single precision.

use super::{Folder, assert_smoothed, disturbed, number};
use gpu_smooth::Mesh;
use mesh_io::{Format, MeshFile, Precision};
use std::fmt::Write;
use std::fs;
use support::{Binary, check};

/// Returns the small mesh far from the origin, where single precision resolves few digits of the coordinates.
fn far() -> Mesh {
    let mut mesh = disturbed();
    mesh.points.iter_mut().for_each(|[x, y]| (*x, *y) = (*x + 300.0, *y - 150.0));
    mesh
}

fn su2(mesh: &Mesh) -> Vec<u8> {
    let mut text = format!("% made for a test\nNDIME= 2\nNELEM= {}\n", mesh.triangles.len());
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        writeln!(text, "5 {a} {b} {c} {i}").unwrap();
    }
    writeln!(text, "NPOIN= {}", mesh.points.len()).unwrap();
    for (i, [x, y]) in mesh.points.iter().enumerate() {
        writeln!(text, "{x:e}\t{y} {i}").unwrap();
    }
    (text + "NMARK= 0\n").into_bytes()
}

/// Returns a VTK legacy file with points of single precision, as text with more digits than single precision has.
fn vtk_text(mesh: &Mesh) -> Vec<u8> {
    let n = mesh.triangles.len();
    let mut text =
        "# vtk DataFile Version 3.0\nmade for a test\nASCII\nDATASET POLYDATA\n".to_owned();
    writeln!(text, "POINTS {} float", mesh.points.len()).unwrap();
    mesh.points.iter().for_each(|[x, y]| write!(text, "{x} {y} 0.5 ").unwrap());
    writeln!(text, "\nPOLYGONS {n} {}", 4 * n).unwrap();
    mesh.triangles.iter().for_each(|[a, b, c]| writeln!(text, "3 {a} {b} {c}").unwrap());
    text.into_bytes()
}

/// VTK's legacy format with points of single precision, in binary.
fn vtk_binary(mesh: &Mesh) -> Vec<u8> {
    let n = mesh.triangles.len();
    let mut file = Binary::empty(true);
    file.text("# vtk DataFile Version 3.0\nmade for a test\nBINARY\nDATASET POLYDATA\n");
    file.text(&format!("POINTS {} float\n", mesh.points.len()));
    mesh.points.iter().for_each(|[x, y]| file.reals(Precision::Single, &[*x, *y, 0.5]));
    file.text(&format!("\nPOLYGONS {n} {}\n", 4 * n));
    for t in &mesh.triangles {
        file.ints(&[3]);
        file.ints(&t.map(|v| v as i32));
    }
    file.text("\n");
    file.bytes
}

/// Returns a binary Medit file of version 1, which stores single precision.
fn meshb(mesh: &Mesh) -> Vec<u8> {
    let mut file = Binary::empty(false);
    let (n, m) = (mesh.points.len() as i32, mesh.triangles.len() as i32);
    let triangles_at = 32 + 12 * n;
    file.ints(&[1, 1, 3, 20, 2, 4, triangles_at, n]);
    for [x, y] in &mesh.points {
        file.reals(Precision::Single, &[*x, *y]);
        file.ints(&[0]);
    }
    file.ints(&[6, triangles_at + 12 + 16 * m, m]);
    for t in &mesh.triangles {
        file.ints(&t.map(|v| v as i32 + 1));
        file.ints(&[1]);
    }
    file.ints(&[54, 0]);
    file.bytes
}

/// Returns Nastran bulk data with fields of the width of `precision`.
fn nastran(mesh: &Mesh, precision: Precision) -> Vec<u8> {
    let (width, mark) = if precision == Precision::Text8 { (8, "") } else { (16, "*") };
    let mut text = "BEGIN BULK\n".to_owned();
    for (v, point) in mesh.points.iter().enumerate() {
        let [x, y] = point.map(|x| precision.rounded(x).to_string());
        let (name, v) = (format!("GRID{mark}"), v + 1);
        writeln!(text, "{name:<8}{v:>width$}{:width$}{x:>width$}{y:>width$}", "").unwrap();
    }
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|v| v + 1);
        writeln!(text, "CTRIA3,{},1,{a},{b},{c}", t + 1).unwrap();
    }
    text.into_bytes()
}

#[test]
fn the_file_written_by_a_run_holds_what_its_report_says() {
    let mesh = far();
    let single = Precision::Single;
    let [short, long] = [Precision::Text8, Precision::Text16];
    for (name, bytes, format, precision) in [
        ("in.su2", su2(&mesh), Format::Su2, Precision::Double),
        ("in.vtk", vtk_text(&mesh), Format::Vtk, single),
        ("in.vtk", vtk_binary(&mesh), Format::VtkBinary, single),
        ("in.meshb", meshb(&mesh), Format::MeditBinary, single),
        ("in.bdf", nastran(&mesh, short), Format::Nastran, short),
        ("in.bdf", nastran(&mesh, long), Format::Nastran, long),
    ] {
        let folder = Folder::new(&[]);
        fs::write(folder.path(name), &bytes).unwrap();
        let out = name.replace("in", "out");
        for options in ["", " --scheme edge", " --max-sweeps 1", " --desired 1.05 --fraction 0.8"] {
            let line = format!("{name} {out} --engine cpu --report r.json{options}");
            folder.line(&line).clean();
            let file = MeshFile::read(&folder.path(&out)).unwrap();
            assert_eq!((file.format(), file.precision()), (format, precision));
            let (before, after) = (folder.mesh(name), support::mesh_of(&file));
            // Exact predicates on the rounded coordinates of the file.
            assert_smoothed(&before, &after);
            assert!(check::is_ccw(&after));

            let report = folder.json("r.json");
            assert_eq!(report["mesh"]["format"], format.to_string());
            assert_eq!(report["after"]["inverted"], 0);
            for (state, mesh) in [("before", &before), ("after", &after)] {
                let told = number(&report[state]["f"]["imr"]);
                let held = support::f_imr(mesh);
                assert!((told / held - 1.0).abs() < 1e-9, "{line}: {told} of {held} {state}");
            }
            let quality = folder.line(&format!("quality {out} --json")).clean().out;
            let quality: serde_json::Value = serde_json::from_str(&quality).unwrap();
            for (metric, told) in report["after"]["f"].as_object().unwrap() {
                let held = number(&quality["f"][metric]);
                assert!((number(told) / held - 1.0).abs() < 1e-9, "{line}: {metric} is {held}");
            }
        }
    }
}

/// An XDMF mesh with numbers in an HDF5 file is written to another folder, in place, with a report, in a batch and
/// through a pipe.
#[test]
fn an_xdmf_comes_with_the_files_beside_it() {
    let made = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../mesh-io/tests/formats/h5");
    let folder = Folder::new(&[]);
    for name in ["dolfin.xdmf", "dolfin.h5", "meshio.xdmf", "meshio.h5"] {
        fs::copy(made.join(name), folder.path(name)).unwrap();
    }
    fs::create_dir(folder.path("sub")).unwrap();
    let line = "dolfin.xdmf sub/out.xdmf --interpolate all --report run.json --engine cpu";
    assert_eq!(folder.line(line).code, Some(0));
    assert_eq!(fs::read_dir(folder.path("sub")).unwrap().count(), 2);
    let report = folder.json("run.json");
    assert_eq!(report["certificate"]["connectivity_identical"], true, "{report:#}");
    let compared = folder.line("compare dolfin.xdmf sub/out.xdmf --interpolate all");
    assert_eq!(compared.code, Some(0), "{}", compared.err);
    assert!(compared.out.contains("sub/out.h5"), "{}", compared.out);
    let text = folder.text("dolfin.xdmf");
    assert_eq!(
        folder.line("dolfin.xdmf dolfin.xdmf -q --interpolate all --engine cpu").code,
        Some(0)
    );
    assert_eq!(folder.text("dolfin.xdmf"), text);
    assert!(
        fs::read(folder.path("dolfin.h5")).unwrap() == fs::read(folder.path("sub/out.h5")).unwrap()
    );
    assert_eq!(folder.line("dolfin.xdmf meshio.xdmf --out-dir many --engine cpu").code, Some(0));
    assert_eq!(folder.line("compare meshio.xdmf many/meshio.xdmf").code, Some(0));
    assert!(folder.path("many/dolfin.h5").is_file());
    folder.line("dolfin.xdmf - --engine cpu").refused(&["cannot go to standard output: name OUT"]);
    folder.line("dolfin.h5 out.h5").refused(&["name the .xdmf"]);
}

/// In a UGRID mesh in netCDF-4, interpolated data and face positions follow the vertices, also through a conversion.
#[test]
fn places_and_data_of_ugrid_follow_the_vertices() {
    let made = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../mesh-io/tests/formats/h5");
    let folder = Folder::new(&[]);
    fs::copy(made.join("ugrid.nc"), folder.path("in.nc")).unwrap();
    let line = "in.nc out.nc --interpolate all --report run.json --engine cpu";
    let run = folder.line(line);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(!run.err.contains("mesh_face_x"), "{}", run.err);
    let report = folder.json("run.json");
    assert_eq!(report["certificate"]["connectivity_identical"], true, "{report:#}");
    let compared = folder.line("compare in.nc out.nc --interpolate all");
    assert_eq!(compared.code, Some(0), "{}", compared.err);
    let means = |name: &str| {
        let file = MeshFile::read(&folder.path(name)).unwrap();
        let (fields, others) = file.centers(file.points()).unwrap();
        assert!(others.is_empty(), "{others:?}");
        fields[0].values().to_vec()
    };
    assert_ne!(means("in.nc"), means("out.nc"));
    assert_eq!(folder.line("convert out.nc mesh.2dm --lossy").code, Some(0));
    assert_eq!(folder.line("convert mesh.2dm back.nc").code, Some(0));
    let [out, back] = ["out.nc", "back.nc"].map(|name| MeshFile::read(&folder.path(name)).unwrap());
    assert_eq!(support::mesh_of(&out), support::mesh_of(&back));
}
