//! Durations of the phases of preparing a mesh, and of judging and certifying a result.
//!
//! ```text
//! cargo bench --bench prepare -- 1000000
//! ```
//!
//! Meshes of `rows` are numbered row by row, those of `mixed` at random.

mod mesh;

use divan::Bencher;
use divan::counter::ItemsCount;
use gpu_smooth::{
    Mesh, Quality, Smoother, Topology,
    internal::{Coloring, Problem},
    topology::certify,
};
use std::fmt;
use std::sync::Mutex;

fn main() {
    divan::main();
}

/// Cells along a side, for 57 thousand, a million and ten million vertices.
const SIDES: [usize; 3] = [238, 999, 3161];

#[derive(Clone, Copy)]
struct Case {
    size: usize,
    mixed: bool,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let order = if self.mixed { "mixed" } else { "rows" };
        write!(f, "{order}/{}", (SIDES[self.size] + 1).pow(2))
    }
}

fn cases() -> Vec<Case> {
    let sizes = |mixed| (0..SIDES.len()).map(move |size| Case { size, mixed });
    sizes(false).chain(sizes(true)).collect()
}

impl Case {
    fn mesh(self) -> &'static Mesh {
        static MESHES: Mutex<Vec<(usize, bool, &'static Mesh)>> = Mutex::new(Vec::new());
        let mut meshes = MESHES.lock().unwrap();
        if let Some(&(.., mesh)) = meshes.iter().find(|m| (m.0, m.1) == (self.size, self.mixed)) {
            return mesh;
        }
        let mesh = if self.mixed { mesh::mixed } else { mesh::irregular };
        let mesh: &Mesh = Box::leak(Box::new(mesh(SIDES[self.size], 1)));
        meshes.push((self.size, self.mixed, mesh));
        mesh
    }

    fn bench<T>(self, bencher: Bencher, work: impl Fn() -> T) {
        bencher.counter(ItemsCount::new(self.mesh().points.len())).bench_local(work);
    }
}

#[divan::bench(args = cases(), max_time = 2, sample_size = 1, sample_count = 10)]
fn topology(bencher: Bencher, case: Case) {
    case.bench(bencher, || Topology::new(case.mesh()).unwrap());
}

#[divan::bench(args = cases(), max_time = 2, sample_size = 1, sample_count = 10)]
fn check(bencher: Bencher, case: Case) {
    let topology = Topology::new(case.mesh()).unwrap();
    case.bench(bencher, || topology.check_smoothable(&case.mesh().points).unwrap());
}

#[divan::bench(args = cases(), max_time = 2, sample_size = 1, sample_count = 10)]
fn coloring(bencher: Bencher, case: Case) {
    let topology = Topology::new(case.mesh()).unwrap();
    case.bench(bencher, || Coloring::new(&topology));
}

#[divan::bench(args = cases(), max_time = 2, sample_size = 1, sample_count = 10)]
fn problem(bencher: Bencher, case: Case) {
    let topology = Topology::new(case.mesh()).unwrap();
    let coloring = Coloring::new(&topology);
    case.bench(bencher, || Problem::new(case.mesh(), &topology, &coloring));
}

#[divan::bench(args = cases(), max_time = 2, sample_size = 1, sample_count = 10)]
fn quality(bencher: Bencher, case: Case) {
    let topology = Topology::new(case.mesh()).unwrap();
    case.bench(bencher, || Quality::of(&case.mesh().points, &topology).unwrap());
}

#[divan::bench(args = cases(), max_time = 2, sample_size = 1, sample_count = 10)]
fn certificate(bencher: Bencher, case: Case) {
    let topology = Topology::new(case.mesh()).unwrap();
    let mut points = case.mesh().points.clone();
    let before = points.clone();
    bencher
        .counter(ItemsCount::new(points.len()))
        .bench_local(|| certify(&topology, &before, &mut points).unwrap());
}

/// Measures all phases before the first sweep.
#[divan::bench(args = cases(), max_time = 2, sample_size = 1, sample_count = 10)]
fn smoother(bencher: Bencher, case: Case) {
    case.bench(bencher, || Smoother::new(case.mesh()).unwrap());
}
