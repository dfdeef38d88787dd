//! Meshes in which the application inverts triangles between two frames.

use gpu_smooth::{
    Mesh, Method, Metric, Options, Quality, Topology,
    gpu::Sweeps,
    options::{Derivatives, Paper},
};

use crate::app::{App, Vertices, bad_plate, interior};
use support::{is_ccw, orientations};

/// Displacement of a vertex by the application, relative to the two neighbors in one triangle.
#[derive(Clone, Copy, Debug)]
enum Throw {
    /// Past a neighbor, out of the star.
    Out,
    /// Onto a neighbor: some triangles become flat, and two of them degenerate to an edge.
    Onto,
    /// Onto the middle of an edge of the star: one triangle becomes flat.
    Flat,
    /// So far that areas are large, but still finite in floats.
    Far,
}

impl Throw {
    fn apply(self, mesh: &Mesh, v: u32) -> [f64; 2] {
        let [mut a, mut b, mut c] = *mesh.triangles.iter().find(|t| t.contains(&v)).unwrap();
        while a != v {
            [a, b, c] = [b, c, a];
        }
        let [p, q, r] = [a, b, c].map(|v| mesh.points[v as usize]);
        [0, 1].map(|x| match self {
            Throw::Out => p[x] + 2.5 * (q[x] - p[x]),
            Throw::Onto => q[x],
            Throw::Flat => 0.5 * (q[x] + r[x]),
            Throw::Far => [1e15, -1e12][x],
        })
    }
}

/// Returns the plate, and the plate with every 50th free vertex displaced. Coordinates are exact in floats, so that
/// flat triangles stay flat.
fn broken(throw: Throw) -> (Mesh, Mesh) {
    let mut sound = bad_plate(900);
    let exact = |x: f64| (x * 65536.0).round() / 65536.0;
    sound.points.iter_mut().for_each(|point| *point = point.map(exact));
    assert!(is_ccw(&sound));
    let mut broken = sound.clone();
    for v in interior(&sound).into_iter().step_by(50) {
        broken.points[v as usize] = throw.apply(&sound, v);
    }
    (sound, broken)
}

/// Returns the mesh without the triangles that share a vertex with a broken triangle.
fn clean(mesh: &Mesh) -> Mesh {
    let mut at_broken = vec![false; mesh.points.len()];
    for (triangle, _) in mesh.triangles.iter().zip(orientations(mesh)).filter(|(_, o)| *o != 1) {
        triangle.iter().for_each(|&v| at_broken[v as usize] = true);
    }
    let is_clean = |t: &&[u32; 3]| t.iter().all(|&v| !at_broken[v as usize]);
    let triangles: Vec<_> = mesh.triangles.iter().filter(is_clean).copied().collect();
    assert!(triangles.len() > mesh.triangles.len() / 2 && triangles.len() < mesh.triangles.len());
    Mesh { points: mesh.points.clone(), triangles, ..Mesh::default() }
}

#[test]
fn sweeps_leave_no_nan_invert_nothing_and_improve_the_rest() {
    for throw in [Throw::Out, Throw::Onto, Throw::Flat, Throw::Far] {
        let (sound, broken) = broken(throw);
        let clean = clean(&broken);
        let topology = Topology::new(&clean).unwrap();
        let bad = |points: &[[f64; 2]]| {
            let signs = orientations(&Mesh { points: points.to_vec(), ..sound.clone() });
            signs.into_iter().filter(|&sign| sign != 1).count()
        };
        for (&metric, derivatives) in Metric::ALL
            .iter()
            .flat_map(|m| [(m, Derivatives::Analytic), (m, Derivatives::FiniteDifference)])
        {
            let app = App::new();
            let device_mesh = app.mesh(&sound);
            let method = Method::Paper(Paper { derivatives, ..Paper::default() });
            let options = Options::default().scheme(metric.into()).method(method);
            let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
            let vertices = Vertices::usual(&app, &broken);
            app.submit(|encoder| {
                vertices.bind(&device_mesh).encode_import(encoder);
            });
            let start = app.points(&device_mesh);
            assert!(bad(&start) > 10);
            app.submit(|encoder| sweeps.encode_sweeps(encoder, 20));
            let end = app.points(&device_mesh);

            let case = format!("{throw:?}, {metric}, {derivatives:?}");
            assert!(end.as_flattened().iter().all(|x| x.is_finite()), "{case}: not finite");
            assert!(bad(&end) <= bad(&start), "{case}: {} of {}", bad(&end), bad(&start));
            let f = |points: &[[f64; 2]]| Quality::of(points, &topology).unwrap().f(metric);
            assert!(f(&end) < f(&start), "{case}: {} after {}", f(&end), f(&start));
        }
    }
}

#[test]
fn a_mesh_that_the_application_mends_is_smoothed_again() {
    let (sound, broken) = broken(Throw::Out);
    let app = App::new();
    let device_mesh = app.mesh(&sound);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    for mesh in [&broken, &sound] {
        let vertices = Vertices::usual(&app, mesh);
        app.submit(|encoder| {
            vertices.bind(&device_mesh).encode_import(encoder);
            sweeps.encode_sweeps(encoder, 20);
        });
    }
    let points = app.points(&device_mesh);
    let topology = Topology::new(&sound).unwrap();
    let quality = Quality::of(&points, &topology).unwrap();
    assert_eq!(quality.inverted, 0);
    assert!(quality.f(Metric::Imr) < 1.15 && quality.worst_imr < 3.0, "{quality:?}");
}
