//! Meshes from file to file: signs of triangles as stored, material interfaces, and planes.

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

use gpu_smooth::layers::{KeepLayers, Layers};
use gpu_smooth::{Backend, Mesh, Options, Smoother};
use gpu_smooth_job::{Job, JobError, PlaneError};
use mesh_io::{MeshFile, Precision};
use support::{SplitMix64, check, mesh_of};

const COLUMNS: u32 = 12;
const ROWS: u32 = 10;

/// Returns the points of a lattice far from the origin, in multiples of `unit`. Rows rise by a third, are two units apart,
/// and have vertices some 30 units apart, displaced along the row by up to nine units.
fn flat_points(unit: f64, seed: u64) -> Vec<[f64; 2]> {
    let mut random = SplitMix64::new(seed);
    let cells = (0..=ROWS).flat_map(|row| (0..=COLUMNS).map(move |column| (row, column)));
    let point = |(row, column): (u32, u32)| {
        let along = 10.0 * f64::from(column) + random.below(7) as f64 - 3.0;
        [3.0 * along, 2.0 * f64::from(row) + along].map(|x| 123_456.0 + unit * x)
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

/// Returns thin triangles far from the origin, each split at a multiple of `unit` inside of it. The corners are multiples
/// of `unit`, too. The best place of the inner vertex is no multiple, and the nearest multiple may be outside.
fn split_slivers(unit: f64, seed: u64) -> Mesh {
    let mut random = SplitMix64::new(seed);
    let mut mesh = Mesh::default();
    let cross = |[a, b]: [i64; 2], [c, d]: [i64; 2]| a * d - b * c;
    let minus = |[a, b]: [i64; 2], [c, d]: [i64; 2]| [a - c, b - d];
    while mesh.triangles.len() < 3 * 48 {
        let mut point = || [0, 1].map(|_| random.below(24) as i64);
        let corners = [point(), point(), point()];
        let inner = point();
        let parts =
            [0, 1, 2].map(|k| cross(minus(corners[k], inner), minus(corners[(k + 1) % 3], inner)));
        let is_thin = parts.iter().sum::<i64>() < 30;
        if !is_thin || parts.iter().any(|&part| part <= 0) {
            continue;
        }
        let at = mesh.points.len() as u32;
        let east = 24 * i64::from(at / 4);
        let place = |[x, y]: [i64; 2]| [x + east, y].map(|x| 123_456.0 + unit * x as f64);
        mesh.points.extend(corners.map(place));
        mesh.points.push(place(inner));
        mesh.triangles.extend([0, 1, 2].map(|k| [at + k, at + (k + 1) % 3, at + 3]));
    }
    mesh
}

/// Returns a Nastran file with fields of eight columns. Coordinates are x, y and z.
fn nastran(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let mut text = "BEGIN BULK\n".to_owned();
    for (id, [x, y, z]) in (1..).zip(points) {
        writeln!(text, "GRID    {id:<8}        {x:<8.1}{y:<8.1}{z:<8.1}").unwrap();
    }
    for (id, [a, b, c]) in (1_u32..).zip(triangles) {
        let property = if (id - 1) % (2 * COLUMNS) < COLUMNS { 1 } else { 2 };
        writeln!(text, "CTRIA3  {id:<8}{property:<8}{:<8}{:<8}{:<8}", a + 1, b + 1, c + 1).unwrap();
    }
    text + "ENDDATA\n"
}

/// Returns a legacy VTK file of 32-bit floats.
fn vtk(points: &[[f64; 2]], cells: &[[u32; 3]]) -> Vec<u8> {
    let count = points.len();
    let head = "# vtk DataFile Version 3.0\nlattice\nBINARY\nDATASET UNSTRUCTURED_GRID\n";
    let mut bytes = format!("{head}POINTS {count} float\n").into_bytes();
    let all = points.iter().flat_map(|&[x, y]| [x, y, 0.0]);
    bytes.extend(all.flat_map(|x| (x as f32).to_be_bytes()));
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

/// Smooths the file by a job, and checks the written file. Returns whether a run that does not know the precision of the
/// file returns points that invert a triangle when the file is written.
fn assert_valid_as_written(file: &MeshFile, folder: &Path) -> bool {
    let (name, out) = (file.path().display(), folder.join(file.path()));
    assert!(check::is_valid(&mesh_of(file)), "{name}");
    let smoothed = Job::of_file(file).unwrap().smooth(&Options::default(), &Backend::Cpu).unwrap();
    smoothed.write(&out).unwrap();
    let written = MeshFile::read(&out).unwrap();
    assert!(check::is_valid(&mesh_of(&written)), "{name}");
    assert_eq!(written.points(), smoothed.outcome().points, "{name}: the run knows the digits");
    let moved = written.points().iter().zip(file.points()).filter(|(a, b)| a != b).count();
    assert!(moved > 10, "{name}: {moved} vertices have moved");

    let mesh = mesh_of(file);
    let outcome = Smoother::new(&mesh).unwrap().run(&Options::default()).block().unwrap();
    file.write(&out, &outcome.points).unwrap();
    !check::is_valid(&mesh_of(&MeshFile::read(&out).unwrap()))
}

#[test]
fn no_triangle_is_inverted_by_the_few_digits_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let eight = |seed| {
        let Mesh { points, triangles, .. } = split_slivers(0.1, seed);
        read("eight.bdf", nastran(&with_z(&points), &triangles).into())
    };
    let single = |seed| {
        let Mesh { points, triangles, .. } = split_slivers(1.0 / 128.0, seed);
        read("float.vtk", vtk(&points, &triangles))
    };
    for seed in 0..4 {
        for (file, precision) in
            [(eight(seed), Precision::Text8), (single(seed), Precision::Single)]
        {
            assert_eq!(file.precision(), precision);
            let is_inverted_without = assert_valid_as_written(&file, folder.path());
            assert!(is_inverted_without, "{}, seed {seed}", file.path().display());
        }
    }
}

#[test]
fn vertices_between_materials_stay() {
    let file = read("two.bdf", nastran(&with_z(&flat_points(0.1, 5)), &triangles()).into());
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
    let file = read("upright.bdf", nastran(&upright, &triangles()).into());
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
    let file = read("curved.bdf", nastran(&curved, &triangles()).into());
    let error = Job::of_file(&file).err().unwrap();
    assert!(matches!(error, JobError::Plane(PlaneError::NotPlanar { .. })), "{error}");
    assert!(error.to_string().starts_with("curved.bdf:"), "{error}");
    // Third coordinates that are data stay.
    Job::in_xy(&file).smooth(&Options::default(), &Backend::Cpu).unwrap().write(&out).unwrap();
    let written = MeshFile::read(&out).unwrap();
    assert_ne!(written.points(), file.points());
    let z = [&written, &file].map(|file| {
        let fields = file.point_fields(Some(&["z".into()])).unwrap();
        fields[0].values().to_vec()
    });
    assert_eq!(z[0], z[1]);
}

/// Returns an SU2 file of a flat wall with a layer of ten rows, and nine rows of noisy triangles above. With
/// `has_quads`, the layer consists of quadrilaterals.
fn layer(has_quads: bool) -> MeshFile {
    const COLUMNS: usize = 24;
    let mut heights = vec![0.0];
    for row in 0..18 {
        let step = if row < 10 { 0.05 * 1.3_f64.powi(row) } else { 1.1 };
        heights.push(heights[row as usize] + step);
    }
    let last = heights.len() - 1;
    let at = |i: usize, k: usize| k * (COLUMNS + 1) + i;
    let (mut elements, mut count, mut points) = (String::new(), 0, String::new());
    for (k, i) in (0..last).flat_map(|k| (0..COLUMNS).map(move |i| (k, i))) {
        let [p, q, r, s] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
        if has_quads && k < 10 {
            writeln!(elements, "9 {p} {q} {r} {s}").unwrap();
            count += 1;
        } else {
            writeln!(elements, "5 {p} {q} {r}\n5 {p} {r} {s}").unwrap();
            count += 2;
        }
    }
    for (k, i) in (0..=last).flat_map(|k| (0..=COLUMNS).map(move |i| (k, i))) {
        let is_free = 0 < i && i < COLUMNS && 10 < k && k < last;
        let noise = if is_free { 0.2 * ((7 * i + 3 * k) as f64).sin() } else { 0.0 };
        writeln!(points, "{} {}", i as f64 + noise, heights[k] - noise).unwrap();
    }
    let size = (last + 1) * (COLUMNS + 1);
    let text = format!("NDIME= 2\nNELEM= {count}\n{elements}NPOIN= {size}\n{points}NMARK= 0\n");
    read("layer.su2", text.into())
}

#[test]
fn boundary_layers_of_a_file_stay_unless_the_caller_says_otherwise() {
    let file = layer(false);
    let run = |job: Job<'_>| {
        let smoothed = job.smooth(&Options::default(), &Backend::Cpu).unwrap();
        smoothed.outcome().points.clone()
    };
    let job = || Job::of_file(&file).unwrap();
    let layers = job().layers().unwrap();
    assert_eq!((layers.rows, layers.vertices.len()), (10, 23 * 11 + 2 * 10));
    let kept = run(job());
    assert!(layers.vertices.iter().all(|&v| kept[v as usize] == file.points()[v as usize]));
    let fixed = Mesh { fixed: layers.vertices.clone(), ..job().into_mesh() };
    let smoother = Smoother::keeping(Cow::Owned(fixed), Layers::default()).unwrap();
    let options = Options::default().stored(job().stored());
    let outcome = smoother.run(&options).block().unwrap();
    assert_eq!(kept, outcome.points);
    assert_ne!(kept, file.points());
    let moved = run(job().keep_layers(KeepLayers::None));
    assert!(layers.vertices.iter().any(|&v| moved[v as usize] != file.points()[v as usize]));
    // The rows of quadrilaterals are found too.
    let whole = layer(true);
    assert_eq!(Job::of_file(&whole).unwrap().layers().unwrap().vertices, layers.vertices);
}
