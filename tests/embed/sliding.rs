//! Frames in which vertices slide along curves.

use gpu_smooth::{
    Backend, Mesh, Method, Metric, Options, Slide, Smoother, Stop, Stopping,
    gpu::{DeviceMesh, Sweeps},
    options::{Precision, Relaxed},
    slide::Periodic,
    topology, wgpu,
};

use crate::app::{App, Vertices, bad_plate};

/// Makes a rectangle of 16 by 8 cells with unevenly spaced vertices, 17 in each row. The lowest side has y = 0.
fn channel() -> Mesh {
    let uneven = |k: u32, of: u32| {
        let x = f64::from(k) / f64::from(of);
        x + 0.08 * support::trig::on_circle(x)[1]
    };
    let at = |v: u32| [2.0 * uneven(v % 17, 16), uneven(v / 17, 8)];
    let cell = |k: u32| {
        let a = k / 16 * 17 + k % 16;
        [[a, a + 1, a + 18], [a, a + 18, a + 17]]
    };
    Mesh {
        points: (0..17 * 9).map(at).collect(),
        triangles: (0..16 * 8).flat_map(cell).collect(),
        ..Mesh::default()
    }
}

/// A mesh on the device of an application, with sliding vertices.
struct Sliding {
    app: App,
    mesh: Mesh,
    slide: Slide,
    device_mesh: DeviceMesh,
}

impl Sliding {
    fn new(mesh: Mesh, slide: Slide) -> Self {
        let app = App::new();
        let device_mesh = smoother(&mesh, &slide).to_device(&app.gpu).unwrap();
        Self { app, mesh, slide, device_mesh }
    }

    fn points(&self) -> Vec<[f64; 2]> {
        self.app.points(&self.device_mesh)
    }

    /// Returns the points after sweeps.
    fn swept(&self, sweeps: &mut Sweeps, count: u32) -> Vec<[f64; 2]> {
        self.app.submit(|encoder| sweeps.encode_sweeps(encoder, count));
        self.points()
    }

    fn sweeps(&self) -> Sweeps {
        Sweeps::new(&self.device_mesh, &Options::default()).block().unwrap()
    }

    /// Returns the vertices whose move sliding does not allow.
    fn misplaced(&self, points: &[[f64; 2]]) -> Vec<u32> {
        let smoother = smoother(&self.mesh, &self.slide);
        // A device keeps 48 bits of coordinates, of vertices that stay too.
        let known = |(&was, &now)| if distance(was, now) < 1e-12 { was } else { now };
        let points: Vec<_> = self.mesh.points.iter().zip(points).map(known).collect();
        self.slide.misplaced(smoother.topology(), &self.mesh.points, &points, Precision::Single)
    }
}

fn smoother<'m>(mesh: &'m Mesh, slide: &Slide) -> Smoother<'m> {
    let mut smoother = Smoother::new(mesh).unwrap();
    assert!(smoother.set_slide(Some(slide)).unwrap() > 0);
    smoother
}

