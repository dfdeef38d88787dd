//! Untangling on the device of a mesh that the application has tangled, within some frames.

use gpu_smooth::{
    Mesh, MeshError, Options, SmoothError, Targets,
    gpu::{BoundVertices, DeviceMesh, ObjectiveValues, Sweeps, UntanglingSweeps},
};

use crate::app::{App, Vertices, bad_plate, filler, interior, plate};
use support::{SplitMix64, orientations, tangle};

/// Counts the inverted or flat triangles, by exact predicates.
fn bad(mesh: &Mesh, points: &[[f64; 2]]) -> usize {
    let mesh = Mesh { points: points.to_vec(), ..mesh.clone() };
    orientations(&mesh).into_iter().filter(|&sign| sign != 1).count()
}

/// An application that untangles and smooths a mesh in each frame.
struct Frames {
    app: App,
    mesh: Mesh,
    vertices: Vertices,
    bound: BoundVertices,
    untangling: UntanglingSweeps,
    sweeps: Sweeps,
    device_mesh: DeviceMesh,
}

impl Frames {
    fn new(mesh: Mesh) -> Self {
        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        Self::of(app, mesh, device_mesh)
    }

    fn of(app: App, mesh: Mesh, device_mesh: DeviceMesh) -> Self {
        let sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
        let untangling = UntanglingSweeps::new(&device_mesh).unwrap();
        // The buffer has words of the application before, between and after the coordinates.
        let vertices = Vertices::new(&app, &mesh, 20, 16);
        let bound = vertices.bind(&device_mesh);
        Self { app, mesh, vertices, bound, untangling, sweeps, device_mesh }
    }

    /// Executes a frame with `untangling` untangling sweeps and `sweeps` ordinary sweeps.
    fn frame(&mut self, untangling: u32, sweeps: u32) -> ObjectiveValues {
        let Self { app, bound, .. } = self;
        app.submit(|encoder| {
            bound.encode_import(encoder);
            self.untangling.encode_untangle(encoder, untangling);
            self.sweeps.encode_sweeps(encoder, sweeps);
            bound.encode_export(encoder);
        });
        app.objective(&self.sweeps)
    }

    /// Executes frames with five untangling and three ordinary sweeps, until no triangle is inverted. Returns the
    /// number of frames.
    fn frames_until_valid(&mut self) -> usize {
        let valid = (1..100).find(|_| self.frame(5, 3).inverted == 0);
        valid.unwrap_or_else(|| panic!("{} stay inverted", bad(&self.mesh, &self.points())))
    }

    /// Returns the mesh with its current positions on the device.
    fn as_it_is(&self) -> Mesh {
        Mesh { points: self.points(), ..self.mesh.clone() }
    }

    fn points(&self) -> Vec<[f64; 2]> {
        self.app.points(&self.device_mesh)
    }

    fn put(&self, vertex: u32, to: [f64; 2]) {
        self.vertices.put(&self.app, vertex, to);
    }
}

/// Returns a point beyond the edge opposite to `v` in one of its triangles. The distance to the middle of the edge is
/// the fraction `share` of the distance from `v` to the middle.
fn beyond(mesh: &Mesh, v: u32, share: f64) -> [f64; 2] {
    let [mut a, mut b, mut c] = *mesh.triangles.iter().find(|t| t.contains(&v)).unwrap();
    while a != v {
        [a, b, c] = [b, c, a];
    }
    let [p, q, r] = [a, b, c].map(|v| mesh.points[v as usize]);
    [0, 1].map(|i| p[i] + (1.0 + share) * (0.5 * (q[i] + r[i]) - p[i]))
}

fn hole(mesh: &Mesh) -> Vec<u32> {
    let on_hole = |p: [f64; 2]| (p[0] - 1.2).hypot(p[1] - 1.0) < 0.5001;
    (0..mesh.points.len() as u32).filter(|&v| on_hole(mesh.points[v as usize])).collect()
}

#[test]
fn a_mesh_that_is_tangled_from_the_start_is_untangled() {
    let mesh = tangle::noisy(&plate(800), 1.0, 7);
    let app = App::new();
    assert!(bad(&mesh, &mesh.points) > 100 && DeviceMesh::new(&app.gpu, &mesh).is_err());
    let device_mesh = DeviceMesh::tangled(&app.gpu, &mesh).unwrap();
    let mut frames = Frames::of(app, mesh, device_mesh);
    let count = frames.frames_until_valid();
    assert_eq!(bad(&frames.mesh, &frames.points()), 0, "{count} frames");
    let mut broken = frames.mesh.clone();
    broken.points[3][0] = f64::NAN;
    assert!(DeviceMesh::tangled(&frames.app.gpu, &broken).is_err());
}

