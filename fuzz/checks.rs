//! Checks of what must hold for any file and any mesh. The fuzzer's targets and `tests/fuzz.rs` share them. Each panics if
//! something does not hold.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use gpu_smooth::{
    Backend, Conversion, Derivatives, Format, Guard, Mesh, MeshError, MeshFile, Method, Metric,
    Options, Precision, Scheme, Sharpness, Slide, SmoothError, Smoother, Surface, Targets, WorstBy,
    untangle, validity,
};

/// Reads any bytes as a mesh file of any format but Triangle's, and does everything with it that needs no second file.
pub(crate) fn any_file(bytes: &[u8]) {
    match MeshFile::from_bytes(Path::new("fuzzed"), bytes.to_vec()) {
        Ok(file) => {
            use_file(&file);
            let mut written = Vec::new();
            file.write_to(Path::new("again"), &mut written, &file.mesh().points).unwrap();
            assert!(written == bytes, "a file that has not changed is written otherwise");
        }
        Err(error) => assert_told(&error.to_string()),
    }
}

/// Reads any bytes as a file beside an XDMF, in HDF5 or raw.
pub(crate) fn any_file_beside(folder: &Path, bytes: &[u8]) {
    const NAMING: [(&str, &str); 3] = [
        ("dolfin.h5", include_str!("../tests/formats/h5/dolfin.xdmf")),
        ("latest.h5", include_str!("../tests/formats/h5/latest.xdmf")),
        ("raw.bin", include_str!("../tests/formats/h5/raw.xdmf")),
    ];
    let path = folder.join("fuzzed.xdmf");
    for (named, text) in NAMING {
        // The cells of the raw one stand in the same file.
        let text = text.replace("raw-cells.bin", named).replace(named, "fuzzed.h5");
        fs::write(&path, &text).unwrap();
        fs::write(folder.join("fuzzed.h5"), bytes).unwrap();
        match MeshFile::read(&path) {
            Ok(file) => {
                use_file(&file);
                file.write(&path, &file.mesh().points).unwrap();
                assert_eq!(fs::read_to_string(&path).unwrap(), text);
                let again = fs::read(folder.join("fuzzed.h5")).unwrap();
                assert!(again == bytes, "a file that has not changed is written otherwise");
            }
            Err(error) => assert_told(&error.to_string()),
        }
    }
}

/// Reads any bytes as the two or three files of a Triangle mesh, which a byte that no text holds parts.
pub(crate) fn any_triangle_files(folder: &Path, bytes: &[u8]) {
    let mut parts = bytes.splitn(3, |byte| *byte == 0xFF);
    for ending in ["node", "ele", "poly"] {
        let path = folder.join("fuzzed").with_extension(ending);
        match parts.next() {
            Some(part) => fs::write(path, part).unwrap(),
            None => drop(fs::remove_file(path)),
        }
    }
    match MeshFile::read(&folder.join("fuzzed.node")) {
        // A file of this name may be of another format by its first bytes.
        Ok(file) if file.format() != Format::Triangle => use_file(&file),
        Ok(file) => {
            use_file(&file);
            // Of an earlier mesh, whose lines are not those of this one.
            drop(fs::remove_file(folder.join("again.poly")));
            file.write(&folder.join("again.node"), &file.mesh().points).unwrap();
            for ending in ["node", "ele"] {
                let [own, again] = ["fuzzed", "again"]
                    .map(|name| fs::read(folder.join(name).with_extension(ending)).unwrap());
                assert!(own == again, "a .{ending} that has not changed is written otherwise");
            }
        }
        Err(error) => assert_told(&error.to_string()),
    }
}

