//! The application: reactions to the pointer and the keys, and the content of a frame. Draws into any texture, with or
//! without a window.

use gpu_smooth::{Gpu, Mesh, Metric, Scheme, wgpu};
use std::path::Path;
use std::time::{Duration, Instant};

use super::Result;
use super::capture;
use super::drag::{Drag, Holes};
use super::overlay::{Line, Panel};
use super::render::Renderer;
use super::smoothing::Smoothing;
use super::view::View;

/// Largest distance in pixels between the pointer and a grabbed vertex.
const RADIUS: f64 = 40.0;
/// Selectable device times for sweeps in a frame, in microseconds.
const BUDGETS: [u64; 6] = [250, 500, 1000, 2000, 4000, 8000];

/// Opens a device with the limits for smoothing the mesh. `surface` is the surface to draw on; `None` without a window.
pub(crate) fn open(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    mesh: &Mesh,
) -> Result<(wgpu::Adapter, wgpu::Device, wgpu::Queue)> {
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        compatible_surface: surface,
        ..Default::default()
    }));
    let adapter = adapter.map_err(|error| {
        format!("no GPU adapter: {error}. A software one, such as Mesa's lavapipe, is enough")
    })?;
    let size = mesh.size();
    let available = adapter.limits();
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        // With timestamps, if available, the budget adapts the number of sweeps.
        required_features: adapter.features() & Gpu::optional_features(),
        // Limits that the smoother needs, and textures large enough for any window.
        required_limits: Gpu::required_limits(
            wgpu::Limits::downlevel_defaults().using_resolution(available.clone()),
            size,
            &available,
        )?,
        ..Default::default()
    }))?;
    Ok((adapter, device, queue))
}

/// The application without its window.
pub(crate) struct App {
    pub(crate) smoothing: Smoothing,
    renderer: Renderer,
    panel: Panel,
    holes: Holes,
    drag: Option<Drag>,
    size: [u32; 2],
    view: View,
    metric: Metric,
    alternates: bool,
    paused: bool,
    /// Whether dragged vertices follow the pointer even if triangles invert.
    free_hand: bool,
    /// Index of the current choice in [`BUDGETS`].
    budget: usize,
    /// Number of sweeps encoded in the last frame.
    sweeps: u32,
    meter: Meter,
}

impl App {
    /// Makes an application that smooths the mesh on a device, and draws in a texture format. Call
    /// [`resize`](Self::resize) before the first frame.
    pub(crate) fn new(
        device: wgpu::Device,
        queue: wgpu::Queue,
        format: wgpu::TextureFormat,
        mesh: Mesh,
    ) -> Result<Self> {
        let handles = (device.clone(), queue.clone());
        let smoothing = Smoothing::new(Gpu::new(device, queue)?, mesh, Metric::Imr.into())?;
        let (topology, points) = (&smoothing.topology, &smoothing.points);
        let panel = Panel::new();
        let vertices = smoothing.vertices.clone();
        Ok(Self {
            renderer: Renderer::new(handles, format, topology, vertices, &panel),
            holes: Holes::new(topology, points),
            view: View::new(points, [1, 1], 0),
            panel,
            drag: None,
            size: [1, 1],
            metric: Metric::Imr,
            alternates: false,
            paused: false,
            free_hand: false,
            budget: 3,
            sweeps: 0,
            meter: Meter::new(),
            smoothing,
        })
    }

    /// Sets the size of the window in pixels. Each pixel of the panel covers `enlargement` by `enlargement` pixels.
    pub(crate) fn resize(&mut self, size: [u32; 2], enlargement: u32) {
        self.size = size;
        let panel_height = enlargement * self.panel.size()[1];
        self.view = View::new(&self.smoothing.mesh.points, size, panel_height);
        self.renderer.show(self.view, enlargement);
    }

    pub(crate) fn view(&self) -> View {
        self.view
    }

    /// Grabs the vertex or hole nearest to the pointer. The position of the pointer is in pixels.
    pub(crate) fn press(&mut self, pointer: [f64; 2]) -> Result<()> {
        self.smoothing.receive()?;
        let Smoothing { topology, points, .. } = &self.smoothing;
        let [at, aside] =
            [pointer, [pointer[0] + RADIUS, pointer[1]]].map(|p| self.view.to_plane(p));
        self.drag = Drag::grab(topology, &self.holes, points, at, aside[0] - at[0]);
        self.hold()
    }

    pub(crate) fn move_to(&mut self, pointer: [f64; 2]) {
        if let Some(drag) = &mut self.drag {
            drag.aim(self.view.to_plane(pointer));
        }
    }

    pub(crate) fn release(&mut self) -> Result<()> {
        self.drag = None;
        self.hold()
    }

    fn hold(&mut self) -> Result<()> {
        let held = self.drag.as_ref().map_or(&[][..], Drag::vertices);
        self.renderer.mark(held);
        self.smoothing.hold(held, !self.free_hand)
    }

