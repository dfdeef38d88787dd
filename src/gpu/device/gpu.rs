//! A device with its pipelines.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

use crate::adapter::AdapterSummary;
use crate::error::{GpuError, SmoothError};
use crate::gpu::device::limits;
use crate::gpu::kernels::form::Positions;
use crate::gpu::kernels::pipelines::Pipelines;
use crate::gpu::kernels::row::User;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::scope::poll;
use crate::mesh::MeshSize;
use crate::options::Options;
use crate::run::Plan;

/// A device with its pipelines. Created once, it serves many meshes. It is a handle: clones refer to the same device.
#[derive(Clone)]
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) pipelines: Arc<Pipelines>,
    summary: Arc<AdapterSummary>,
    lost: Arc<Mutex<Option<String>>>,
    /// The operation that [`Gpu::check_arithmetic`] found to be wrong, if any. Not set before the first call.
    pub(super) arithmetic: Arc<OnceLock<Option<&'static str>>>,
}

impl Gpu {
    /// Takes an application's own device and queue (both are handles, which can be cloned).
    ///
    /// The device has to be created with [`Self::required_limits`] or higher. Its callbacks for errors and for loss
    /// stay the application's: this library catches the errors of its own calls in error scopes, and finds out about a
    /// lost device when it reads back. Faults of an encoder that was passed in, for example one of another device or a
    /// finished one, are reported by wgpu to the application when it finishes the encoder.
    ///
    /// Nothing is submitted and nothing waits, so this may be called on any thread. The device is polled once, which
    /// may run callbacks of the application, to check that the queue belongs to it. While the device is busy this
    /// cannot be checked, and wgpu reports a foreign queue later, to the error handler of the queue's own device.
    ///
    /// The arithmetic of the adapter is not checked here, as that would wait: runs of [`Smoother`](crate::Smoother)
    /// check it first, and an application that encodes sweeps itself calls [`Gpu::check_arithmetic`] or
    /// [`Gpu::check_arithmetic_async`].
    ///
    /// # Panics
    /// This library does not panic, but wgpu itself does if resources of two *instances* are combined. An application
    /// should have one [`wgpu::Instance`].
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device binds too few storage buffers, [`GpuError::Queue`] if the queue belongs to
    /// another device.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, GpuError> {
        if !is_own(&queue, &device) {
            return Err(GpuError::Queue);
        }
        let summary = AdapterSummary::new(&device.adapter_info());
        Self::with(device, queue, summary, Arc::default())
    }

    /// Sets a pipeline cache of the application, with which kernels compile faster the next time. The application
    /// creates it on its device, which has the feature `PIPELINE_CACHE` where the driver has caches (on Vulkan), and
    /// saves its data ([`wgpu::PipelineCache::get_data`]). To be called first: kernels that are compiled already are
    /// compiled again.
    ///
    /// ```no_run
    /// # use gpu_smooth::{wgpu, Gpu, GpuError, Options, SmoothError};
    /// # fn f(device: wgpu::Device, queue: wgpu::Queue, cache: wgpu::PipelineCache) -> Result<(), SmoothError> {
    /// let gpu = Gpu::new(device, queue)?.with_pipeline_cache(cache.clone());
    /// gpu.prepare(&Options::default())?;
    /// if let Some(data) = cache.get_data() {
    ///     // Write it to a file of wgpu::util::pipeline_cache_key(&adapter.get_info()).
    /// }
    /// # Ok(())
    /// # }
    /// ```
    pub fn with_pipeline_cache(self, cache: wgpu::PipelineCache) -> Self {
        Self { pipelines: Arc::new(Pipelines::with_cache(cache)), ..self }
    }

    pub(super) fn with(
        device: wgpu::Device,
        queue: wgpu::Queue,
        summary: AdapterSummary,
        lost: Arc<Mutex<Option<String>>>,
    ) -> Result<Self, GpuError> {
        limits::check(&device.limits())?;
        let (pipelines, arithmetic) = (Arc::new(Pipelines::default()), Arc::default());
        Ok(Self { device, queue, pipelines, summary: Arc::new(summary), lost, arithmetic })
    }

    /// Compiles the kernels that meshes need with these options: those of sweeps, of objectives, and of the import and
    /// export of vertices. Then neither [`Sweeps::new`](crate::gpu::Sweeps::new) nor the binding of a buffer waits for
    /// the compiler; a frame never does. Kernels that are compiled already cost nothing. May be called on another
    /// thread.
    ///
    /// Meshes so large that their positions take two bindings need kernels of their own, which are not included.
    ///
    /// # Errors
    /// [`SmoothError::Option`] for an option out of its range, or [`SmoothError::Gpu`] if the device fails.
    pub fn prepare(&self, options: &Options) -> Result<(), SmoothError> {
        options.check_with(&[])?;
        let plan = Plan::new(options);
        let mut kernels = Kernel::needed_by(&plan, User::Sweeps);
        if options.is_multilevel() {
            kernels.extend(Kernel::needed_by(&plan, User::Corrections));
        }
        for kernel in kernels {
            self.pipelines.get(&self.device, &kernel, Positions::Whole)?;
        }
        Ok(())
    }

    /// The device. It is a handle, which can be cloned.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue. It is a handle, which can be cloned.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// The adapter in use.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.summary
    }

    /// Fails if the device is lost. Most calls on a lost device seem to succeed.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        match &*self.lost.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(message) => Err(GpuError::Lost(message.clone())),
            None => Ok(()),
        }
    }
}

