//! Adapters and devices, and every way wgpu says no.

use std::sync::{Arc, Mutex, PoisonError};

use super::kernel::Pipelines;
use super::shaders::{Kernel, Positions};
use crate::error::SmoothError;
use crate::options::Options;

/// The GPU engine cannot start or go on.
#[derive(Clone, Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter, or none of that name.
    #[error("no GPU adapter{}", lacking(wanted.as_deref(), available))]
    NoAdapter {
        /// The name that was asked for.
        wanted: Option<String>,
        /// The names there are, separated by commas.
        available: String,
    },
    /// The adapter would not give a device.
    #[error("the adapter {adapter} gave no device: {message}")]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// What wgpu said.
        message: String,
    },
    /// A limit of the device is too low for this mesh.
    #[error("{what} needs {needed}, but the device's {limit} is {available}")]
    Limit {
        /// What does not fit.
        what: String,
        /// How much it needs.
        needed: u64,
        /// The limit's name in wgpu.
        limit: &'static str,
        /// Its value on this device.
        available: u64,
    },
    /// A feature that this takes was not asked for when the device was made.
    #[error("{what} needs a device made with the feature {feature}")]
    Feature {
        /// What takes it.
        what: &'static str,
        /// Its name in wgpu.
        feature: &'static str,
    },
    /// The device has no memory left.
    #[error("the device is out of memory: {0}")]
    OutOfMemory(String),
    /// A buffer of the application cannot be used as asked.
    #[error("the application's buffer cannot be used: {0}")]
    Buffer(String),
    /// wgpu refused a call: a bug in this library, or a device made with other limits.
    #[error("the device refused: {0}")]
    Refused(String),
    /// The device was lost or destroyed; the run is lost with it.
    #[error("the device was lost: {0}")]
    Lost(String),
}

fn lacking(wanted: Option<&str>, available: &str) -> String {
    match wanted {
        None => " was found".into(),
        Some(name) if available.is_empty() => format!(" was found, so none called '{name}'"),
        Some(name) => format!(" has '{name}' in its name; there are: {available}"),
    }
}

/// What an adapter is called and how wgpu drives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// The name, for example of the graphics card.
    pub name: String,
    /// Driver and version.
    pub driver: String,
    /// wgpu's backend: vulkan, metal, dx12 or gl.
    pub backend: String,
    /// "discrete GPU", "integrated GPU", "virtual GPU", "CPU" (software) or "other".
    pub kind: &'static str,
}

impl AdapterSummary {
    fn new(info: &wgpu::AdapterInfo) -> Self {
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete GPU",
            wgpu::DeviceType::IntegratedGpu => "integrated GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Cpu => "CPU",
            wgpu::DeviceType::Other => "other",
        };
        let driver = [info.driver.trim(), info.driver_info.trim()];
        let driver: Vec<_> = driver.into_iter().filter(|part| !part.is_empty()).collect();
        Self {
            name: info.name.clone(),
            driver: driver.join(" "),
            backend: info.backend.to_string(),
            kind,
        }
    }
}