/// Positions of such meshes were NaN on the device.
#[test]
fn meshes_that_no_placement_in_the_plane_untangles_are_refused() {
    let app = App::new();
    let error = |mesh: &Mesh| match DeviceMesh::tangled(&app.gpu, mesh) {
        Err(SmoothError::Mesh(error)) => error,
        other => panic!("{:?}", other.err()),
    };
    let square = plate(200);
    let flat = square.points.iter().map(|&[x, _]| [x, 0.5 * x]).collect();
    let at_one_place = vec![[0.3, 0.7]; square.points.len()];
    for points in [flat, at_one_place] {
        let mesh = Mesh { points, ..square.clone() };
        assert!(matches!(error(&mesh), MeshError::Infeasible { .. }), "{:?}", error(&mesh));
    }
    let tetrahedron = Mesh {
        points: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 0.3]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        ..Mesh::default()
    };
    assert!(matches!(error(&tetrahedron), MeshError::Closed { .. }), "{:?}", error(&tetrahedron));
}

#[test]
fn a_vertex_beyond_an_edge_of_its_ring_comes_back_in_the_next_frame() {
    for share in [0.2, 1.0, 3.0] {
        let mut frames = Frames::new(plate(600));
        frames.frame(0, 20);
        let good = frames.as_it_is();
        for v in interior(&good).into_iter().step_by(50) {
            frames.put(v, beyond(&good, v, share));
        }
        // Ordinary sweeps do not turn triangles back.
        assert!(frames.frame(0, 105).inverted > 5);
        let taken = frames.frames_until_valid();
        assert!(taken <= 2, "{share}: {taken} frames");
        assert_eq!(bad(&good, &frames.points()), 0);
        let values = frames.frame(5, 30);
        assert!(values.inverted == 0 && values.worst_imr < 1.5, "{share}: {values:?}");
    }
}

#[test]
fn a_hole_dragged_too_far_and_home_again_is_repaired() {
    for (far, steps) in [(1.5, 1i32), (-1.5, 10), (3.0, 30)] {
        let mut frames = Frames::new(plate(600));
        frames.frame(0, 20);
        let hole = hole(&frames.mesh);
        assert!(hole.len() > 20);
        for step in 1..=2 * steps {
            let part = f64::from(steps - (step - steps).abs()) / f64::from(steps);
            for &v in &hole {
                let [x, y] = frames.mesh.points[v as usize];
                frames.put(v, [x + far * part, y]);
            }
            frames.frame(0, 3);
        }
        assert!(frames.frame(0, 105).inverted > 20);
        let taken = frames.frames_until_valid();
        assert!(taken <= 5, "{far} in {steps}: {taken} frames");
        assert_eq!(bad(&frames.mesh, &frames.points()), 0);
        let values = frames.frame(5, 100);
        assert!(values.worst_imr < 1.5, "{far} in {steps}: {values:?}");
    }
}

#[test]
fn untangled_in_every_frame_of_a_drag_a_mesh_is_valid_again_when_it_can_be() {
    let mut frames = Frames::new(plate(600));
    let hole = hole(&frames.mesh);
    let mut inverted = Vec::new();
    for step in 1..=40 {
        let part = f64::from(20 - (step - 20i32).abs()) / 20.0;
        for &v in &hole {
            let [x, y] = frames.mesh.points[v as usize];
            frames.put(v, [x + 1.6 * part, y]);
        }
        inverted.push(frames.frame(5, 3).inverted);
    }
    // At its largest displacement, the hole is partly outside of the plate.
    assert!(inverted[19] > 10 && inverted[..5] == [0; 5], "{inverted:?}");
    assert!(inverted[36..] == [0; 4], "{inverted:?}");
    let words = frames.app.read(&frames.vertices.buffer);
    let own = |word: usize| word < 5 || !(word - 5).is_multiple_of(4) && (word - 5) % 4 != 1;
    assert!((0..words.len()).filter(|&word| own(word)).all(|word| words[word] == filler(word)));
}

#[test]
fn vertices_thrown_anywhere_come_back() {
    let mut frames = Frames::new(bad_plate(600));
    let good = frames.mesh.clone();
    let neighbor = |v: u32| {
        let triangle = good.triangles.iter().find(|t| t.contains(&v)).unwrap();
        *triangle.iter().find(|&&k| k != v).unwrap()
    };
    for (i, v) in interior(&good).into_iter().step_by(40).enumerate() {
        let to = match i % 4 {
            0 => good.points[neighbor(v) as usize],
            1 => [1e6, -1e3],
            2 => [40.0, -3.0],
            _ => beyond(&good, v, 0.0),
        };
        frames.put(v, to);
    }
    assert!(frames.frame(0, 0).inverted > 15);
    let taken = frames.frames_until_valid();
    assert!(taken <= 4, "{taken} frames");
    assert!(frames.points().as_flattened().iter().all(|x| x.is_finite()));
}

#[test]
fn vertices_at_random_places_are_put_in_order() {
    let mut frames = Frames::new(plate(600));
    let mut rng = SplitMix64::new(5);
    for v in interior(&frames.mesh) {
        frames.put(v, [rng.range(0.0, 3.0), rng.range(0.0, 2.0)]);
    }
    assert!(frames.frame(0, 0).inverted > 400);
    let taken = frames.frames_until_valid();
    assert!(taken <= 30, "{taken} frames");
    assert_eq!(bad(&frames.mesh, &frames.points()), 0);
    assert!(frames.frame(5, 100).worst_imr < 1.5);
}

