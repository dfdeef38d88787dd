//! Comparison of a Vulkan driver, an OpenGL driver and the CPU engine on equal meshes. `tests/run` installs Mesa's
//! software drivers of both kinds; without one of them, tests fail.

use std::ops::ControlFlow;

use gpu_smooth::{
    Backend, CheckpointPolicy, Gpu, GpuError, Mesh, MeshSize, Method, Options, Outcome, Progress,
    Quality, Smoother, Stopping, wgpu,
};
use pollster::block_on;

use crate::app::bad_plate;
use support::check;

/// Opens a device of the first adapter of `backends`, with the library's required features and limits.
fn open(backends: wgpu::Backends) -> Gpu {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = block_on(instance.enumerate_adapters(backends));
    let adapter = adapters
        .first()
        .unwrap_or_else(|| panic!("there is no driver for {backends:?}; tests/run installs one"));
    let size = MeshSize { vertices: 2_000, triangles: 4_000 };
    let own = wgpu::Limits::downlevel_webgl2_defaults();
    let required_limits = Gpu::required_limits(own, size, &adapter.limits()).unwrap();
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    let (device, queue) = block_on(adapter.request_device(&descriptor)).unwrap();
    let gpu = Gpu::new(device, queue).unwrap();
    gpu.check_arithmetic().block().unwrap();
    gpu
}

/// Returns the largest distance between positions of a vertex in two results.
fn apart(a: &Outcome, b: &Outcome) -> f64 {
    let pairs = a.points.iter().zip(&b.points);
    pairs.map(|(a, b)| check::squared_distance(*a, *b).sqrt()).fold(0.0, f64::max)
}

#[test]
fn drivers_of_vulkan_and_of_opengl_agree_with_the_cpu() {
    let mesh = bad_plate(500);
    let smoother = Smoother::new(&mesh).unwrap();
    let edges = mesh.triangles.iter().flat_map(|&t| check::edges(t));
    let ends = |[a, b]: [u32; 2]| [mesh.points[a as usize], mesh.points[b as usize]];
    let lengths: Vec<f64> =
        edges.map(ends).map(|[a, b]| check::squared_distance(a, b).sqrt()).collect();
    let mean_edge = lengths.iter().sum::<f64>() / lengths.len() as f64;
    let [vulkan, gl] = [wgpu::Backends::VULKAN, wgpu::Backends::GL].map(open);
    let backends = [Backend::Cpu, Backend::Gpu(vulkan), Backend::Gpu(gl)];
    for (scheme, method) in
        [("imr", Method::RELAXED), ("imr", Method::Multilevel), ("edge+imr", Method::RELAXED)]
    {
        let scheme: gpu_smooth::Scheme = scheme.parse().unwrap();
        let base = scheme.base();
        let tolerance = 0.0;
        let options = Options::default()
            .scheme(scheme)
            .method(method)
            .max_sweeps(8)
            .stopping(Stopping::Tolerance(tolerance));
        let [cpu, vulkan, gl] =
            backends.each_ref().map(|backend| smoother.run(&options).on(backend).block().unwrap());
        let f =
            |outcome: &Outcome| Quality::of(&outcome.points, smoother.topology()).unwrap().f(base);
        for (name, other) in [("vulkan", &vulkan), ("gl", &gl)] {
            let label = format!("{} {method:?} on {name}", options.scheme);
            let (off, apart) = (f(other) / f(&cpu) - 1.0, apart(other, &cpu) / mean_edge);
            assert_eq!(other.sweeps, 8, "{label}");
            // Largest measured differences over all metrics: 1.5e-7 in f; 5e-5 edges for `edge`, less for other
            // metrics.
            // Newton steps of all vertices on the CPU are nearer to the limit than corrections on a device.
            let most = if cpu.newton_steps > 0 { 1e-2 } else { 1e-3 };
            assert!(off.abs() < 1e-6 && apart < most, "{label}: f off by {off:e}, {apart:e} edges");
        }
        let (off, apart) = (f(&gl) / f(&vulkan) - 1.0, apart(&gl, &vulkan) / mean_edge);
        assert!(
            off.abs() < 1e-6 && apart < 1e-3,
            "{base} by drivers: f off by {off:e}, {apart:e} edges"
        );
    }
}

/// A policy that continues a run on the CPU after a failure of the device.
struct GoesOn;

impl CheckpointPolicy for GoesOn {
    fn falls_back_to_cpu(&mut self, error: &GpuError, _: u32) -> bool {
        assert!(matches!(error, GpuError::Lost(_)), "{error}");
        true
    }
}

#[test]
fn a_run_goes_on_on_the_cpu_when_a_device_of_opengl_is_lost() {
    let mesh = bad_plate(500);
    let smoother = Smoother::new(&mesh).unwrap();
    let gpu = open(wgpu::Backends::GL);
    let device = gpu.device().clone();
    let options = Options::default().stopping(Stopping::Tolerance(0.0)).max_sweeps(20);
    let observe = |progress: &Progress| {
        if progress.sweep >= 4 {
            device.destroy();
        }
        ControlFlow::Continue(())
    };
    let backend = Backend::Gpu(gpu);
    let outcome = smoother
        .run(&options)
        .on(&backend)
        .checkpoints(&mut GoesOn)
        .observe(observe)
        .block()
        .unwrap();
    assert!(outcome.device_fault.is_some());
    assert_eq!(outcome.sweeps, 20);
    let smoothed = Mesh { points: outcome.points, ..mesh.clone() };
    assert!(check::is_valid(&smoothed) && check::same_orientations(&mesh, &smoothed));
}