/// A device with its pipelines: made once, it serves many meshes. A handle: clones name the same.
#[derive(Clone)]
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) pipelines: Arc<Pipelines>,
    summary: Arc<AdapterSummary>,
    lost: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens the best adapter, or the first whose name contains `name` (whatever the case).
    /// Discrete GPUs come before integrated, virtual and software ones.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`], [`GpuError::NoDevice`], or what the device refuses.
    pub fn open(name: Option<&str>) -> Result<Self, GpuError> {
        let adapters = ranked_adapters();
        let has_name = |adapter: &&wgpu::Adapter| {
            let text = adapter.get_info().name.to_lowercase();
            name.is_none_or(|name| text.contains(&name.to_lowercase()))
        };
        let adapter = adapters.iter().find(has_name).ok_or_else(|| {
            let names: Vec<_> = adapters.iter().map(|a| a.get_info().name).collect();
            GpuError::NoAdapter { wanted: name.map(str::to_owned), available: names.join(", ") }
        })?;
        let summary = AdapterSummary::new(&adapter.get_info());
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("gpu-smooth device"),
            required_features: adapter.features() & Self::optional_features(),
            required_limits: adapter.limits(),
            ..Default::default()
        }))
        .map_err(|error| GpuError::NoDevice {
            adapter: summary.name.clone(),
            message: error.to_string(),
        })?;
        let lost = Arc::new(Mutex::new(None));
        let flag = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            let text = if message.is_empty() { format!("{reason:?}") } else { message };
            *flag.lock().unwrap_or_else(PoisonError::into_inner) = Some(text);
        });
        // Every call is in an error scope; what still arrives here would otherwise panic.
        let flag = Arc::clone(&lost);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            *flag.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.to_string());
        }));
        Self::with(device, queue, summary, lost)
    }

    /// Takes an application's own device and queue (both are handles: clones name the same device).
    ///
    /// It has to be made with [`Self::required_limits`] or better. Its callbacks for errors and
    /// for loss stay the application's: this library catches the errors of its own calls in error
    /// scopes, and learns of a lost device by reading back. What is wrong with an encoder that was passed in (it
    /// is of another device, or finished) wgpu reports when the application finishes it, to the application.
    ///
    /// # Panics
    /// Nothing here does. But wgpu itself panics where resources of two *instances* meet, in its own calls as in
    /// this library's: an application has one [`wgpu::Instance`].
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device binds too few storage buffers, or what it refuses.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, GpuError> {
        let summary = AdapterSummary::new(&device.adapter_info());
        Self::with(device, queue, summary, Arc::default())
    }

    fn with(
        device: wgpu::Device,
        queue: wgpu::Queue,
        summary: AdapterSummary,
        lost: Arc<Mutex<Option<String>>>,
    ) -> Result<Self, GpuError> {
        super::limits::check(&device.limits())?;
        let pipelines = Arc::new(Pipelines::default());
        Ok(Self { device, queue, pipelines, summary: Arc::new(summary), lost })
    }

    /// Compiles all that meshes take with these options, so that neither a frame nor a later
    /// [`Sweeps::new`](super::Sweeps::new) has to wait for it. What is compiled already costs nothing; another
    /// thread can do it meanwhile. Meshes so large that their positions take two bindings compile for themselves.
    ///
    /// # Errors
    /// [`SmoothError::Option`] for an option out of its range, or what the device refuses.
    pub fn prepare(&self, options: &Options) -> Result<(), SmoothError> {
        options.check()?;
        let mut kernels = Kernel::needed_by(&options.plan());
        if options.is_multilevel() {
            kernels.extend(Kernel::of_levels(options.scheme.base()));
        }
        for kernel in kernels {
            self.pipelines.get(&self.device, &kernel, Positions::Whole)?;
        }
        Ok(())
    }

    /// The device, a handle.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue, a handle.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// The adapter in use.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.summary
    }

    /// Fails if the device is lost: most calls on a lost device look as if they had worked.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        match &*self.lost.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(message) => Err(GpuError::Lost(message.clone())),
            None => Ok(()),
        }
    }
}

/// Every adapter there is, the one that would be chosen first in front.
pub fn adapters() -> Vec<AdapterSummary> {
    ranked_adapters().iter().map(|adapter| AdapterSummary::new(&adapter.get_info())).collect()
}

/// Usable adapters, fastest kind first. OpenGL is only looked at where there is nothing better: it
/// shows the same devices again, and its driver is slow to start.
fn ranked_adapters() -> Vec<wgpu::Adapter> {
    let native = usable_adapters(wgpu::Backends::PRIMARY);
    if native.is_empty() { usable_adapters(wgpu::Backends::SECONDARY) } else { native }
}

fn usable_adapters(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        // Validation layers print to the caller's terminal.
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
    let can_compute = |adapter: &wgpu::Adapter| {
        let downlevel = adapter.get_downlevel_capabilities();
        downlevel.flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
    };
    adapters.retain(can_compute);
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

/// Runs wgpu calls and turns whatever the device says about them into an error.
pub(crate) fn scoped<T>(device: &wgpu::Device, calls: impl FnOnce() -> T) -> Result<T, GpuError> {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let value = calls();
    let internal = pollster::block_on(internal.pop());
    let memory = pollster::block_on(memory.pop());
    let validation = pollster::block_on(validation.pop());
    if let Some(error) = memory {
        return Err(GpuError::OutOfMemory(error.to_string()));
    }
    match internal.or(validation) {
        // What wgpu says of a lost device are its consequences: "... is invalid".
        Some(_) if is_lost(device) => Err(GpuError::Lost("it makes no buffers any more".into())),
        Some(error) => Err(GpuError::Refused(error.to_string())),
        None => Ok(value),
    }
}

/// Whether the device is lost, found by trial: it then makes a buffer that cannot be mapped, without
/// a word to the error scopes.
fn is_lost(device: &wgpu::Device) -> bool {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("gpu-smooth trial"),
        size: wgpu::COPY_BUFFER_ALIGNMENT,
        usage: wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: true,
    });
    let is_mapped = buffer.get_mapped_range_mut(..).is_ok();
    let memory = pollster::block_on(memory.pop());
    let _ = pollster::block_on(validation.pop());
    !is_mapped && memory.is_none()
}