#[test]
fn a_valid_mesh_keeps_every_bit_and_only_vertices_near_inverted_triangles_move() {
    let mut frames = Frames::new(bad_plate(600));
    let before = frames.points();
    assert_eq!(frames.frame(20, 0).inverted, 0);
    assert_eq!(frames.points(), before);
    // Untangling leaves a valid mesh unchanged, so sweeps that have ended do not restart.
    let options = Options::default().max_sweeps(1);
    let mut judged = Sweeps::until_converged(&frames.device_mesh, &options).block().unwrap();
    frames.app.submit(|encoder| judged.encode_sweeps(encoder, 1));
    frames.app.submit(|encoder| frames.untangling.encode_untangle(encoder, 5));
    assert!(frames.app.objective(&judged).stop().is_some());
    frames.app.submit(|encoder| frames.bound.encode_export(encoder));

    let good = frames.as_it_is();
    let v = interior(&good)[100];
    frames.put(v, beyond(&good, v, 0.2));
    assert!(frames.frame(0, 0).inverted > 0);
    assert_eq!(frames.frame(2, 0).inverted, 0);
    assert!(frames.app.objective(&judged).stop().is_none());
    let now = frames.points();
    let moved = |v: u32| now[v as usize] != good.points[v as usize];
    let count = interior(&good).into_iter().filter(|&v| moved(v)).count();
    assert!(moved(v) && count < 60, "{count} vertices moved");
    // A valid mesh is left unchanged. A later tangle wakes only vertices nearby.
    frames.frame(5, 0);
    assert_eq!(frames.points(), now);
    let other = *interior(&good).last().unwrap();
    let [x, y] = frames.points()[other as usize];
    frames.put(other, beyond(&frames.as_it_is(), other, 0.2));
    assert_eq!(frames.frame(2, 0).inverted, 0);
    let far = |p: [f64; 2]| (p[0] - x).hypot(p[1] - y) > 1.0;
    let then = frames.points();
    assert!(now.iter().zip(&then).filter(|(a, _)| far(**a)).all(|(a, b)| a == b));
}

#[test]
fn held_vertices_stay_and_tangles_beyond_repair_move_nothing() {
    let mut frames = Frames::new(plate(600));
    let good = frames.as_it_is();
    let v = interior(&good)[100];
    // The neighbors of a pinned vertex move away until its triangles are valid.
    frames.device_mesh.pin(&[v]).unwrap();
    frames.put(v, beyond(&good, v, 0.2));
    frames.frame(0, 0);
    let held = frames.points()[v as usize];
    frames.frames_until_valid();
    assert_eq!(frames.points()[v as usize], held);

    // If the neighbors are pinned too, no triangle can be repaired and no vertex moves.
    let all: Vec<u32> = (0..good.points.len() as u32).collect();
    let ring: Vec<u32> =
        good.triangles.iter().filter(|t| t.contains(&v)).flatten().copied().collect();
    frames.device_mesh.set_pinned(&ring).unwrap();
    frames.put(v, beyond(&good, v, 9.0));
    assert!(frames.frame(0, 0).inverted > 0);
    let before = frames.points();
    frames.frame(5, 0);
    let now = frames.points();
    let held = |v: &u32| now[*v as usize] == before[*v as usize];
    assert!(ring.iter().all(held));
    frames.device_mesh.set_pinned(&all).unwrap();
    assert!(frames.frame(5, 3).inverted > 0);
    assert_eq!(frames.points(), now);
}

#[test]
fn a_mesh_with_targets_is_untangled_as_they_show_it() {
    let mesh = plate(600);
    let stretched = vec![[9.0, 0.0, 1.0]; mesh.points.len()];
    let targets = Targets::tensors(&stretched).unwrap();
    let app = App::new();
    let device_mesh = DeviceMesh::with_targets(&app.gpu, &mesh, &targets).unwrap();
    let mut frames = Frames::of(app, mesh, device_mesh);
    frames.frame(0, 100);
    let good = frames.as_it_is();
    for v in interior(&good).into_iter().step_by(50) {
        frames.put(v, beyond(&good, v, 1.0));
    }
    assert!(frames.frame(0, 0).inverted > 5);
    assert!(frames.frames_until_valid() <= 3);
    assert_eq!(bad(&good, &frames.points()), 0);
}

#[test]
fn encoding_frame_after_frame_allocates_nothing() {
    let frames = Frames::new(plate(300));
    let v = interior(&frames.mesh)[50];
    let mut made = Vec::new();
    for i in 0..60 {
        frames.put(v, [0.1, 0.1 * f64::from(i % 10)]);
        let Frames { app, bound, .. } = &frames;
        app.submit(|encoder| {
            bound.encode_import(encoder);
            frames.untangling.encode_untangle(encoder, 3);
            bound.encode_export(encoder);
        });
        app.device().poll(gpu_smooth::wgpu::PollType::wait_indefinitely()).unwrap();
        let report = app.device().generate_allocator_report().expect("a backend that reports");
        made.push((report.allocations.len(), report.total_allocated_bytes));
    }
    assert!(made[10..].windows(2).all(|pair| pair[0] == pair[1]), "{made:?}");
}
