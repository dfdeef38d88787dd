//! Calls that the browser refuses, to check that the errors reach the caller.

use gpu_smooth::{Backend, Gpu, GpuError, Mesh, Options, SmoothError, Smoother, gpu::Readback, wgpu};

/// Returns the error of a buffer of another device, the result of a run after that, and the error of a run on a lost
/// device. The devices are opened for these calls.
pub(crate) async fn all(mesh: &Mesh) -> Result<Vec<String>, GpuError> {
    let gpu = Gpu::open(None).await?;
    let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("of another device"),
        size: 64,
        usage: wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let other = Gpu::open(None).await?;
    let refused = match Readback::<f32>::new(&other, buffer.slice(..), 4) {
        Ok(_) => other.errors().await,
        Err(error) => Err(error),
    };
    let valid = run(mesh, &other).await;
    other.device().destroy();
    let lost = run(mesh, &other).await;
    Ok(vec![text(refused), text(valid), text(lost)])
}

async fn run(mesh: &Mesh, gpu: &Gpu) -> Result<(), SmoothError> {
    let smoother = Smoother::new(mesh)?;
    let backend = Backend::Gpu(gpu.clone());
    smoother.run(&Options::default()).on(&backend).await.map(|_| ())
}

fn text<E: std::fmt::Display>(result: Result<(), E>) -> String {
    result.map_or_else(|error| error.to_string(), |()| "no error".to_owned())
}
