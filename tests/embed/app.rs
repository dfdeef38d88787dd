//! A small application for tests, with its device, buffers and encoders.

use std::sync::{Arc, LazyLock, Mutex};

use gpu_smooth::{
    Gpu, GpuError, Mesh, MeshSize, SmoothError,
    gpu::{
        BoundMove, BoundObjective, BoundVertices, DeviceMesh, ObjectiveValues, Sweeps, Timestamps,
        UntanglingSweeps, VertexBuffer,
    },
    wgpu,
};
use pollster::block_on;
use wgpu::BufferUsages as Usage;

use support::{perturb_random, triangulate};

/// Size of the largest mesh in these tests.
const LARGEST: MeshSize = MeshSize { vertices: 10_000, triangles: 20_000 };

/// An application with its own device. If an error reached the device's error handler, dropping the application
/// panics.
pub(crate) struct App {
    pub(crate) gpu: Gpu,
    uncaptured: Arc<Mutex<Vec<String>>>,
}

/// Returns the adapter of all devices. wgpu panics if resources of two instances are combined.
pub(crate) fn adapter() -> &'static wgpu::Adapter {
    static ADAPTER: LazyLock<wgpu::Adapter> = LazyLock::new(|| {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .expect("these tests need an adapter; a software one such as Mesa's lavapipe is enough")
    });
    &ADAPTER
}

/// Returns the limits for an application that needs none of its own.
pub(crate) fn least_limits(size: MeshSize) -> wgpu::Limits {
    let own = wgpu::Limits::downlevel_webgl2_defaults();
    Gpu::required_limits(own, size, &adapter().limits()).unwrap()
}

impl App {
    /// Makes a device with exactly the library's requirements, and room for vertices of any stride.
    pub(crate) fn new() -> Self {
        Self::with(Gpu::required_features(), Self::limits()).unwrap()
    }

    fn limits() -> wgpu::Limits {
        wgpu::Limits { max_storage_buffer_binding_size: 1 << 20, ..least_limits(LARGEST) }
    }

    /// Makes a device with timestamps in addition.
    pub(crate) fn with_timestamps() -> Self {
        Self::with(Gpu::optional_features(), Self::limits()).unwrap()
    }

    pub(crate) fn with_limits(limits: wgpu::Limits) -> Result<Self, GpuError> {
        Self::with(Gpu::required_features(), limits)
    }

    fn with(features: wgpu::Features, limits: wgpu::Limits) -> Result<Self, GpuError> {
        let (device, queue) = block_on(adapter().request_device(&wgpu::DeviceDescriptor {
            label: Some("application"),
            required_features: features,
            required_limits: limits,
            ..Default::default()
        }))
        .expect("the adapter gives a device with these limits");
        let uncaptured = Arc::new(Mutex::new(Vec::new()));
        let record = Arc::clone(&uncaptured);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            record.lock().unwrap().push(error.to_string());
        }));
        let gpu = Gpu::new(device, queue);
        assert!(uncaptured.lock().unwrap().is_empty(), "{uncaptured:?}");
        Ok(Self { gpu: gpu?, uncaptured })
    }

    /// Makes a second `Gpu` of the device, for blocking calls of the library.
    pub(crate) fn another_gpu(&self) -> Gpu {
        Gpu::new(self.gpu.device().clone(), self.gpu.queue().clone()).unwrap()
    }

    /// Takes the errors that reached the error handler. After the call, these errors no longer make the drop
    /// panic.
    pub(crate) fn take_uncaptured(&self) -> Vec<String> {
        std::mem::take(&mut *self.uncaptured.lock().unwrap())
    }

    pub(crate) fn device(&self) -> &wgpu::Device {
        self.gpu.device()
    }

    pub(crate) fn mesh(&self, mesh: &Mesh) -> DeviceMesh {
        DeviceMesh::new(&self.gpu, mesh).unwrap()
    }

    pub(crate) fn buffer(&self, bytes: u64, usage: Usage) -> wgpu::Buffer {
        self.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("application's"),
            size: bytes,
            usage,
            mapped_at_creation: false,
        })
    }

    pub(crate) fn encoder(&self) -> wgpu::CommandEncoder {
        self.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Submits a command buffer with the commands of `encode`.
    pub(crate) fn submit(&self, encode: impl FnOnce(&mut wgpu::CommandEncoder)) {
        let mut encoder = self.encoder();
        encode(&mut encoder);
        self.gpu.queue().submit([encoder.finish()]);
    }

    /// Returns the words of a buffer, which must have usage `COPY_SRC`.
    pub(crate) fn read(&self, buffer: &wgpu::Buffer) -> Vec<u32> {
        let staging = self.buffer(buffer.size(), Usage::COPY_DST | Usage::MAP_READ);
        self.submit(|encoder| {
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
        });
        staging.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        self.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let view = staging.get_mapped_range(..).unwrap();
        bytemuck::pod_collect_to_vec(&view[..])
    }

    /// Returns the positions on the device, without encoding a sweep or an import.
    pub(crate) fn points(&self, device_mesh: &DeviceMesh) -> Vec<[f64; 2]> {
        device_mesh.read_points().block().unwrap()
    }

    /// Evaluates the objectives in a separate command buffer.
    pub(crate) fn objective(&self, sweeps: &Sweeps) -> ObjectiveValues {
        let buffer =
            self.buffer(size_of::<ObjectiveValues>() as u64, Usage::STORAGE | Usage::COPY_SRC);
        let bound = sweeps.bind_objective(buffer.slice(..)).unwrap();
        self.submit(|encoder| bound.encode_objective(encoder));
        bytemuck::pod_read_unaligned(bytemuck::cast_slice(&self.read(&buffer)))
    }
}

