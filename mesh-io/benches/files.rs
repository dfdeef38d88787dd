//! Measures the speed of reading and writing mesh files in megabytes per second, beside plain copies of the same bytes.
//!
//! ```text
//! cargo bench -p mesh-io --bench files -- 1000000
//! ```
//!
//! All coordinates change before they are written. Files are in the system's temporary folder (`TMPDIR`). A written mesh is
//! forced to the disk, and so is its plain copy.

#[path = "../../benches/mesh.rs"]
mod mesh;

use divan::Bencher;
use divan::counter::BytesCount;
use mesh_io::MeshFile;
use std::fs::{self, File};
use std::io::Write;
use std::path::PathBuf;
use std::sync::Mutex;
use std::{array, fmt};
use support::Mesh;
use tempfile::TempDir;

fn main() {
    divan::main();
}

/// Cells along a side: a million and ten million vertices.
const SIDES: [usize; 2] = [999, 3161];

#[derive(Clone, Copy)]
enum Kind {
    Triangle,
    Gmsh22,
    Gmsh22Binary,
    Gmsh41,
    Gmsh41Binary,
}

const KINDS: [Kind; 5] =
    [Kind::Triangle, Kind::Gmsh22, Kind::Gmsh22Binary, Kind::Gmsh41, Kind::Gmsh41Binary];

#[derive(Clone, Copy)]
struct Case {
    size: usize,
    kind: Kind,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            Kind::Triangle => "triangle",
            Kind::Gmsh22 => "msh22",
            Kind::Gmsh22Binary => "msh22-binary",
            Kind::Gmsh41 => "msh41",
            Kind::Gmsh41Binary => "msh41-binary",
        };
        write!(f, "{kind}/{}", (SIDES[self.size] + 1).pow(2))
    }
}

fn cases() -> Vec<Case> {
    let kinds = |size| KINDS.into_iter().map(move |kind| Case { size, kind });
    (0..SIDES.len()).flat_map(kinds).collect()
}

/// The files of one mesh, removed when dropped.
struct Files {
    folder: TempDir,
    names: Vec<&'static str>,
}

impl Case {
    fn mesh(self) -> &'static Mesh {
        static MESHES: Mutex<[Option<&'static Mesh>; SIDES.len()]> =
            Mutex::new([None; SIDES.len()]);
        MESHES.lock().unwrap()[self.size]
            .get_or_insert_with(|| Box::leak(Box::new(mesh::irregular(SIDES[self.size], 1))))
    }

    fn files(self) -> Files {
        let folder = TempDir::new().unwrap();
        let mesh = self.mesh();
        let contents = match self.kind {
            Kind::Triangle => {
                let [node, ele] = support::triangle_text(mesh, "made by a benchmark");
                vec![("m.node", node.into_bytes()), ("m.ele", ele.into_bytes())]
            }
            Kind::Gmsh22 => vec![("m.msh", support::write_msh22(mesh).into_bytes())],
            Kind::Gmsh22Binary => vec![("m.msh", support::write_msh22_binary(mesh, false, true))],
            Kind::Gmsh41 => vec![("m.msh", support::write_msh41(mesh).into_bytes())],
            Kind::Gmsh41Binary => vec![("m.msh", support::write_msh41_binary(mesh, false))],
        };
        for (name, content) in &contents {
            fs::write(folder.path().join(name), content).unwrap();
        }
        Files { folder, names: contents.into_iter().map(|(name, _)| name).collect() }
    }
}

impl Files {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn size(&self, names: &[&str]) -> BytesCount {
        let size = |name: &&str| fs::metadata(self.path(name)).unwrap().len();
        BytesCount::new(names.iter().map(size).sum::<u64>())
    }
}

#[divan::bench(args = cases(), max_time = 4, sample_size = 1, sample_count = 10)]
fn read(bencher: Bencher, case: Case) {
    let files = case.files();
    let path = files.path(files.names[0]);
    bencher.counter(files.size(&files.names)).bench_local(|| MeshFile::read(&path).unwrap());
}

#[divan::bench(args = cases(), max_time = 4, sample_size = 1, sample_count = 10)]
fn read_plainly(bencher: Bencher, case: Case) {
    let files = case.files();
    bencher.counter(files.size(&files.names)).bench_local(|| -> Vec<Vec<u8>> {
        files.names.iter().map(|name| fs::read(files.path(name)).unwrap()).collect()
    });
}

#[divan::bench(args = cases(), max_time = 4, sample_size = 1, sample_count = 10)]
fn write(bencher: Bencher, case: Case) {
    let files = case.files();
    let file = MeshFile::read(&files.path(files.names[0])).unwrap();
    let points: Vec<[f64; 2]> =
        file.points().iter().map(|p| array::from_fn(|i| p[i] * (1.0 - 1e-9) + 1e-3)).collect();
    let out: Vec<String> = files.names.iter().map(|name| name.replace("m.", "out.")).collect();
    let out: Vec<&str> = out.iter().map(String::as_str).collect();
    file.write(&files.path(out[0]), &points).unwrap();
    bencher
        .counter(files.size(&out))
        .bench_local(|| file.write(&files.path(out[0]), &points).unwrap());
}

#[divan::bench(args = cases(), max_time = 4, sample_size = 1, sample_count = 10)]
fn write_plainly(bencher: Bencher, case: Case) {
    let files = case.files();
    let contents: Vec<_> =
        files.names.iter().map(|name| fs::read(files.path(name)).unwrap()).collect();
    bencher.counter(files.size(&files.names)).bench_local(|| {
        for (content, name) in contents.iter().zip(&files.names) {
            let mut file = File::create(files.path(&name.replace("m.", "out."))).unwrap();
            file.write_all(content).unwrap();
            file.sync_all().unwrap();
        }
    });
}
