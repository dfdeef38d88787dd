//! Execution of test entry points, appended to WGSL of the library, on the library's default adapter.

use bytemuck::Pod;
use gpu_smooth::wgpu::{self, util::DeviceExt};

/// Returns WGSL to append to a module of the library. In each invocation, the entry point reads a row of numbers and
/// writes another, through bindings beside those of a run. `body` reads its row from `x` and writes its results to `y`.
pub(crate) fn probe(inputs: usize, outputs: usize, body: &str) -> String {
    format!(
        "
@group(0) @binding(9) var<storage, read> probe_in: array<array<f32, {inputs}>>;
@group(0) @binding(10) var<storage, read_write> probe_out: array<array<f32, {outputs}>>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {{
    if id.x >= arrayLength(&probe_in) || params.zero != 0u {{
        return;
    }}
    let x = probe_in[id.x];
    var y: array<f32, {outputs}>;
{body}
    probe_out[id.x] = y;
}}
"
    )
}

pub(crate) struct Device {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

impl Device {
    /// Opens the adapter. Panics without an adapter, because tests must not appear to pass without running.
    pub(crate) fn open() -> Self {
        let chosen = gpu_smooth::gpu::adapters();
        let chosen = chosen.first().expect("these tests need a wgpu adapter, be it a software one");
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let all = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        let same = |adapter: &&wgpu::Adapter| {
            let info = adapter.get_info();
            info.name == chosen.name && info.backend.to_string() == chosen.backend
        };
        let adapter = all.iter().find(same).expect("the adapter that was just listed");
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).unwrap();
        Self { device, queue }
    }

    /// Runs the entry point `probe` of `wgsl` on these rows.
    pub(crate) fn run<I: Pod, O: Pod>(&self, wgsl: &str, rows: &[I]) -> Vec<O> {
        use wgpu::BufferUsages as Usage;
        let device = &self.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("probe"),
            source: wgpu::ShaderSource::Wgsl(wgsl.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("probe"),
            layout: None,
            module: &module,
            entry_point: Some("probe"),
            compilation_options: Default::default(),
            cache: None,
        });
        let filled = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("probe"),
                contents,
                usage,
            })
        };
        let size = (rows.len() * size_of::<O>()) as u64;
        let empty = |usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("probe"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        // The parameters are all zero, because pair arithmetic needs a zero known only at run time.
        let params = filled(&[0; 256], Usage::UNIFORM);
        let input = filled(bytemuck::cast_slice(rows), Usage::STORAGE);
        let output = empty(Usage::STORAGE | Usage::COPY_SRC);
        let staging = empty(Usage::COPY_DST | Usage::MAP_READ);
        let entries = [(0, &params), (9, &input), (10, &output)].map(|(binding, buffer)| {
            wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("probe"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.dispatch_workgroups((rows.len() as u32).div_ceil(64), 1, 1);
        }
        encoder.copy_buffer_to_buffer(&output, 0, &staging, 0, size);
        self.queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..).unwrap()[..])
    }
}
