//! Times of GPU kernels, measured with the device's timestamps.

use gpu_smooth::{
    Gpu, GpuError, Mesh, Options, SmoothError,
    gpu::{DeviceMesh, Kernel, Span, Sweeps, Timestamps},
    internal::{self, Plan, Problem},
    wgpu,
};

/// Number of sweeps before timing starts, to warm up the device.
const BEFORE: u32 = 6;
/// Number of timed sweeps.
const TIMED: u32 = 5;
/// Number of iterations of conjugate gradients in the timed Newton step. Last steps of runs on ordinary meshes take about as many.
pub(crate) const ITERATIONS: u32 = 10;

/// Time of a kernel per sweep, or per Newton step.
pub(crate) struct KernelTime {
    pub(crate) kernel: Kernel,
    /// Number of dispatches of the kernel per sweep or step.
    pub(crate) passes: u32,
    pub(crate) seconds: f64,
}

/// Times the kernels of a sweep and of the objective, in the order of execution; with [`Method::Multilevel`], those of
/// the correction after the sweep too. `None` if the device has no timestamps.
///
/// [`Method::Multilevel`]: gpu_smooth::Method::Multilevel
///
/// The timestamps separate the kernels, each of which waits for the end of the kernel before. So the times add up to
/// more than the time of a sweep without timestamps, above all on small meshes.
pub(crate) fn time(
    gpu: &Gpu,
    mesh: &Mesh,
    options: &Options,
) -> Result<Option<Vec<KernelTime>>, SmoothError> {
    let Ok(mut timestamps) = Timestamps::new(gpu) else { return Ok(None) };
    let device_mesh = DeviceMesh::new(gpu, mesh)?;
    let mut sweeps = Sweeps::new(&device_mesh, options).block()?;
    let values = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("objectives"),
        size: size_of::<gpu_smooth::gpu::ObjectiveValues>() as u64,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    });
    let objective = sweeps.bind_objective(values.slice(..))?;
    let mut encoder =
        gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    sweeps.encode_sweeps(&mut encoder, BEFORE);
    let mut timed = timestamps.time(&mut encoder);
    for _ in 0..TIMED {
        sweeps.encode_sweeps(&mut timed, 1);
        objective.encode_objective(&mut timed);
    }
    let spans = timed.resolve()?;
    gpu.queue().submit([encoder.finish()]);
    // Runs do not copy their objectives to a buffer of the application.
    let of_run = |span: &Span| span.kernel != Kernel::WriteObjective;
    let spans = spans.read().block()?.into_iter().filter(of_run);
    Ok(Some(by_kernel(spans, TIMED)))
}

/// Times the kernels of a Newton step with [`ITERATIONS`] iterations, by which runs end. `None` if the device has no timestamps, or
/// takes no such steps by the options.
pub(crate) fn time_step(
    gpu: &Gpu,
    problem: &Problem,
    plan: Plan,
) -> Result<Option<Vec<KernelTime>>, GpuError> {
    let Ok(mut timestamps) = Timestamps::new(gpu) else { return Ok(None) };
    let spans = internal::time_step(gpu, problem, plan, BEFORE, ITERATIONS, &mut timestamps)?;
    Ok(spans.map(|spans| by_kernel(spans.into_iter(), 1)))
}

/// Adds up the spans of each kernel, in the order of their first spans, for one of `times` repetitions.
fn by_kernel(spans: impl Iterator<Item = Span>, times: u32) -> Vec<KernelTime> {
    let mut kernels: Vec<KernelTime> = Vec::new();
    for span in spans {
        let seconds = span.nanoseconds * 1e-9 / f64::from(times);
        match kernels.iter_mut().find(|known| known.kernel == span.kernel) {
            Some(known) => {
                known.passes += 1;
                known.seconds += seconds;
            }
            None => kernels.push(KernelTime { kernel: span.kernel, passes: 1, seconds }),
        }
    }
    kernels.iter_mut().for_each(|known| known.passes /= times);
    kernels
}
