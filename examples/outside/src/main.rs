//! An application that uses gpu-smooth for many frames, in the way that docs/embedding.md describes. It drags a hole,
//! pins vertices, turns the mesh inside out and restores it, replaces the mesh by one prepared on another thread, and
//! continues after losing its device.
//!
//! ```text
//! cargo run --release --example outside -- [MESH]
//! ```
//!
//! The application has no window, and prints the results of each act.
#![allow(clippy::print_stdout)]

mod scene;

use std::path::{Path, PathBuf};

use gpu_smooth::{
    Gpu, GpuError, Mesh, MeshSize, Topology, gpu::VertexBuffer, topology::signed_area, wgpu,
};
use gpu_smooth_job::Job;
use mesh_io::MeshFile;
use scene::{STRIDE, Scene, Seen};

pub(crate) type Result<T> = std::result::Result<T, Box<dyn std::error::Error + Send + Sync>>;

fn main() -> Result<()> {
    let path = std::env::args().nth(1).map_or_else(default_mesh, PathBuf::from);
    let file = MeshFile::read(&path)?;
    // Vertices that the file constrains, and vertices between its regions, are fixed.
    let job = Job::of_file(&file)?;
    for (act, told) in acts(job.mesh())? {
        println!("{act}: {told:?}");
    }
    Ok(())
}

/// Returns the mesh of a command line without MESH. The path is absolute, so that the example runs in any directory. The
/// mesh is in the repository, above the folder of this crate.
pub(crate) fn default_mesh() -> PathBuf {
    let name = "meshes/plate.node";
    let folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let mut paths = folders.map(|folder| folder.join(name));
    paths.find(|path| path.is_file()).unwrap_or_else(|| name.into())
}

/// The result of an act, which consists of several frames.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Told {
    pub(crate) frames: u32,
    pub(crate) sweeps: u32,
    /// Largest number of inverted triangles in a frame.
    pub(crate) inverted: u32,
    /// Worst inverse mean ratio after the last frame.
    pub(crate) worst_imr: f32,
    pub(crate) has_converged: bool,
    /// Smallest fraction of a step that a drag made in a frame.
    pub(crate) least_share: f32,
}

/// Performs all acts. Returns the name and result of each.
pub(crate) fn acts(mesh: &Mesh) -> Result<Vec<(&'static str, Told)>> {
    let mut acts = Vec::new();
    let gpu = open(mesh)?;
    let mut scene = Scene::new(&gpu, mesh)?;
    acts.push(("settle", settle(&mut scene)?));

    let hole = hole(mesh)?;
    acts.push(("drag a hole", drag(&mut scene, &hole, [0.4, 0.1])?));
    acts.push(("settle around it", settle(&mut scene)?));

    let pinned: Vec<u32> = (0..mesh.points.len() as u32).step_by(3).collect();
    scene.device_mesh.pin(&pinned)?;
    acts.push(("drag it home with vertices pinned", drag(&mut scene, &hole, [0.0, 0.0])?));
    scene.device_mesh.unpin(&pinned)?;
    acts.push(("settle with them unpinned", settle(&mut scene)?));

    // Kernels of an application may move vertices to any positions; this act does so from the host.
    let free = Topology::new(mesh)?.free().to_vec();
    let torn: Vec<u32> =
        (0..).zip(free).filter(|&(v, free)| free && v % 10 == 0).map(|(v, _)| v).collect();
    acts.push(("recover from being torn inside out", tear(&mut scene, &torn)?));
    acts.push(("settle what was torn", settle(&mut scene)?));

    // Another thread prepares a finer mesh while frames continue.
    let (worker_gpu, finer) = (gpu.clone(), refined(mesh));
    let worker = std::thread::spawn(move || Scene::new(&worker_gpu, &finer));
    let mut meanwhile = Told { least_share: 1.0, ..Told::default() };
    while !worker.is_finished() {
        let seen = scene.frame(None)?;
        meanwhile.add(seen);
    }
    acts.push(("frames while another mesh is made ready", meanwhile));
    let mut scene = worker.join().map_err(|_| "the worker panicked")??;
    acts.push(("settle the finer mesh", settle(&mut scene)?));

    // After the device is lost, a new device continues with the vertices that were read back last.
    let last = scene.last_mesh()?;
    gpu.device().destroy();
    let error = loop {
        match scene.frame(None) {
            Ok(_) => {}
            Err(error) => break error,
        }
    };
    if !matches!(error.downcast_ref(), Some(GpuError::Lost(_))) {
        return Err(error);
    }
    let mut scene = Scene::new(&open(&last)?, &last)?;
    acts.push(("settle on another device", settle(&mut scene)?));
    Ok(acts)
}

