//! Encoding into compute passes of the application.

use gpu_smooth::{
    Options,
    gpu::{ObjectiveValues, Sweeps, UntanglingSweeps, VertexBuffer},
    wgpu,
};
use wgpu::BufferUsages as Usage;

use crate::app::{App, Vertices, bad_plate, interior};

/// Makes an application's kernel that doubles each word of a buffer.
fn doubling(app: &App, buffer: &wgpu::Buffer) -> (wgpu::ComputePipeline, wgpu::BindGroup) {
    let wgsl = "@group(0) @binding(0) var<storage, read_write> words: array<f32>;
        @compute @workgroup_size(64) fn double(@builtin(global_invocation_id) id: vec3<u32>) {
            if id.x < arrayLength(&words) { words[id.x] *= 2.0; }
        }";
    let device = app.device();
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(wgsl.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("double"),
        compilation_options: Default::default(),
        cache: None,
    });
    let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
    });
    (pipeline, bound)
}

#[test]
fn a_pass_of_the_application_takes_all_that_an_encoder_takes() {
    let mesh = bad_plate(300);
    let v = interior(&mesh)[30];
    let mut results = Vec::new();
    for in_a_pass in [false, true] {
        let app = App::new();
        let device_mesh = app.mesh(&mesh);
        let mut sweeps =
            Sweeps::until_converged(&device_mesh, &Options::default()).block().unwrap();
        let vertices = Vertices::usual(&app, &mesh);
        let bound = vertices.bind(&device_mesh);
        let numbers = app.buffer(128, Usage::STORAGE | Usage::COPY_SRC);
        let objective = sweeps.bind_objective(numbers.slice(..)).unwrap();
        let [x, y] = mesh.points[v as usize].map(|x| 0.5 * x as f32);
        let targets = app.buffer(8, Usage::STORAGE | Usage::COPY_DST);
        app.gpu.queue().write_buffer(&targets, 0, bytemuck::cast_slice(&[x + 1e-3, y]));
        let place = VertexBuffer::new(targets.slice(..), 8);
        let drag = device_mesh.bind_move(&[v], &place, 8.0, numbers.slice(124..)).unwrap();
        let mask = app.buffer(4 * mesh.points.len() as u64, Usage::STORAGE);
        let mask = device_mesh.bind_mask(mask.slice(..)).unwrap();
        let untangling = UntanglingSweeps::new(&device_mesh).unwrap();
        // Kernels of the application: one doubles the targets in advance, the other the exported vertices
        // afterwards.
        let before = doubling(&app, &targets);
        let after = doubling(&app, &vertices.buffer);
        let own = |pass: &mut wgpu::ComputePass<'_>, (pipeline, bound): &(_, _), groups| {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bound, &[]);
            pass.dispatch_workgroups(groups, 1, 1);
        };
        let groups = mesh.points.len() as u32;
        app.submit(|encoder| {
            if in_a_pass {
                let mut pass = encoder.begin_compute_pass(&Default::default());
                own(&mut pass, &before, 1);
                bound.encode_import(&mut pass);
                mask.encode_mask(&mut pass);
                drag.encode_move(&mut pass);
                untangling.encode_untangle(&mut pass, 2);
                sweeps.encode_sweeps(&mut pass, 3);
                objective.encode_objective(&mut pass);
                bound.encode_export(&mut pass);
                own(&mut pass, &after, groups);
            } else {
                own(&mut encoder.begin_compute_pass(&Default::default()), &before, 1);
                bound.encode_import(encoder);
                mask.encode_mask(encoder);
                drag.encode_move(encoder);
                untangling.encode_untangle(encoder, 2);
                sweeps.encode_sweeps(encoder, 3);
                objective.encode_objective(encoder);
                bound.encode_export(encoder);
                own(&mut encoder.begin_compute_pass(&Default::default()), &after, groups);
            }
        });
        let words = app.read(&numbers);
        let at = std::mem::offset_of!(ObjectiveValues, sweeps) / 4;
        assert_eq!((words[at], words[31]), (3, 1.0f32.to_bits()), "three sweeps, and all the way");
        let exported = app.read(&vertices.buffer);
        let at = vertices.word(v);
        let [x, _] = app.points(&device_mesh)[v as usize];
        assert_eq!(f32::from_bits(exported[at]), 2.0 * x as f32);
        results.push((words, exported, app.points(&device_mesh)));
    }
    assert!(results[0] == results[1]);
}
