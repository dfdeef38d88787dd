//! Vertices that the application pins, masks and releases.

use gpu_smooth::{
    GpuError, Mesh, MeshError, Options, SmoothError,
    gpu::{DeviceMesh, Sweeps},
    wgpu,
};

use crate::app::{App, bad_plate, interior};

struct Held {
    app: App,
    mesh: Mesh,
    device_mesh: DeviceMesh,
    sweeps: Sweeps,
}

impl Held {
    fn new(mesh: Mesh) -> Self {
        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        let sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
        Self { app, mesh, device_mesh, sweeps }
    }

    fn hold(&self, which: &[u32]) {
        self.device_mesh.set_pinned(which).unwrap();
    }

    fn points(&self) -> Vec<[f64; 2]> {
        self.app.points(&self.device_mesh)
    }

    /// Returns the vertices that three sweeps move.
    fn moved(&mut self) -> Vec<u32> {
        let before = self.points();
        self.app.submit(|encoder| self.sweeps.encode_sweeps(encoder, 3));
        let after = self.points();
        (0..).zip(before.iter().zip(&after)).filter(|(_, (b, a))| a != b).map(|(v, _)| v).collect()
    }
}

#[test]
fn set_pinned_holds_and_releases() {
    let mut held = Held::new(bad_plate(600));
    let free = interior(&held.mesh);
    // Every third free vertex, including the first and the last.
    let (third, others): (Vec<u32>, Vec<u32>) = free.iter().partition(|&v| v % 3 == 0);
    let within = |part: &[u32], whole: &[u32]| part.iter().all(|v| whole.contains(v));

    held.hold(&third);
    let moved = held.moved();
    assert!(within(&moved, &others) && moved.len() > others.len() / 2);
    held.hold(&others);
    let moved = held.moved();
    assert!(within(&moved, &third) && moved.len() > third.len() / 2);
    held.hold(&free);
    assert_eq!(held.moved(), []);
    held.hold(&[]);
    let moved = held.moved();
    assert!(within(&moved, &free) && moved.len() > free.len() / 2);
}

#[test]
fn each_single_vertex_can_be_held() {
    let mut held = Held::new(bad_plate(150));
    for v in interior(&held.mesh) {
        held.hold(&[v]);
        assert!(!held.moved().contains(&v), "vertex {v}");
    }
}

#[test]
fn unpinning_all_leaves_the_boundary_fixed() {
    let mut held = Held::new(bad_plate(600));
    held.hold(&[]);
    let free = interior(&held.mesh);
    assert!(held.moved().iter().all(|v| free.contains(v)));
}

#[test]
fn pins_take_effect_in_command_buffers_submitted_later() {
    let mut held = Held::new(bad_plate(600));
    let free = interior(&held.mesh);
    let before = held.points();
    let mut encoder = held.app.encoder();
    held.sweeps.encode_sweeps(&mut encoder, 2);
    held.hold(&free);
    held.app.gpu.queue().submit([encoder.finish()]);
    assert_eq!(held.points(), before);
}

/// A former defect: unpinning released fixed vertices of the mesh.
#[test]
fn fixed_vertices_of_the_mesh_stay_whatever_is_pinned() {
    let mesh = bad_plate(600);
    let free = interior(&mesh);
    let fixed: Vec<u32> = free.iter().copied().step_by(4).collect();
    let mut held = Held::new(Mesh { fixed: fixed.clone(), ..mesh });
    let stays = |moved: Vec<u32>| moved.iter().all(|v| !fixed.contains(v)) && moved.len() > 100;
    assert!(stays(held.moved()));
    held.hold(&fixed);
    assert!(stays(held.moved()));
    held.hold(&[]);
    assert!(stays(held.moved()));
    held.device_mesh.unpin(&fixed).unwrap();
    assert!(stays(held.moved()));
}

#[test]
fn pins_come_and_go_one_by_one() {
    let mut held = Held::new(bad_plate(600));
    let free = interior(&held.mesh);
    let (some, others) = free.split_at(free.len() / 3);
    held.device_mesh.pin(some).unwrap();
    held.device_mesh.pin(&some[..5]).unwrap();
    assert!(held.moved().iter().all(|v| others.contains(v)));
    held.device_mesh.pin(others).unwrap();
    assert_eq!(held.moved(), []);
    // Each vertex is listed twice, and already unpinned at the second time.
    for v in [some[0], some[1], others[7]] {
        held.device_mesh.unpin(&[v, v]).unwrap();
    }
    let mut expected = vec![some[0], some[1], others[7]];
    expected.sort_unstable();
    assert_eq!(held.moved(), expected);
    held.device_mesh.unpin(&free).unwrap();
    assert!(held.moved().len() > free.len() / 2);
}

/// Makes a mask buffer with a word for each vertex, after 12 bytes of other data.
fn mask(held: &Held, which: impl Fn(u32) -> bool) -> wgpu::Buffer {
    let words: Vec<u32> =
        (0..held.mesh.points.len() as u32).map(|v| 7 * u32::from(which(v))).collect();
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    let buffer = held.app.buffer(12 + 4 * words.len() as u64, usage);
    held.app.gpu.queue().write_buffer(&buffer, 12, bytemuck::cast_slice(&words));
    buffer
}