/// Checks that a message has one line, names the file, and is short enough to read.
fn assert_told(message: &str) {
    assert!(message.contains("fuzzed") && message.len() < 600, "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
}

fn use_file(file: &MeshFile) {
    let mesh = file.mesh();
    let vertices = mesh.points.len();
    let mut named = mesh.triangles.iter().flatten().chain(&mesh.fixed);
    assert!(named.all(|&v| (v as usize) < vertices), "a vertex that does not exist");
    assert_eq!(file.vertex_places(0..vertices as u32).len(), vertices);
    assert_eq!(file.triangle_places(0..mesh.triangles.len()).len(), mesh.triangles.len());
    if let Ok(groups) = file.groups() {
        for group in groups.iter() {
            assert!(group.vertices().iter().all(|&v| (v as usize) < vertices));
            assert!(group.triangles().iter().all(|&t| (t as usize) < mesh.triangles.len()));
        }
    }
    if let Ok(fields) = file.point_fields(None) {
        assert!(fields.iter().all(|f| f.values().len() == vertices * f.components()));
    }
    let _ = file.plane_parameters(&mesh.points);
    assert!(file.difference(file).is_none());
    write_moved(file);
    for (name, format) in Conversion::targets() {
        let Ok(Some(conversion)) = Conversion::new(file, format) else { continue };
        let Some(text) = conversion.text() else { continue };
        match MeshFile::from_bytes(Path::new("fuzzed"), text.into_bytes()) {
            Ok(again) => {
                // Some formats hold fewer digits.
                let stored = |point: &[f64; 2]| point.map(|x| again.precision().rounded(x));
                let points: Vec<_> = mesh.points.iter().map(stored).collect();
                assert!(again.mesh().points == points, "other points, written as {name}");
                let mut lists = [&again.mesh().triangles, &mesh.triangles].map(Vec::clone);
                if conversion.lost().iter().any(|lost| lost.starts_with("the order of triangles")) {
                    lists.iter_mut().for_each(|list| list.sort_unstable());
                }
                assert!(lists[0] == lists[1], "other triangles, written as {name}");
            }
            // What a damaged file holds need not be a valid mesh in each format.
            Err(error) => assert_told(&error.to_string()),
        }
    }
    if mesh.triangles.len() < 2000 {
        smooth(mesh, &Options { max_sweeps: 3, ..Options::default() }, &Backend::Cpu);
    }
}

/// Writes a file with every vertex elsewhere: what is read again must be that mesh, and nothing else may differ.
fn write_moved(file: &MeshFile) {
    if file.paths().count() > 1 {
        return;
    }
    let moved = |x: &f64| file.precision().rounded(x + x / 1024.0 + 1.0 / 64.0);
    let points: Vec<_> = file.mesh().points.iter().map(|[x, y]| [moved(x), moved(y)]).collect();
    let mut written = Vec::new();
    match file.write_to(Path::new("fuzzed"), &mut written, &points) {
        Ok(()) => {
            let again = MeshFile::from_bytes(Path::new("again"), written).unwrap();
            assert!(again.mesh().points == points, "a vertex is not where it was written");
            assert_eq!(again.mesh().triangles, file.mesh().triangles);
            assert_eq!(file.difference(&again), None);
        }
        Err(error) => assert_told(&error.to_string()),
    }
}

/// Takes numbers from bytes: zeros after the last one.
struct Bytes<'b>(std::slice::Iter<'b, u8>);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or_default()
    }

    fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }
}

/// Makes options and a small mesh from any bytes, and smooths it. The mesh may have holes, be tangled, tiny, huge or
/// stretched.
pub(crate) fn any_mesh(bytes: &[u8], backend: &Backend) -> Became {
    let mut bytes = Bytes(bytes.iter());
    let options = options(&mut bytes);
    let mesh = mesh(&mut bytes, options.stored);
    let became = smooth(&mesh, &options, backend);
    if became == Became::Smoothed {
        smooth_whole(&mut bytes, &mesh, options, backend);
    }
    became
}

