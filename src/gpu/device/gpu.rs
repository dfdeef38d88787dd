//! A device with its pipelines.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use crate::adapter::AdapterSummary;
use crate::error::{GpuError, SmoothError};
use crate::gpu::device::limits;
use crate::gpu::device::pending::Pending;
use crate::gpu::kernels::form::{MeshForm, Positions};
use crate::gpu::kernels::pipelines::Pipelines;
use crate::gpu::kernels::row::User;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::scope::{CountedQueue, DeviceCounts, WatchedDevice, caught, check_alive, poll};
use crate::mesh::MeshSize;
use crate::options::Options;
use crate::parallel::pace::{now, pause};
use crate::run::Plan;

/// A device with compiled pipelines, created once for many meshes. Clones of the handle refer to the same device.
#[derive(Clone)]
pub struct Gpu {
    pub(crate) device: WatchedDevice,
    pub(crate) queue: CountedQueue,
    pub(crate) pipelines: Arc<Pipelines>,
    summary: Arc<AdapterSummary>,
    /// Result of [`Gpu::check_arithmetic`]: the operation that the adapter computes wrongly, or `None` if all pass.
    /// Unset before the first check.
    pub(super) arithmetic: Arc<OnceLock<Option<&'static str>>>,
}

impl Gpu {
    /// Creates a `Gpu` from the device and queue of an application. Both are handles and can be cloned.
    ///
    /// The device must be created with [`Self::required_limits`] or higher limits. The device's callbacks for errors
    /// and for loss stay the application's. This library catches the errors of its own calls in error scopes, and
    /// notices a lost device at the next readback. If the application passes an unusable encoder, for example a
    /// finished one or one of another device, wgpu reports the fault when the application finishes the encoder.
    ///
    /// Any thread may call this function. Nothing is submitted. Polls of the device, which may run callbacks of the
    /// application, check that the queue belongs to the device. The polls wait until submitted work is done, some 30 ms
    /// at most, and longer on a driver that blocks in submissions, as Mesa's lavapipe does. A queue counts as foreign only after some 30 ms of repeated polls of an idle device. A device that stays
    /// busy, or a browser, cannot check the queue: wgpu reports a foreign queue later, to the error handler of the
    /// queue's own device.
    ///
    /// `new` does not check the adapter's arithmetic, as the check waits for the device. Runs of
    /// [`Smoother`](crate::Smoother) check the arithmetic first. An application that encodes sweeps itself calls
    /// [`Gpu::check_arithmetic`].
    ///
    /// # Panics
    /// This library does not panic, but wgpu itself panics if resources of two *instances* are combined. An application
    /// should have one [`wgpu::Instance`].
    ///
    /// # Errors
    /// [`GpuError::Limit`], with the name of the limit, if the device has lower limits than the kernels need.
    /// [`GpuError::Queue`] if the queue belongs to another device, [`GpuError::Lost`] if the device is lost.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, GpuError> {
        let device = WatchedDevice::of_application(device);
        check_alive(&device)?;
        if !is_own(&queue, &device) {
            return Err(GpuError::Queue);
        }
        let summary = AdapterSummary::new(&device.adapter_info());
        Self::with(device, queue, summary)
    }

    /// Sets a pipeline cache of the application, with which kernels compile faster when the application is started
    /// again. The application creates the cache on its device, which has the feature `PIPELINE_CACHE` where the driver
    /// has caches (on Vulkan), and saves the cache's data ([`wgpu::PipelineCache::get_data`]). Call this method before
    /// any other: the returned handle compiles all kernels again.
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
        device: WatchedDevice,
        queue: wgpu::Queue,
        summary: AdapterSummary,
    ) -> Result<Self, GpuError> {
        limits::check(&device.limits())?;
        let queue = CountedQueue::new(queue, Arc::clone(device.counters()));
        let (pipelines, arithmetic) = (Arc::new(Pipelines::default()), Arc::default());
        Ok(Self { device, queue, pipelines, summary: Arc::new(summary), arithmetic })
    }

    /// Compiles the kernels that an application's frames need with these options: sweeps, objectives, import and export
    /// of vertices, moves, masks, untangling and, for [multilevel](Options::is_multilevel) options, corrections.
    /// Afterwards neither [`Sweeps::new`](crate::gpu::Sweeps::new) nor the binding of a buffer waits for the compiler;
    /// a frame never does. Kernels compiled earlier take no time. Any thread may call this method.
    ///
    /// Meshes with quadrilaterals, with targets, with vertices that slide, and meshes so large that their positions take two
    /// bindings, need other kernels, which are not included.
    ///
    /// # Errors
    /// [`SmoothError::Option`] if an option is out of its range, or [`SmoothError::Gpu`] if the device fails.
    pub fn prepare(&self, options: &Options) -> Result<(), SmoothError> {
        options.check_with(&[])?;
        let plan = Plan::new(options);
        let mut kernels = Kernel::needed_by(&plan, User::Sweeps);
        if options.is_multilevel() {
            kernels.extend(Kernel::needed_by(&plan, User::Corrections));
        }
        let kernels: Vec<_> =
            kernels.into_iter().map(|kernel| (kernel, Positions::Whole.into())).collect();
        now(self.compile(&kernels))?;
        // Kernels that were compiled earlier need no call of wgpu, which would fail.
        Ok(check_alive(&self.device)?)
    }

    /// Returns whether the device is lost, so that every further run on the device fails. Never waits for the device. In
    /// a browser, returns false: there an error reports the loss.
    pub fn is_lost(&self) -> bool {
        cfg!(not(target_arch = "wasm32")) && check_alive(&self.device).is_err()
    }

    /// Drops a device that has failed or is lost. A plain drop may panic in wgpu, because of resources that were never
    /// created.
    pub fn discard(self) {
        let _ = caught(|| drop(self));
    }

    /// Returns the device, a handle that the caller may clone.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// Returns the queue, a handle that the caller may clone.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Returns the counts of the work that this library has given to the device.
    pub(crate) fn counts(&self) -> DeviceCounts {
        self.device.counters().counts()
    }

    /// Returns the name, driver, backend and kind of the adapter in use.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.summary
    }

    /// Waits until the browser has reported the errors of all earlier calls of this library on the device, and returns
    /// the first error. Outside of a browser every call has returned its own errors, and nothing is waited for.
    ///
    /// In a browser, a call such as [`DeviceMesh::new`](crate::gpu::DeviceMesh::new) returns before the browser reports
    /// its errors. The next call of this library on the device that is awaited, or the next
    /// [`Readback::latest`](crate::gpu::Readback::latest), returns the error too. Each error is returned once.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`], [`GpuError::Buffer`] or [`GpuError::Refused`] for earlier calls, and
    /// [`GpuError::Lost`] if the device is lost.
    pub fn errors(&self) -> Pending<'_, ()> {
        Pending::new(|_| {
            Box::pin(async {
                self.device.check_async().await?;
                check_alive(&self.device)
            })
        })
    }
}