impl Gpu {
    /// The features a device needs: none beyond core WebGPU.
    pub fn required_features() -> wgpu::Features {
        wgpu::Features::empty()
    }

    /// The optional features that this library uses: `TIMESTAMP_QUERY`, for [`Timestamps`](crate::gpu::Timestamps). An
    /// application that wants it requests `adapter.features() & Gpu::optional_features()`.
    pub fn optional_features() -> wgpu::Features {
        wgpu::Features::TIMESTAMP_QUERY
    }

    /// Returns the limits to create a device with, for meshes of up to `size` and an application that itself needs
    /// `own`: `own`, raised where the kernels or the meshes need more. Buffers larger than the adapter can bind at once
    /// are bound part by part; `max_storage_buffer_binding_size` is then the adapter's largest.
    ///
    /// ```no_run
    /// # use gpu_smooth::{wgpu, Gpu, GpuError, MeshSize, gpu::VertexBuffer};
    /// # async fn f(adapter: wgpu::Adapter) -> Result<(), Box<dyn std::error::Error>> {
    /// let size = MeshSize { vertices: 100_000, triangles: 200_000 };
    /// // A vertex buffer with 32 bytes for each vertex.
    /// let own = wgpu::Limits {
    ///     max_storage_buffer_binding_size: VertexBuffer::binding_size(size.vertices, 32, 0),
    ///     ..wgpu::Limits::default()
    /// };
    /// let (device, queue) = adapter
    ///     .request_device(&wgpu::DeviceDescriptor {
    ///         required_features: Gpu::required_features(),
    ///         required_limits: Gpu::required_limits(own, size, &adapter.limits())?,
    ///         ..Default::default()
    ///     })
    ///     .await?;
    /// let gpu = Gpu::new(device, queue)?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// The application's own buffers count as its own needs. A vertex buffer with a long stride may need more than the
    /// mesh: raise `max_storage_buffer_binding_size` of `own` to
    /// [`VertexBuffer::binding_size`](crate::gpu::VertexBuffer::binding_size).
    ///
    /// # Errors
    /// [`GpuError::Limit`] if `available`, the adapter's limits, are too low for the kernels or the mesh; it names the
    /// limit. [`GpuError::TooLarge`] for a mesh with more vertices or triangles than the kernels can number on any
    /// device. `own` is not checked here; the adapter checks it when the device is requested.
    pub fn required_limits(
        own: wgpu::Limits,
        size: MeshSize,
        available: &wgpu::Limits,
    ) -> Result<wgpu::Limits, GpuError> {
        limits::required(own, size, available)
    }

    /// Checks whether meshes of this size fit the device, bound part by part if need be. Allocates nothing.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if not; it names the buffer and the limit. [`GpuError::TooLarge`] for a mesh with more
    /// vertices or triangles than the kernels can number on any device.
    pub fn check_size(&self, size: MeshSize) -> Result<(), GpuError> {
        size.check(&self.device.limits())
    }
}

/// Whether the queue belongs to the device. True if this cannot be found out without waiting.
///
/// Only polls of a queue's own device report that its work is done. So if a poll of an idle device brings no report,
/// the queue belongs to another device. Browsers have no polls.
fn is_own(queue: &wgpu::Queue, device: &wgpu::Device) -> bool {
    if cfg!(target_arch = "wasm32") {
        return true;
    }
    let reported = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&reported);
    queue.on_submitted_work_done(move || flag.store(true, Ordering::Relaxed));
    // A poll on another thread may have taken the report, and be about to deliver it.
    (0..PATIENCE).any(|_| {
        let idle = poll(device, wgpu::PollType::Poll).is_ok_and(|status| status.is_queue_empty());
        let is_own = reported.load(Ordering::Relaxed) || !idle;
        if !is_own {
            std::thread::sleep(Duration::from_millis(1));
        }
        is_own
    })
}

/// Number of polls, one each millisecond, before a queue counts as foreign.
const PATIENCE: u32 = 30;