#[test]
fn a_mask_of_the_application_holds_vertices_beside_pins() {
    let mesh = bad_plate(600);
    let free = interior(&mesh);
    let mut held = Held::new(Mesh { fixed: vec![free[3]], ..mesh });
    let buffer = mask(&held, |v| v % 2 == 0);
    let bound = held.device_mesh.bind_mask(buffer.slice(12..)).unwrap();
    // The mask takes effect once it is encoded.
    assert!(held.moved().iter().any(|v| v % 2 == 0));
    held.app.submit(|encoder| bound.encode_mask(encoder));
    let moved = held.moved();
    assert!(moved.iter().all(|v| v % 2 == 1) && moved.len() > free.len() / 4);
    let pinned = moved[moved.len() / 2];
    held.device_mesh.pin(&[pinned]).unwrap();
    assert!(!held.moved().contains(&pinned));
    // Masked vertices between pinned and released ones stay masked.
    let odd: Vec<u32> = free.iter().copied().filter(|v| v % 2 == 1).collect();
    held.device_mesh.pin(&odd).unwrap();
    assert_eq!(held.moved(), []);
    held.device_mesh.set_pinned(&[pinned]).unwrap();
    assert!(held.moved().iter().all(|v| v % 2 == 1 && *v != pinned));

    // The application changes the mask; pinned and fixed vertices stay.
    let words = vec![0u32; held.mesh.points.len()];
    held.app.gpu.queue().write_buffer(&buffer, 12, bytemuck::cast_slice(&words));
    held.app.submit(|encoder| bound.encode_mask(encoder));
    let moved = held.moved();
    assert!(moved.iter().any(|v| v % 2 == 0));
    assert!(!moved.contains(&pinned) && !moved.contains(&free[3]));
}

#[test]
fn a_mask_that_changes_nothing_is_no_change_of_the_mesh() {
    let mut held = Held::new(bad_plate(300));
    let options = Options::default().max_sweeps(2);
    held.sweeps = Sweeps::until_converged(&held.device_mesh, &options).block().unwrap();
    let buffer = mask(&held, |v| v % 5 == 0);
    let bound = held.device_mesh.bind_mask(buffer.slice(12..)).unwrap();
    let mut frame = || {
        held.app.submit(|encoder| {
            bound.encode_mask(encoder);
            held.sweeps.encode_sweeps(encoder, 1);
        });
        held.app.objective(&held.sweeps).sweeps
    };
    assert_eq!([frame(), frame(), frame()], [1, 2, 2]);
    held.device_mesh.pin(&interior(&held.mesh)[..1]).unwrap();
    assert_eq!(frame(), 1);
}

#[test]
fn a_mask_that_cannot_be_bound_is_refused() {
    let held = Held::new(bad_plate(300));
    let bytes = 4 * held.mesh.points.len() as u64;
    let short = held.app.buffer(bytes, wgpu::BufferUsages::STORAGE);
    let error = held.device_mesh.bind_mask(short.slice(4..)).err().unwrap();
    assert!(matches!(error, GpuError::Buffer(_)), "{error:?}");
    held.device_mesh.bind_mask(short.slice(..)).unwrap();
}

#[test]
fn a_mesh_with_all_vertices_pinned_can_wait_for_some_to_be_released() {
    let mut held = Held::new(bad_plate(600));
    let free = interior(&held.mesh);
    held.hold(&free);
    assert_eq!(held.moved(), []);
    held.device_mesh.unpin(&free[..1]).unwrap();
    assert_eq!(held.moved(), free[..1]);
}

#[test]
fn a_fixed_vertex_still_goes_where_the_application_puts_it() {
    let mut held = Held::new(bad_plate(600));
    let v = interior(&held.mesh)[50];
    held.hold(&[v]);
    let vertices = crate::app::Vertices::usual(&held.app, &held.mesh);
    let [x, y] = held.mesh.points[v as usize];
    vertices.put(&held.app, v, [x + 1e-3, y]);
    held.app.submit(|encoder| {
        vertices.bind(&held.device_mesh).encode_import(encoder);
        held.sweeps.encode_sweeps(encoder, 3);
    });
    let [now, _] = held.points()[v as usize];
    assert!((now - f64::from((x + 1e-3) as f32)).abs() < 1e-12);
    assert!(!held.moved().contains(&v));
}

#[test]
fn holding_a_vertex_that_does_not_exist_is_refused_and_changes_nothing() {
    let mut held = Held::new(bad_plate(300));
    let count = held.mesh.points.len();
    let free = interior(&held.mesh);
    held.hold(&free[1..]);
    for wrong in [count as u32, u32::MAX] {
        let list = [free[0], wrong];
        let mesh = &held.device_mesh;
        for refused in [mesh.set_pinned(&list), mesh.unpin(&list), mesh.pin(&list)] {
            let error = refused.unwrap_err();
            let SmoothError::Mesh(MeshError::IndexOutOfRange { element: None, vertex, vertices }) =
                error
            else {
                panic!("{error}");
            };
            assert_eq!((vertex, vertices), (wrong, count));
        }
    }
    assert_eq!(held.moved(), free[..1]);
}

#[test]
fn a_fixed_vertex_that_does_not_exist_is_refused() {
    let app = App::new();
    let mesh = Mesh { fixed: vec![5, 100_000], ..bad_plate(300) };
    let error = DeviceMesh::new(&app.gpu, &mesh).err().unwrap();
    let SmoothError::Mesh(MeshError::IndexOutOfRange { element: None, vertex: 100_000, .. }) =
        error
    else {
        panic!("{error}");
    };
}
