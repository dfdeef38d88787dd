//! Meshes of quadrilaterals, alone and mixed with triangles: topology, untangling, runs on both engines and their results.

mod runs;
mod topology;
mod untangle;

use std::borrow::Cow;
use std::sync::OnceLock;

use gpu_smooth::{
    Backend, Gpu, Mesh, Options, Outcome, Smoother, internal::device_counts, layers::Layers,
};

/// Prepares a mesh whose boundary layers may move.
fn prepared(mesh: &Mesh) -> Smoother<'_> {
    Smoother::keeping(Cow::Borrowed(mesh), Layers::default()).unwrap()
}

fn run(mesh: &Mesh, options: &Options) -> Outcome {
    prepared(mesh).run(options).block().unwrap()
}

/// Runs on the CPU, then on a device. Panics without an adapter, because tests would then not cover the device.
fn on_both(smoother: &Smoother<'_>, options: &Options) -> [Outcome; 2] {
    static GPU: OnceLock<Backend> = OnceLock::new();
    let device = GPU.get_or_init(|| {
        let gpu = Gpu::open(None).block();
        Backend::Gpu(gpu.expect("these tests need a wgpu adapter, be it a software one"))
    });
    let Backend::Gpu(gpu) = device else { unreachable!() };
    let before = device_counts(gpu).dispatches;
    let outcomes =
        [&Backend::Cpu, device].map(|backend| smoother.run(options).on(backend).block().unwrap());
    assert!(device_counts(gpu).dispatches > before && outcomes[1].device_fault.is_none());
    outcomes
}

fn runs(mesh: &Mesh, options: &Options) -> [Outcome; 2] {
    on_both(&prepared(mesh), options)
}

/// Returns the corners of all elements: triangles, and four triangles for each quadrilateral.
fn corners(mesh: &Mesh) -> Vec<[u32; 3]> {
    let of = |&[a, b, c, d]: &[u32; 4]| [[a, b, d], [b, c, a], [c, d, b], [d, a, c]];
    mesh.triangles.iter().copied().chain(mesh.quadrilaterals.iter().flat_map(of)).collect()
}

fn doubled_area(points: &[[f64; 2]], corner: [u32; 3]) -> f64 {
    let [p, q, r] = corner.map(|v| points[v as usize]);
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

/// Returns whether all corners are counter-clockwise, with a margin for rounding.
fn is_convex(mesh: &Mesh, points: &[[f64; 2]]) -> bool {
    corners(mesh).into_iter().all(|corner| doubled_area(points, corner) > 1e-12)
}

/// Returns the squared inverse mean ratio of a corner by its definition: (|a|² + |b|²) / 2 a×b for a quadrilateral, and
/// (|a|² + |b|² + |b - a|²) / 2√3 a×b for a triangle.
fn squared_imr(points: &[[f64; 2]], corner: [u32; 3], is_right: bool) -> f64 {
    let [p, q, r] = corner.map(|v| points[v as usize]);
    let square = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2);
    let (sides, third) = (square(p, q) + square(p, r), square(q, r));
    let area = doubled_area(points, corner);
    let ratio =
        if is_right { sides / (2.0 * area) } else { (sides + third) / (12f64.sqrt() * area) };
    ratio * ratio
}

/// Returns f by imr: the mean over elements, a quadrilateral by the mean over its corners.
fn f(mesh: &Mesh, points: &[[f64; 2]]) -> f64 {
    let triangles = mesh.triangles.len();
    let sum: f64 = (0..)
        .zip(corners(mesh))
        .map(|(k, corner)| match k < triangles {
            true => squared_imr(points, corner, false),
            false => 0.25 * squared_imr(points, corner, true),
        })
        .sum();
    sum / (triangles + mesh.quadrilaterals.len()) as f64
}
