//! Vertices the application holds and lets go.

use gpu_smooth::{DeviceMesh, Mesh, MeshError, Options, SmoothError, Sweeps};

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
        let sweeps = Sweeps::new(&device_mesh, &Options::default()).unwrap();
        Self { app, mesh, device_mesh, sweeps }
    }

    fn hold(&self, which: &[u32]) {
        self.device_mesh.set_fixed(which).unwrap();
    }

    fn points(&self) -> Vec<[f64; 2]> {
        self.app.points(&self.device_mesh)
    }

    /// Which vertices three sweeps move.
    fn moved(&mut self) -> Vec<u32> {
        let before = self.points();
        self.app.submit(|encoder| self.sweeps.encode_sweeps(encoder, 3));
        let after = self.points();
        (0..).zip(before.iter().zip(&after)).filter(|(_, (b, a))| a != b).map(|(v, _)| v).collect()
    }
}

#[test]
fn set_fixed_holds_and_releases() {
    let mut held = Held::new(bad_plate(600));
    let free = interior(&held.mesh);
    // Every third, the first and the last by any numbering among them.
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
fn nothing_lets_the_boundary_go() {
    let mut held = Held::new(bad_plate(600));
    held.hold(&[]);
    let free = interior(&held.mesh);
    assert!(held.moved().iter().all(|v| free.contains(v)));
}

#[test]
fn set_fixed_takes_effect_in_what_is_submitted_after_it() {
    let mut held = Held::new(bad_plate(600));
    let free = interior(&held.mesh);
    let before = held.points();
    let mut encoder = held.app.encoder();
    held.sweeps.encode_sweeps(&mut encoder, 2);
    held.hold(&free);
    held.app.gpu.queue().submit([encoder.finish()]);
    assert_eq!(held.points(), before);
}

#[test]
fn fixed_vertices_of_the_mesh_stay_until_released() {
    let mesh = bad_plate(600);
    let fixed: Vec<u32> = interior(&mesh).into_iter().step_by(4).collect();
    let mut held = Held::new(Mesh { fixed: fixed.clone(), ..mesh });
    assert!(held.moved().iter().all(|v| !fixed.contains(v)));
    held.hold(&[]);
    assert!(held.moved().iter().any(|v| fixed.contains(v)));
}

#[test]
fn a_mesh_with_all_vertices_fixed_can_wait_for_some_to_be_released() {
    let mesh = bad_plate(600);
    let free = interior(&mesh);
    let mut held = Held::new(Mesh { fixed: free.clone(), ..mesh });
    assert_eq!(held.moved(), []);
    held.hold(&free[1..]);
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
        let error = held.device_mesh.set_fixed(&[free[0], wrong]).unwrap_err();
        let SmoothError::Mesh(MeshError::IndexOutOfRange { triangle: None, vertex, vertices }) =
            error
        else {
            panic!("{error}");
        };
        assert_eq!((vertex, vertices), (wrong, count));
    }
    assert_eq!(held.moved(), free[..1]);
}

#[test]
fn a_fixed_vertex_that_does_not_exist_is_refused() {
    let app = App::new();
    let mesh = Mesh { fixed: vec![5, 100_000], ..bad_plate(300) };
    let error = DeviceMesh::new(&app.gpu, &mesh).err().unwrap();
    let SmoothError::Mesh(MeshError::IndexOutOfRange { triangle: None, vertex: 100_000, .. }) =
        error
    else {
        panic!("{error}");
    };
}