impl Gpu {
    /// Compiles kernels for meshes of their forms, except kernels that are compiled already. Outside of a browser, the threads of
    /// rayon take kernels from the end of the list while this thread takes them from the start.
    ///
    /// # Errors
    /// The error of the first kernel in the list that the device refuses.
    pub(crate) async fn compile(&self, kernels: &[(Kernel, MeshForm)]) -> Result<(), GpuError> {
        let missing = kernels.iter().filter(|(kernel, form)| !self.pipelines.has(kernel, *form));
        let missing: Vec<_> = missing.cloned().collect();
        #[cfg(not(target_arch = "wasm32"))]
        for (kernel, form) in missing.iter().rev().cloned() {
            let gpu = self.clone();
            // This thread meets the error of a refused kernel too. A panic would end the process.
            rayon::spawn(move || {
                let _ = caught(move || gpu.pipelines.get(&gpu.device, &kernel, form).map(drop));
            });
        }
        for (kernel, form) in &missing {
            self.pipelines.get(&self.device, kernel, *form)?;
            pause().await;
        }
        Ok(())
    }
}

impl Gpu {
    /// Returns the features that a device needs: none beyond core WebGPU.
    pub fn required_features() -> wgpu::Features {
        wgpu::Features::empty()
    }

    /// Returns the optional features that this library uses: `TIMESTAMP_QUERY`, for
    /// [`Timestamps`](crate::gpu::Timestamps) and [`Budget::timed_by`](crate::gpu::Budget::timed_by). To have
    /// timestamps where the adapter supports them, request `adapter.features() & Gpu::optional_features()`.
    pub fn optional_features() -> wgpu::Features {
        wgpu::Features::TIMESTAMP_QUERY
    }