/// Runs with targets, with vertices that slide, and with what only whole runs can do, as the bytes that are left say.
fn smooth_whole(bytes: &mut Bytes<'_>, mesh: &Mesh, options: Options, backend: &Backend) {
    let (what, which) = (bytes.byte(), bytes.below(4));
    if what == 0 {
        return;
    }
    let mut smoother = Smoother::new(mesh).unwrap();
    let options = Options {
        guard: if what & 1 != 0 { Guard::Worst } else { Guard::default() },
        keep_altitude: what & 2 != 0,
        max_move: (what & 4 != 0).then_some([1e-3, 0.1, 0.5, 2.0][which]),
        improve_worst: (what & 8 != 0).then_some(WorstBy::ALL[which % 3]),
        ..options
    };
    let rings = which as u32 % 3;
    let targets = match what >> 4 & 3 {
        1 => Targets::keep_size(smoother.topology(), &mesh.points, Surface::Plane, rings),
        2 => Targets::keep_shape(smoother.topology(), &mesh.points, rings),
        3 => {
            let sizes: Vec<f64> =
                mesh.points.iter().map(|_| 0.1 + f64::from(bytes.byte())).collect();
            Targets::sizes(&sizes)
        }
        _ => Ok(Targets::equilateral(mesh.points.len())),
    };
    let Ok(targets) = targets else { return };
    smoother.set_targets(&targets).unwrap();
    let slide = (what & 64 != 0).then(Slide::default);
    smoother.set_slide(slide.as_ref()).unwrap();
    let run = || smoother.run(&options, backend);
    let outcome = match run() {
        Ok(outcome) => outcome,
        Err(SmoothError::Option { .. } | SmoothError::Mesh(MeshError::BeyondPrecision { .. })) => {
            return;
        }
        Err(error) => panic!("{error}"),
    };
    let topology = smoother.topology();
    let bad = validity::infeasible(&outcome.points, topology.triangles()).unwrap();
    assert!(bad.is_empty(), "triangles {bad:?} are inverted or flat");
    // Without a line to slide along, this lists fixed vertices that have moved.
    let slide = slide.unwrap_or_else(|| {
        let held = (0..mesh.points.len() as u32).collect();
        Slide { held, ..Slide::default() }
    });
    let astray = slide.astray(topology, &mesh.points, &outcome.points, options.stored);
    // Where edges are no longer than some roundings of coordinates, these alone take vertices past one another.
    let is_told = options.stored == Precision::Double || !slide.held.is_empty();
    assert!(astray.is_empty() || !is_told, "vertices {astray:?} have left their lines");
    let f = |points: &[[f64; 2]]| smoother.f(options.scheme.base(), points).unwrap();
    let (start, end) = (f(&mesh.points), f(&outcome.points));
    let rises = options.improve_worst.is_some();
    assert!(rises || end <= start * (1.0 + 1e-12), "f rose from {start} to {end}");
    assert!(run().unwrap().points == outcome.points, "other points the second time");
}

/// The result for a mesh.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Became {
    Refused,
    Smoothed,
    Untangled,
    StillTangled,
}

fn options(bytes: &mut Bytes<'_>) -> Options {
    let metric = |i: usize| Metric::ALL[i % Metric::ALL.len()].name();
    let first = bytes.below(256);
    let scheme: Scheme = match first % 3 {
        0 => [metric(first), metric(first / 7)].join("+").parse().unwrap(),
        _ => metric(first / 3).parse().unwrap(),
    };
    let flags = bytes.byte();
    let mut options = Options {
        scheme,
        max_sweeps: bytes.below(25) as u32,
        method: if flags & 1 == 0 { Method::Auto } else { Method::Sweeps },
        stored: match flags & 14 {
            2 => Precision::Single,
            6 => Precision::Text20,
            10 => Precision::Text16,
            14 => Precision::Text8,
            _ => Precision::Double,
        },
        inner: if flags & 48 == 16 { 3 } else { 1 },
        ..Options::default()
    };
    if flags & 192 == 64 {
        options.sharpness = Some(Sharpness::CONTINUED);
    }
    if flags & 192 == 128 {
        options.derivatives = Derivatives::FiniteDifference;
    }
    options
}