    pub(crate) fn key(&mut self, key: char) -> Result<()> {
        match key.to_ascii_lowercase() {
            digit @ '1'..='5' => self.metric = Metric::ALL[digit as usize - '1' as usize],
            'a' => self.alternates = !self.alternates,
            ' ' => self.paused = !self.paused,
            '+' | '=' => self.set_budget((self.budget + 1).min(BUDGETS.len() - 1))?,
            '-' => self.set_budget(self.budget.saturating_sub(1))?,
            'f' => {
                self.release()?;
                self.free_hand = !self.free_hand;
            }
            'r' => {
                self.release()?;
                self.smoothing.reset();
            }
            _ => {}
        }
        let alternating = Scheme::new([self.metric, Metric::Imr]).filter(|_| self.alternates);
        let scheme = alternating.unwrap_or_else(|| self.metric.into());
        if scheme != *self.smoothing.scheme() {
            self.smoothing.set_scheme(scheme)?;
        }
        Ok(())
    }

    fn set_budget(&mut self, budget: usize) -> Result<()> {
        self.budget = budget;
        self.smoothing.set_budget(BUDGETS[budget])
    }

    /// Computes and draws a frame in a single command buffer.
    pub(crate) fn frame(&mut self, target: &wgpu::TextureView) -> Result<()> {
        self.smoothing.receive()?;
        self.update_panel();
        if let Some(drag) = &self.drag {
            let goals = drag.goals(&self.smoothing.points, self.free_hand);
            self.smoothing.aim(drag.vertices(), &goals);
        }
        let device = self.smoothing.gpu.device();
        let mut encoder = device.create_command_encoder(&Default::default());
        self.sweeps = self.smoothing.encode(&mut encoder, self.paused);
        self.renderer.draw(&mut encoder, target);
        self.smoothing.gpu.queue().submit([encoder.finish()]);
        self.meter.count(self.sweeps);
        Ok(())
    }

    /// Writes a picture of the last frame, whose results the panel then shows.
    pub(crate) fn capture(&mut self, path: &Path) -> Result<()> {
        self.smoothing.wait()?;
        self.update_panel();
        let gpu = &self.smoothing.gpu;
        let draw = |encoder: &mut _, target: &_| self.renderer.draw(encoder, target);
        let handles = (gpu.device(), gpu.queue());
        capture::capture(handles, self.renderer.format, self.size, draw, path)
    }

    fn update_panel(&mut self) {
        let Smoothing { mesh, objectives, .. } = &self.smoothing;
        let base = self.smoothing.scheme().base();
        let (each, [sweeps, frames]) = (self.sweeps, self.meter.rates);
        let state = match (self.paused, objectives.stop()) {
            (true, _) => "paused".to_owned(),
            (false, Some(stop)) => format!("{} after {} sweeps", stop.name(), objectives.sweeps),
            (false, None) if each == 1 => "1 sweep a frame".to_owned(),
            (false, None) => format!("{each} sweeps a frame"),
        };
        let hand = if self.free_hand { "free" } else { "stops before a triangle inverts" };
        let line = |label, text: &str| -> Line { (label, text.to_owned()) };
        let status = vec![
            ("mesh", format!("{} vertices, {} triangles", mesh.points.len(), mesh.triangles.len())),
            ("scheme", format!("{}, {state}", self.smoothing.scheme())),
            ("f", format!("{:.4} by {base}", objectives.of(base))),
            ("worst", format!("{:.2} inverse mean ratio", objectives.worst_imr)),
            ("inverted", objectives.inverted.to_string()),
            ("speed", format!("{sweeps:.0} sweeps/s, {frames:.0} frames/s")),
        ];
        let help = vec![
            line("drag", "a vertex, or the edge of a hole"),
            (
                "1 2 3 4 5",
                Metric::ALL[..5].iter().map(|metric| metric.name()).collect::<Vec<_>>().join(", "),
            ),
            line("A", "alternate with imr"),
            ("F", format!("hand: {hand}")),
            ("+ -", format!("sweeps for {} ms in a frame", BUDGETS[self.budget] as f64 / 1e3)),
            line("space", "pause     R  start again     Esc  quit"),
        ];
        if self.panel.show([status, help]) {
            self.renderer.set_panel(&self.panel);
        }
    }
}

/// Rates of sweeps and frames per second, updated twice a second.
struct Meter {
    since: Instant,
    counts: [u32; 2],
    rates: [f64; 2],
}

impl Meter {
    fn new() -> Self {
        Self { since: Instant::now(), counts: [0; 2], rates: [0.0; 2] }
    }

    fn count(&mut self, sweeps: u32) {
        self.counts = [self.counts[0] + sweeps, self.counts[1] + 1];
        let elapsed = self.since.elapsed();
        if elapsed >= Duration::from_millis(500) {
            let rates = self.counts.map(|count| f64::from(count) / elapsed.as_secs_f64());
            *self = Self { rates, ..Self::new() };
        }
    }
}