impl Told {
    fn add(&mut self, Seen { sweeps, values, share }: Seen) {
        self.frames += 1;
        self.sweeps += sweeps;
        self.inverted = self.inverted.max(values.inverted);
        self.worst_imr = values.worst_imr;
        self.has_converged = values.has_converged();
        self.least_share = self.least_share.min(share);
    }
}

/// Executes frames until the sweeps converge.
fn settle(scene: &mut Scene) -> Result<Told> {
    let mut told = Told { least_share: 1.0, ..Told::default() };
    while told.frames < 5000 && !told.has_converged {
        told.add(scene.frame(None)?);
    }
    Ok(told)
}

/// Moves vertices to one side by half a unit, as a kernel of an application might do. Then executes frames until no
/// triangle is inverted.
fn tear(scene: &mut Scene, vertices: &[u32]) -> Result<Told> {
    let to: Vec<[f32; 2]> = scene.places(vertices)?.iter().map(|&[x, y]| [x + 0.5, y]).collect();
    scene.write(vertices, &to);
    let mut told = Told { least_share: 1.0, ..Told::default() };
    told.add(scene.look()?);
    while told.frames < 500 && told.worst_imr.is_infinite() {
        told.add(scene.frame(None)?);
    }
    Ok(told)
}

/// Drags vertices by `by` from their original positions, one step per frame.
fn drag(scene: &mut Scene, vertices: &[u32], by: [f32; 2]) -> Result<Told> {
    const FRAMES: usize = 30;
    let drag = scene.take_hold(vertices)?;
    let (from, home) = (scene.places(vertices)?, scene.home(vertices));
    let mut told = Told { least_share: 1.0, ..Told::default() };
    for frame in 1..=FRAMES {
        let part = frame as f32 / FRAMES as f32;
        let toward = |(from, home): (&[f32; 2], &[f32; 2])| {
            [0, 1].map(|i| from[i] + part * (home[i] + by[i] - from[i]))
        };
        let targets: Vec<[f32; 2]> = from.iter().zip(&home).map(toward).collect();
        told.add(scene.frame(Some((&drag, &targets)))?);
    }
    Ok(told)
}

/// Opens a device for a mesh four times as large, with timestamps if available.
fn open(mesh: &Mesh) -> Result<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let size = MeshSize { vertices: 4 * mesh.points.len(), triangles: 4 * mesh.triangles.len() };
    let own = wgpu::Limits {
        max_storage_buffer_binding_size: VertexBuffer::binding_size(size.vertices, STRIDE, 0)
            .max(wgpu::Limits::default().max_storage_buffer_binding_size),
        ..wgpu::Limits::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_features: adapter.features() & Gpu::optional_features(),
        required_limits: Gpu::required_limits(own, size, &adapter.limits())?,
        ..Default::default()
    }))?;
    let gpu = Gpu::new(device, queue)?;
    gpu.check_arithmetic().block()?;
    gpu.prepare(&scene::options())?;
    Ok(gpu)
}

/// Returns the vertices of the first hole.
fn hole(mesh: &Mesh) -> Result<Vec<u32>> {
    let mut loops = Topology::new(mesh)?.boundary_loops();
    // The outer boundary is a counterclockwise loop, each hole a clockwise one.
    loops.retain(|vertices| signed_area(&mesh.points, vertices) < 0.0);
    loops.into_iter().next().ok_or("the mesh has no hole".into())
}

/// Returns a mesh in which each triangle is cut into four.
fn refined(mesh: &Mesh) -> Mesh {
    let mut points = mesh.points.clone();
    let mut middles = std::collections::HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let [p, q] = [a, b].map(|v| mesh.points[v as usize]);
            points.push([0, 1].map(|i| 0.5 * (p[i] + q[i])));
            points.len() as u32 - 1
        })
    };
    let mut triangles = Vec::new();
    for &[a, b, c] in &mesh.triangles {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh { points, triangles, ..Mesh::default() }
}