    /// Returns the limits to request for the device of an application that itself needs `own` and has meshes of up to
    /// `size`: `own`, raised where the kernels or the meshes need more. If a buffer is larger than the adapter can bind
    /// at once, the buffer is bound part by part, and `max_storage_buffer_binding_size` is the adapter's maximum.
    ///
    /// ```no_run
    /// # use gpu_smooth::{wgpu, Gpu, GpuError, MeshSize, gpu::VertexBuffer};
    /// # async fn f(adapter: wgpu::Adapter) -> Result<(), Box<dyn std::error::Error>> {
    /// let size = MeshSize { vertices: 100_000, triangles: 200_000 };
    /// // A vertex buffer with 32 bytes for each vertex.
    /// let own = wgpu::Limits {
    ///     max_storage_buffer_binding_size: VertexBuffer::binding_size(size.vertices, 32, 0)
    ///         .max(wgpu::Limits::default().max_storage_buffer_binding_size),
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
    /// The application's buffers are part of `own`. A vertex buffer with a long stride may need more than the mesh:
    /// raise `max_storage_buffer_binding_size` of `own` to
    /// [`VertexBuffer::binding_size`](crate::gpu::VertexBuffer::binding_size).
    ///
    /// # Errors
    /// [`GpuError::Limit`], with the name of the limit, if `available` (the adapter's limits) is too low for the
    /// kernels or the mesh. [`GpuError::TooLarge`] if the mesh has more than 4,294,967,294 vertices or 715,827,882
    /// triangles, the maxima of the kernels on any device. `own` is not checked here: the adapter checks the limits
    /// when the device is requested.
    pub fn required_limits(
        own: wgpu::Limits,
        size: MeshSize,
        available: &wgpu::Limits,
    ) -> Result<wgpu::Limits, GpuError> {
        limits::required(own, size, available)
    }

    /// Checks whether meshes of this size fit the limits of the device, bound part by part if need be. Allocates
    /// nothing.
    ///
    /// # Errors
    /// [`GpuError::Limit`], with the names of buffer and limit, if the mesh does not fit. [`GpuError::TooLarge`] if the
    /// mesh has more than 4,294,967,294 vertices or 715,827,882 triangles, the maxima of the kernels on any device.
    pub fn check_size(&self, size: MeshSize) -> Result<(), GpuError> {
        size.check(&self.device.limits())
    }
}

/// Returns whether the queue belongs to the device. A device that stays busy for [`MAX_POLLS`] milliseconds does not
/// tell, and the queue passes.
///
/// Only polls of a queue's own device report that the queue's work is done. If polls of an idle device bring no report,
/// the queue belongs to another device. Browsers have no polls, so there every queue passes.
fn is_own(queue: &wgpu::Queue, device: &wgpu::Device) -> bool {
    if cfg!(target_arch = "wasm32") {
        return true;
    }
    let reported = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&reported);
    queue.on_submitted_work_done(move || flag.store(true, Ordering::Relaxed));
    // wgpu submits the clearing of new buffers by itself, so that a device without work of the application is busy too.
    // A poll that does not wait may report such a device as busy until the next wait.
    let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(POLL) };
    let [mut idle_polls, mut busy_polls] = [0; 2];
    while idle_polls < MAX_POLLS && busy_polls < MAX_POLLS {
        let is_idle = poll(device, wait.clone()).is_ok_and(|status| status.is_queue_empty());
        if reported.load(Ordering::Relaxed) {
            return true;
        }
        if is_idle {
            idle_polls += 1;
            // A poll on another thread may have taken the report, and be about to deliver it.
            std::thread::sleep(POLL);
        } else {
            busy_polls += 1;
        }
    }
    idle_polls < MAX_POLLS
}

/// Number of polls of an idle device before a queue counts as foreign, and of a busy device before the queue passes.
const MAX_POLLS: u32 = 30;
/// Longest wait of a poll for a busy device, and time between two polls of an idle device.
const POLL: Duration = Duration::from_millis(1);