impl Drop for App {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            let uncaptured = self.uncaptured.lock().unwrap();
            assert!(uncaptured.is_empty(), "reached the application's handler: {uncaptured:?}");
        }
    }
}

/// Returns the initial value of a word of [`Vertices`] that is no coordinate: a NaN with the word's index.
pub(crate) fn filler(word: usize) -> u32 {
    0x7fc0_0000 | word as u32
}

/// A vertex buffer with a layout of the application.
pub(crate) struct Vertices {
    pub(crate) buffer: wgpu::Buffer,
    pub(crate) offset: u64,
    pub(crate) stride: u64,
}

impl Vertices {
    /// Makes a buffer full of [`filler`], except for the coordinates of vertices that elements use.
    pub(crate) fn new(app: &App, mesh: &Mesh, offset: u64, stride: u64) -> Self {
        let bytes = offset + stride * mesh.points.len() as u64;
        let usage = Usage::VERTEX | Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC;
        let vertices = Self { buffer: app.buffer(bytes, usage), offset, stride };
        let mut words: Vec<u32> = (0..bytes as usize / 4).map(filler).collect();
        let of_quadrilaterals = mesh.quadrilaterals.as_flattened();
        for &v in mesh.triangles.as_flattened().iter().chain(of_quadrilaterals) {
            let [x, y] = mesh.points[v as usize].map(|x| (x as f32).to_bits());
            let at = vertices.word(v);
            (words[at], words[at + 1]) = (x, y);
        }
        app.gpu.queue().write_buffer(&vertices.buffer, 0, bytemuck::cast_slice(&words));
        vertices
    }

    /// Makes a buffer with the layout x, y, z.
    pub(crate) fn usual(app: &App, mesh: &Mesh) -> Self {
        Self::new(app, mesh, 0, 12)
    }

    /// Returns the index of the word with the x of a vertex.
    pub(crate) fn word(&self, vertex: u32) -> usize {
        ((self.offset + u64::from(vertex) * self.stride) / 4) as usize
    }

    /// Writes the position of a vertex to the buffer, as an application does.
    pub(crate) fn put(&self, app: &App, vertex: u32, [x, y]: [f64; 2]) {
        let xy = [x as f32, y as f32];
        let at = 4 * self.word(vertex) as u64;
        app.gpu.queue().write_buffer(&self.buffer, at, bytemuck::cast_slice(&xy));
    }

    pub(crate) fn place(&self) -> VertexBuffer<'_> {
        VertexBuffer::new(self.buffer.slice(self.offset..), self.stride)
    }

    pub(crate) fn bind(&self, device_mesh: &DeviceMesh) -> BoundVertices {
        device_mesh.bind_vertices(&self.place()).unwrap()
    }
}

/// Makes a plate with a round hole.
pub(crate) fn plate(vertices: usize) -> Mesh {
    let text = "loop\n0 0\n3 0\n3 2\n0 2\ncircle 1.2 1 0.5 24\n";
    triangulate(&support::Outline::parse(text).unwrap(), vertices).unwrap()
}

/// Makes a plate with a round hole and perturbed interior vertices.
pub(crate) fn bad_plate(vertices: usize) -> Mesh {
    perturb_random(&plate(vertices), 0.8, 7)
}

/// Returns the vertices that are neither on the boundary nor fixed.
pub(crate) fn interior(mesh: &Mesh) -> Vec<u32> {
    let held = support::check::held(mesh);
    (0..mesh.points.len() as u32).filter(|&v| !held[v as usize]).collect()
}

/// Returns the device error inside a run's error; panics for other errors.
pub(crate) fn gpu_error(error: SmoothError) -> GpuError {
    match error {
        SmoothError::Gpu(error) => error,
        other => panic!("no error of the device: {other}"),
    }
}

/// Fails to compile unless the types can move between threads.
const _: () = {
    const fn moves_between_threads<T: Send + Sync>() {}
    moves_between_threads::<Gpu>();
    moves_between_threads::<DeviceMesh>();
    moves_between_threads::<Sweeps>();
    moves_between_threads::<BoundVertices>();
    moves_between_threads::<BoundObjective>();
    moves_between_threads::<BoundMove>();
    moves_between_threads::<Timestamps>();
    moves_between_threads::<UntanglingSweeps>();
};