fn mesh(bytes: &mut Bytes<'_>, stored: Precision) -> Mesh {
    let (columns, rows) = (1 + bytes.below(7), 1 + bytes.below(7));
    let stretch = 2f64.powi(i32::from(bytes.byte() as i8) / 12);
    let size = 2f64.powi(i32::from(bytes.byte() as i8) / 4);
    let offset = [0.0, 0.0, 1.0, 1e3, 1e6, -1e9][bytes.below(6)] * size;
    let disturbed = [0.0, 0.2, 0.5, 1.0, 4.0][bytes.below(5)];
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let mut away = || f64::from(bytes.byte() as i8) / 128.0 * disturbed;
            let (x, y) = (column as f64 + away(), row as f64 + away());
            let point = [x * size * stretch + offset, y * size - offset];
            mesh.points.push(point.map(|x| stored.rounded(x)));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = (row * (columns + 1) + column) as u32;
            let (b, c) = (a + 1, a + columns as u32 + 1);
            let what = bytes.byte();
            let halves = match what & 1 {
                0 => [[a, b, c], [b, c + 1, c]],
                _ => [[a, b, c + 1], [a, c + 1, c]],
            };
            for (half, mut triangle) in halves.into_iter().enumerate() {
                // Leaves out the triangle, or reverses its winding.
                if what >> (2 + half) & 7 == 7 {
                    continue;
                }
                if what >> (5 + half) & 3 == 3 {
                    triangle.swap(0, 1);
                }
                mesh.triangles.push(triangle);
            }
        }
    }
    // Sometimes fixed vertices, some of them named twice, and a triangle that does not fit in the plane.
    for _ in 0..bytes.below(6) {
        mesh.fixed.push(bytes.below(mesh.points.len()) as u32);
    }
    if bytes.byte() > 250 {
        let corner = || bytes.below(mesh.points.len()) as u32;
        let corners: Vec<u32> = std::iter::repeat_with(corner).take(3).collect();
        mesh.triangles.push([corners[0], corners[1], corners[2]]);
    }
    mesh
}

fn smooth(mesh: &Mesh, options: &Options, backend: &Backend) -> Became {
    let smoother = match Smoother::new(mesh) {
        Ok(smoother) => smoother,
        Err(MeshError::Infeasible { .. }) => return untangled(mesh, options),
        Err(_) => return Became::Refused,
    };
    let run = || smoother.run(options, backend);
    let outcome = match run() {
        Ok(outcome) => outcome,
        Err(SmoothError::Mesh(MeshError::BeyondPrecision { .. })) => return Became::Refused,
        Err(error) => panic!("{error}"),
    };
    let again = run().unwrap();
    let bits = |points: &[[f64; 2]]| points.iter().map(|p| p.map(f64::to_bits)).collect::<Vec<_>>();
    let (before, after) = (bits(&mesh.points), bits(&outcome.points));
    assert!(after == bits(&again.points), "other bits the second time");
    let topology = smoother.topology();
    for (vertex, (old, new)) in before.iter().zip(&after).enumerate() {
        assert!(topology.free()[vertex] || old == new, "vertex {vertex} is fixed and has moved");
    }
    let bad = validity::infeasible(&outcome.points, topology.triangles()).unwrap();
    assert!(bad.is_empty(), "triangles {bad:?} are inverted or flat");
    let f = |points: &[[f64; 2]]| smoother.quality(points).unwrap().f(options.scheme.base());
    let (start, end) = (f(&mesh.points), f(&outcome.points));
    assert!(end <= start * (1.0 + 1e-12), "f rose from {start} to {end}");
    assert_eq!(outcome.history.len() as u32, outcome.sweeps + 1);
    Became::Smoothed
}

/// Untangles a mesh with inverted triangles: it must not get worse, and what is reported as untangled must be valid.
fn untangled(mesh: &Mesh, options: &Options) -> Became {
    let mut go_on = |_: &gpu_smooth::Untangling| ControlFlow::Continue(());
    let Ok(untangled) = untangle(mesh, options.stored, &mut go_on) else { return Became::Refused };
    assert!(untangled.left.len() <= untangled.bad_before);
    let mended = Mesh { points: untangled.points, ..mesh.clone() };
    match Smoother::new(&mended) {
        Ok(smoother) => {
            // Those that are left are so flat that double precision cannot judge them.
            assert!(untangled.left.len() <= smoother.beyond_precision().len());
            for (vertex, free) in smoother.topology().free().iter().enumerate() {
                let bits = |mesh: &Mesh| mesh.points[vertex].map(f64::to_bits);
                assert!(*free || bits(mesh) == bits(&mended), "vertex {vertex} has moved");
            }
            Became::Untangled
        }
        Err(MeshError::Infeasible { .. }) => {
            assert!(!untangled.left.is_empty());
            Became::StillTangled
        }
        Err(_) => Became::Refused,
    }
}