fn distance([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (a - c).hypot(b - d)
}

#[test]
fn boundary_vertices_slide_in_frames_as_in_a_run() {
    let lines = |mesh: &Mesh| {
        let mut mesh = mesh.clone();
        // A line inside the mesh, whose vertices are fixed but for sliding.
        let middle = |row: u32| row * 17 + 8;
        let lines: Vec<[u32; 2]> = (0..8).map(|row| [middle(row), middle(row + 1)]).collect();
        mesh.fixed = lines.as_flattened().to_vec();
        (mesh, Slide { lines, ..Slide::default() })
    };
    let pairs = (0..9).map(|row| [17 * row, 17 * row + 16]).collect();
    let periodic = vec![Periodic { pairs, motion: None }];
    let plate = support::perturb_random(&bad_plate(600), 0.2, 2);
    for (mesh, slide) in [
        (channel(), Slide::default()),
        lines(&channel()),
        (channel(), Slide { periodic, ..Slide::default() }),
        (plate, Slide::default()),
    ] {
        let sliding = Sliding::new(mesh, slide);
        let points = sliding.swept(&mut sliding.sweeps(), 120);
        let smoother = smoother(&sliding.mesh, &sliding.slide);
        let stopping = Stopping::Tolerance(0.0);
        let method = Method::Relaxed(Relaxed::default());
        let options = Options::default().method(method).stopping(stopping).max_sweeps(120);
        let run = smoother.run(&options).on(&Backend::Cpu).block().unwrap();
        let [f, of_run] = [&points, &run.points].map(|p| smoother.f(Metric::Imr, p).unwrap());
        assert!((f / of_run - 1.0).abs() < 1e-4, "{f} {of_run}");
        assert_eq!(sliding.misplaced(&points), []);
        assert!(topology::infeasible(&points, &sliding.mesh.triangles).unwrap().is_empty());
        let slides = |v: &u32| sliding.mesh.points[*v as usize] != points[*v as usize];
        let all = sliding.slide.vertices(smoother.topology(), &sliding.mesh.points).unwrap();
        assert!(all.iter().filter(|v| slides(v)).count() > all.len() / 2);
    }
}

/// Sweeps with corrections and with a stop rule slide vertices too.
#[test]
fn vertices_slide_in_corrected_sweeps_that_end_by_themselves() {
    let sliding = Sliding::new(channel(), Slide::default());
    let options = |method| {
        Options::default().method(method).stopping(Stopping::Tolerance(1e-4)).max_sweeps(400)
    };
    let mut ends = Vec::new();
    for method in [Method::Auto, Method::Multilevel] {
        let sliding = Sliding::new(sliding.mesh.clone(), sliding.slide.clone());
        let mut sweeps =
            Sweeps::until_converged(&sliding.device_mesh, &options(method)).block().unwrap();
        let points = sliding.swept(&mut sweeps, 400);
        assert_eq!(sliding.app.objective(&sweeps).stop(), Some(Stop::Converged));
        assert_eq!(sliding.misplaced(&points), []);
        ends.push(smoother(&sliding.mesh, &sliding.slide).f(Metric::Imr, &points).unwrap());
    }
    assert!((ends[0] / ends[1] - 1.0).abs() < 1e-3, "{ends:?}");
}

#[test]
fn pins_and_masks_hold_sliding_vertices_with_their_partners() {
    let pairs = (0..9).map(|row| [17 * row, 17 * row + 16]).collect();
    let periodic = vec![Periodic { pairs, motion: None }];
    let sliding = Sliding::new(channel(), Slide { periodic, ..Slide::default() });
    let mut sweeps = sliding.sweeps();
    let mut moved = || {
        let before = sliding.points();
        let after = sliding.swept(&mut sweeps, 1);
        move |v: u32| before[v as usize] != after[v as usize]
    };
    // Vertices of a pair, and a vertex of the lower side.
    let (first, second, below) = (3 * 17, 3 * 17 + 16, 5);
    sliding.device_mesh.pin(&[second, below]).unwrap();
    let has_moved = moved();
    assert_eq!([first, second, below].map(has_moved), [false; 3]);
    sliding.device_mesh.unpin(&[second]).unwrap();
    let has_moved = moved();
    assert_eq!([first, second, below].map(has_moved), [true, true, false]);
    sliding.device_mesh.set_pinned(&[]).unwrap();
    let words: Vec<u32> =
        (0..sliding.mesh.points.len() as u32).map(|v| (v == first).into()).collect();
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    let mask = sliding.app.buffer(4 * words.len() as u64, usage);
    sliding.app.gpu.queue().write_buffer(&mask, 0, bytemuck::cast_slice(&words));
    let bound = sliding.device_mesh.bind_mask(mask.slice(..)).unwrap();
    sliding.app.submit(|encoder| bound.encode_mask(encoder));
    let has_moved = moved();
    assert_eq!([first, second, below].map(has_moved), [false, false, true]);
}

/// A pinned vertex of no triangle held all vertices that slide without a partner.
#[test]
fn a_pinned_vertex_of_no_triangle_holds_no_other() {
    let mut mesh = channel();
    mesh.points.push([5.0, 5.0]);
    let unused = mesh.points.len() as u32 - 1;
    let sliding = Sliding::new(mesh, Slide::default());
    sliding.device_mesh.set_pinned(&[unused, 5]).unwrap();
    let before = sliding.points();
    let after = sliding.swept(&mut sliding.sweeps(), 2);
    let has_moved = |v: usize| before[v] != after[v];
    assert_eq!([unused as usize, 5].map(has_moved), [false; 2]);
    assert!((1..16).filter(|v| *v != 5).all(has_moved));
}

#[test]
fn a_moved_vertex_slides_on_from_a_place_on_its_curve_and_stays_elsewhere() {
    let sliding = Sliding::new(channel(), Slide::default());
    let vertices = Vertices::usual(&sliding.app, &sliding.mesh);
    let bound = vertices.bind(&sliding.device_mesh);
    let mut sweeps = sliding.sweeps();
    let mut frame = |count: u32| {
        sliding.app.submit(|encoder| {
            bound.encode_import(encoder);
            sweeps.encode_sweeps(encoder, count);
            bound.encode_export(encoder);
        });
        sliding.points()
    };
    let rest = frame(200);
    // A vertex of the lower side is moved along the side, and another into the mesh.
    let (along, off) = (5_usize, 11_usize);
    let shift = 0.4 * (rest[along + 1][0] - rest[along][0]);
    vertices.put(&sliding.app, along as u32, [rest[along][0] + shift, 0.0]);
    let inward = [rest[off][0], 0.2 * rest[off + 17][1]];
    vertices.put(&sliding.app, off as u32, inward);
    let next = frame(1);
    let still = |at: &[f64; 2]| distance(*at, inward) < 1e-6;
    assert!(still(&next[off]) && next[along][1] == 0.0, "{:?}", [next[off], next[along]]);
    let end = frame(200);
    assert!(still(&end[off]));
    assert!(distance(end[along], rest[along]) < 0.1 * shift, "{:?}", [end[along], rest[along]]);
    // Back on its curve, the vertex slides again.
    vertices.put(&sliding.app, off as u32, [rest[off][0] + 0.3 * shift, 0.0]);
    let back = frame(200);
    assert!(distance(back[off], rest[off]) < 0.1 * shift, "{:?}", [back[off], rest[off]]);
}

#[test]
fn a_restored_frame_slides_on() {
    let sliding = Sliding::new(channel(), Slide::default());
    let vertices = Vertices::usual(&sliding.app, &sliding.mesh);
    let bound = vertices.bind(&sliding.device_mesh);
    let last_valid = sliding.device_mesh.keep_last_valid().unwrap();
    let mut sweeps = sliding.sweeps();
    let mut frame = || {
        sliding.app.submit(|encoder| {
            bound.encode_import(encoder);
            sweeps.encode_sweeps(encoder, 3);
            last_valid.encode_restore_last_valid(encoder);
            bound.encode_export(encoder);
        });
        sliding.points()
    };
    let good = frame();
    // Off its curve, a vertex stays, so that sweeps cannot mend the frame.
    vertices.put(&sliding.app, 8, [5.0, 5.0]);
    assert!(frame() == good);
    let next = frame();
    let slides = |v: u32| next[v as usize] != good[v as usize] && next[v as usize][1] == 0.0;
    assert!((1..16).filter(|&v| slides(v)).count() > 8);
    assert_eq!(sliding.misplaced(&next), []);
}
