//! The application in a window.

use gpu_smooth::wgpu::{self, CurrentSurfaceTexture};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::event::{ElementState, MouseButton, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

use super::app::{App, open};
use super::{Request, Result};

/// Delay before the next request for a frame, after a frame could not be drawn.
const RETRY: Duration = Duration::from_millis(100);

pub(crate) fn run(request: Request) -> Result<()> {
    let event_loop = EventLoop::new()
        .map_err(|error| format!("there is no display for a window, see --headless ({error})"))?;
    let mut shell = Shell { request: Some(request), stage: None, problem: None };
    event_loop.run_app(&mut shell)?;
    shell.problem.map_or(Ok(()), Err)
}

/// The handler of winit's events.
struct Shell {
    /// The content to show, before the window is created.
    request: Option<Request>,
    stage: Option<Stage>,
    problem: Option<Box<dyn std::error::Error>>,
}

/// The window and its surface, with the application drawn there.
struct Stage {
    instance: wgpu::Instance,
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    device: wgpu::Device,
    queue: wgpu::Queue,
    app: App,
    script: Option<super::script::Script>,
    pointer: [f64; 2],
    occluded: bool,
}

impl Stage {
    fn new(event_loop: &ActiveEventLoop, request: Request) -> Result<Self> {
        let Request { mesh, size: [width, height], script } = request;
        let attributes = Window::default_attributes()
            .with_title("gpu-smooth live")
            .with_inner_size(PhysicalSize::new(width, height))
            // The minimum width is that of the panel.
            .with_min_inner_size(LogicalSize::new(904, 480));
        let window = Arc::new(event_loop.create_window(attributes)?);
        let display = Box::new(event_loop.owned_display_handle());
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle(display);
        let instance = wgpu::Instance::new(descriptor);
        let surface = instance.create_surface(window.clone())?;
        let (adapter, device, queue) = open(&instance, Some(&surface), &mesh)?;
        let mut config = surface
            .get_default_config(&adapter, 1, 1)
            .ok_or("the adapter cannot draw to this window")?;
        let formats = surface.get_capabilities(&adapter).formats;
        config.format = formats.into_iter().find(|f| f.is_srgb()).unwrap_or(config.format);
        config.present_mode = wgpu::PresentMode::AutoVsync;
        let app = App::new(device.clone(), queue.clone(), config.format, mesh)?;
        let (pointer, occluded) = ([0.0; 2], false);
        let mut stage = Self {
            instance,
            window,
            surface,
            config,
            device,
            queue,
            app,
            script,
            pointer,
            occluded,
        };
        stage.resize();
        Ok(stage)
    }

    /// Adapts surface and application to the size of the window.
    fn resize(&mut self) {
        let PhysicalSize { width, height } = self.window.inner_size();
        // A minimized window has no pixels, but a surface must have some.
        if width == 0 || height == 0 {
            return;
        }
        (self.config.width, self.config.height) = (width, height);
        self.surface.configure(&self.device, &self.config);
        let enlargement = self.window.scale_factor().round().max(1.0);
        self.app.resize([width, height], enlargement as u32);
        self.window.request_redraw();
    }

    /// Draws a frame if the window is visible. Returns whether the application continues.
    fn draw(&mut self, event_loop: &ActiveEventLoop) -> Result<bool> {
        let size = self.window.inner_size();
        if self.occluded || size.width == 0 || size.height == 0 {
            // The window system sends an event when the window becomes visible again.
            return Ok(true);
        }
        let (texture, reconfigure) = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(texture) => (texture, false),
            CurrentSurfaceTexture::Suboptimal(texture) => (texture, true),
            CurrentSurfaceTexture::Outdated => {
                self.resize();
                return Ok(true);
            }
            CurrentSurfaceTexture::Lost => {
                self.surface = self.instance.create_surface(self.window.clone())?;
                self.resize();
                return Ok(true);
            }
            CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => {
                event_loop.set_control_flow(ControlFlow::WaitUntil(Instant::now() + RETRY));
                return Ok(true);
            }
            CurrentSurfaceTexture::Validation => return Err("the surface is not valid".into()),
        };
        if let Some(script) = &mut self.script
            && !script.advance(&mut self.app)?
        {
            return Ok(false);
        }
        self.app.frame(&texture.texture.create_view(&Default::default()))?;
        self.window.pre_present_notify();
        self.queue.present(texture);
        if reconfigure {
            self.resize();
        }
        self.window.request_redraw();
        Ok(true)
    }

    /// Handles an event. Returns whether the application continues.
    fn handle(&mut self, event_loop: &ActiveEventLoop, event: WindowEvent) -> Result<bool> {
        match event {
            WindowEvent::CloseRequested => return Ok(false),
            WindowEvent::RedrawRequested => return self.draw(event_loop),
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => self.resize(),
            WindowEvent::Occluded(occluded) => {
                self.occluded = occluded;
                self.window.request_redraw();
            }
            // During a script, input of the user is ignored.
            _ if self.script.is_some() => {}
            WindowEvent::CursorMoved { position, .. } => {
                self.pointer = position.into();
                self.app.move_to(self.pointer);
            }
            WindowEvent::MouseInput { state, button: MouseButton::Left, .. } => match state {
                ElementState::Pressed => self.app.press(self.pointer)?,
                ElementState::Released => self.app.release()?,
            },
            WindowEvent::Focused(false) => self.app.release()?,
            WindowEvent::KeyboardInput { event, .. } if event.state.is_pressed() => {
                match event.logical_key.as_ref() {
                    Key::Named(NamedKey::Escape) => return Ok(false),
                    Key::Named(NamedKey::Space) => self.app.key(' ')?,
                    Key::Character(text) => text.chars().try_for_each(|key| self.app.key(key))?,
                    _ => {}
                }
            }
            _ => {}
        }
        Ok(true)
    }
}

impl ApplicationHandler for Shell {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let Some(request) = self.request.take() else { return };
        match Stage::new(event_loop, request) {
            Ok(stage) => self.stage = Some(stage),
            Err(problem) => {
                self.problem = Some(problem);
                event_loop.exit();
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(stage) = &mut self.stage else { return };
        let result = stage.handle(event_loop, event);
        if !matches!(result, Ok(true)) {
            self.problem = result.err();
            // The surface must be dropped before the event loop that created its window.
            self.stage = None;
            event_loop.exit();
        }
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(stage)) = (cause, &self.stage) {
            event_loop.set_control_flow(ControlFlow::Wait);
            stage.window.request_redraw();
        }
    }
}
