//! Meshes from file to file: signs of triangles as stored, material interfaces, and planes.

use std::fmt::Write;
use std::path::Path;

use gpu_smooth::{Backend, Options, Smoother};
use gpu_smooth_job::{Job, JobError, PlaneError};
use mesh_io::{MeshFile, Precision};
use support::{SplitMix64, check, mesh_of};

const COLUMNS: u32 = 12;
const ROWS: u32 = 10;
/// Distance of the rows, in units.
const SPACING: f64 = 2.0;

/// Returns the points of a lattice far from the origin, in multiples of `unit`. Rows rise by a third, are two units apart,
/// and have vertices some 30 units apart, displaced along the row by up to nine units. At an optimum, vertices are between
/// multiples of the unit, so that rounding moves them by a share of the distance of rows.
fn flat_points(unit: f64, seed: u64) -> Vec<[f64; 2]> {
    let mut random = SplitMix64::new(seed);
    let cells = (0..=ROWS).flat_map(|row| (0..=COLUMNS).map(move |column| (row, column)));
    let point = |(row, column): (u32, u32)| {
        let along = 10.0 * f64::from(column) + random.below(7) as f64 - 3.0;
        [3.0 * along, SPACING * f64::from(row) + along].map(|x| 123_456.0 + unit * x)
    };
    cells.map(point).collect()
}

/// Returns the triangles of the lattice, by zero-based vertices. The first half of the triangles in each row lies in the
/// western half.
fn triangles() -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for (row, column) in (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column))) {
        let at = |c: u32, r: u32| (row + r) * (COLUMNS + 1) + column + c;
        triangles.extend([[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]]);
    }
    triangles
}

/// Returns a Nastran file with fields of eight columns, of two properties. Coordinates are x, y and z.
fn nastran(points: &[[f64; 3]]) -> String {
    let mut text = "BEGIN BULK\n".to_owned();
    for (id, [x, y, z]) in (1..).zip(points) {
        writeln!(text, "GRID    {id:<8}        {x:<8.1}{y:<8.1}{z:<8.1}").unwrap();
    }
    for (id, [a, b, c]) in (1_u32..).zip(triangles()) {
        let property = if (id - 1) % (2 * COLUMNS) < COLUMNS { 1 } else { 2 };
        writeln!(text, "CTRIA3  {id:<8}{property:<8}{:<8}{:<8}{:<8}", a + 1, b + 1, c + 1).unwrap();
    }
    text + "ENDDATA\n"
}

/// Returns a legacy VTK file of 32-bit floats.
fn vtk(points: &[[f64; 2]]) -> Vec<u8> {
    let count = points.len();
    let head = "# vtk DataFile Version 3.0\nlattice\nBINARY\nDATASET UNSTRUCTURED_GRID\n";
    let mut bytes = format!("{head}POINTS {count} float\n").into_bytes();
    let all = points.iter().flat_map(|&[x, y]| [x, y, 0.0]);
    bytes.extend(all.flat_map(|x| (x as f32).to_be_bytes()));
    let cells = triangles();
    bytes.extend(format!("\nCELLS {} {}\n", cells.len(), 4 * cells.len()).bytes());
    bytes.extend(cells.iter().flat_map(|&[a, b, c]| [3, a, b, c]).flat_map(u32::to_be_bytes));
    bytes.extend(format!("\nCELL_TYPES {}\n", cells.len()).bytes());
    bytes.extend(cells.iter().flat_map(|_| 5_u32.to_be_bytes()));
    bytes
}

fn with_z(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
    points.iter().map(|&[x, y]| [x, y, 0.0]).collect()
}

fn read(name: &str, bytes: Vec<u8>) -> MeshFile {
    MeshFile::from_bytes(Path::new(name), bytes).unwrap()
}

/// Smooths the file by a job, and checks the written file. A run without the precision of the file returns points that the
/// file cannot hold, whose triangles nobody has checked.
fn assert_valid_as_written(file: &MeshFile, folder: &Path) {
    let (name, out) = (file.path().display(), folder.join(file.path()));
    assert!(check::is_valid(&mesh_of(file)), "{name}");
    let smoothed = Job::of_file(file).unwrap().smooth(&Options::default(), &Backend::Cpu).unwrap();
    smoothed.write(&out).unwrap();
    let written = MeshFile::read(&out).unwrap();
    assert!(check::is_valid(&mesh_of(&written)), "{name}");
    assert_eq!(written.points(), smoothed.outcome().points, "{name}: the run knows the digits");
    let moved = written.points().iter().zip(file.points()).filter(|(a, b)| a != b).count();
    assert!(moved > 20, "{name}: {moved} vertices have moved");

    let mesh = mesh_of(file);
    let outcome = Smoother::new(&mesh).unwrap().run(&Options::default()).block().unwrap();
    file.write(&out, &outcome.points).unwrap();
    assert_ne!(MeshFile::read(&out).unwrap().points(), outcome.points, "{name}");
}

#[test]
fn no_triangle_is_inverted_by_the_few_digits_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let text8 = |seed| nastran(&with_z(&flat_points(0.1, seed))).into();
    let text8 = (0..6).map(|seed| read("eight.bdf", text8(seed)));
    let single = (0..6).map(|seed| read("float.vtk", vtk(&flat_points(1.0 / 128.0, seed))));
    for (files, precision) in
        [(text8.collect::<Vec<_>>(), Precision::Text8), (single.collect(), Precision::Single)]
    {
        assert!(files.iter().all(|file| file.precision() == precision));
        files.iter().for_each(|file| assert_valid_as_written(file, folder.path()));
    }
}

#[test]
fn vertices_between_materials_stay() {
    let file = read("two.bdf", nastran(&with_z(&flat_points(0.1, 5))).into());
    let between = file.interface_vertices();
    assert_eq!(between.len() as u32, ROWS - 1);
    let job = Job::of_file(&file).unwrap();
    assert!(between.iter().all(|v| job.mesh().fixed.contains(v)));
    let smoothed = job.smooth(&Options::default(), &Backend::Cpu).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("two.bdf");
    smoothed.write(&out).unwrap();
    let written = MeshFile::read(&out).unwrap();
    for &v in &between {
        assert_eq!(written.points()[v as usize], file.points()[v as usize]);
    }
    assert_ne!(written.points(), file.points());
}

#[test]
fn a_mesh_in_another_plane_is_smoothed_there_and_a_curved_one_is_refused() {
    let flat = flat_points(0.1, 5);
    let flat: Vec<_> = flat.iter().map(|&p| p.map(|x| 10.0 * (x - 123_456.0))).collect();
    let upright: Vec<_> = flat.iter().map(|&[x, y]| [x, 7.5, y]).collect();
    let file = read("upright.bdf", nastran(&upright).into());
    let smoothed = Job::of_file(&file).unwrap().smooth(&Options::default(), &Backend::Cpu).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("upright.bdf");
    smoothed.write(&out).unwrap();
    let written = MeshFile::read(&out).unwrap();
    assert!(written.points().iter().all(|point| point[1] == 7.5));
    let written = Job::of_file(&written).unwrap();
    assert!(check::is_valid(written.mesh()));
    assert_ne!(written.mesh().points, smoothed.job().mesh().points);

    let curved: Vec<_> = flat.iter().map(|&[x, y]| [x, y, 1e-3 * x * x]).collect();
    let error = Job::of_file(&read("curved.bdf", nastran(&curved).into())).err().unwrap();
    assert!(matches!(error, JobError::Plane(PlaneError::NotPlanar { .. })), "{error}");
    assert!(error.to_string().starts_with("curved.bdf:"), "{error}");
}
