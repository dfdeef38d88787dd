//! A picture of the window as a PNG file.

use gpu_smooth::wgpu;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use super::Result;
use super::render::extent;

/// Draws into a new texture of the given format and size, and writes the texture as a PNG file.
pub(crate) fn capture(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    draw: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::TextureView),
    path: &Path,
) -> Result<()> {
    let blue_first = match format.remove_srgb_suffix() {
        wgpu::TextureFormat::Rgba8Unorm => false,
        wgpu::TextureFormat::Bgra8Unorm => true,
        other => return Err(format!("no screenshot can be made of {other:?}").into()),
    };
    let texture = device.create_texture(&texture(format, [width, height]));
    let bytes_per_row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("screenshot"),
        size: u64::from(bytes_per_row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    draw(&mut encoder, &texture.create_view(&Default::default()));
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(bytes_per_row),
        rows_per_image: Some(height),
    };
    let destination = wgpu::TexelCopyBufferInfo { buffer: &staging, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), destination, texture.size());
    queue.submit([encoder.finish()]);

    let (sender, receiver) = std::sync::mpsc::channel();
    staging.slice(..).map_async(wgpu::MapMode::Read, move |result| drop(sender.send(result)));
    device.poll(wgpu::PollType::wait_indefinitely())?;
    receiver.recv()??;
    let mut pixels = Vec::with_capacity((4 * width * height) as usize);
    for row in staging.slice(..).get_mapped_range()?.chunks_exact(bytes_per_row as usize) {
        pixels.extend_from_slice(&row[..4 * width as usize]);
    }
    if blue_first {
        pixels.chunks_exact_mut(4).for_each(|pixel| pixel.swap(0, 2));
    }

    let file = File::create(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(())
}

/// Returns the descriptor of a texture for drawing and copying.
pub(crate) fn texture(
    format: wgpu::TextureFormat,
    size: [u32; 2],
) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: Some("picture"),
        size: extent(size),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    }
}
