//! The application without a window: a script replaces the user, and a texture replaces the window.

use gpu_smooth::{Mesh, wgpu};

use super::app::{App, open};
use super::{Request, Result, capture};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Creates the application and the texture into which frames are drawn.
pub(crate) fn start(mesh: Mesh, size: [u32; 2]) -> Result<(App, wgpu::TextureView)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let (_, device, queue) = open(&instance, None, &mesh)?;
    let texture = device.create_texture(&capture::texture(FORMAT, size));
    let mut app = App::new(device, queue, FORMAT, mesh)?;
    app.resize(size, 1);
    Ok((app, texture.create_view(&Default::default())))
}

pub(crate) fn run(request: Request) -> Result<()> {
    let Request { mesh, size, script } = request;
    let (mut app, target) = start(mesh, size)?;
    let Some(mut script) = script else { return Ok(()) };
    while script.advance(&mut app)? {
        app.frame(&target)?;
        app.smoothing.wait()?;
    }
    Ok(())
}
