//! Devices with low limits, and meshes too large for a device.

use gpu_smooth::{
    Backend, Gpu, GpuError, Mesh, MeshSize, Options, Smoother,
    gpu::{DeviceMesh, Sweeps, VertexBuffer},
    wgpu,
};
use wgpu::Limits;

use crate::app::{App, Vertices, adapter, bad_plate, gpu_error, least_limits};
use support::{f_imr, lattice};

#[track_caller]
fn assert_limit(error: &GpuError, name: &str, available: u64, text: &str) {
    match error {
        GpuError::Limit { limit, available: found, needed, .. } => {
            assert_eq!((*limit, *found), (name, available));
            assert!(needed > found);
        }
        _ => panic!("{error:?}"),
    }
    assert_eq!(error.to_string(), text);
}

const SIZE: MeshSize = MeshSize { vertices: 1000, triangles: 1900 };

#[test]
fn required_limits_name_the_limit_that_is_too_low() {
    let low = Limits { max_storage_buffer_binding_size: 7_900, ..Limits::default() };
    assert_limit(
        &Gpu::required_limits(Limits::default(), SIZE, &low).unwrap_err(),
        "max_storage_buffer_binding_size",
        7_900,
        // Positions may be bound in two halves, so a binding needs half of their bytes.
        "the buffer of vertex positions (1000 vertices) needs 8000, \
         but the device's max_storage_buffer_binding_size is 7900",
    );
    let low = Limits { max_buffer_size: 15_999, ..Limits::default() };
    assert_limit(
        &Gpu::required_limits(Limits::default(), SIZE, &low).unwrap_err(),
        "max_buffer_size",
        15_999,
        "the buffer of vertex positions (1000 vertices) needs 16000, \
         but the device's max_buffer_size is 15999",
    );
    let low = Limits { max_storage_buffers_per_shader_stage: 4, ..Limits::default() };
    assert_limit(
        &Gpu::required_limits(Limits::default(), SIZE, &low).unwrap_err(),
        "max_storage_buffers_per_shader_stage",
        4,
        "the storage buffers of a kernel needs 7, \
         but the device's max_storage_buffers_per_shader_stage is 4",
    );
}

#[test]
fn limits_that_the_application_needs_itself_are_kept() {
    let most = Limits { max_bind_groups: 8, max_buffer_size: 1 << 40, ..adapter().limits() };
    let own = Limits {
        max_bind_groups: 8,
        max_buffer_size: 1 << 40,
        max_compute_workgroup_size_x: 16,
        max_texture_dimension_2d: 123,
        ..Limits::default()
    };
    let limits = Gpu::required_limits(own.clone(), SIZE, &most).unwrap();
    assert_eq!(limits, Limits { max_compute_workgroup_size_x: 256, ..own });
}

#[test]
fn required_limits_are_raised_as_far_as_a_large_mesh_needs() {
    let size = MeshSize { vertices: 50_000_000, triangles: 100_000_000 };
    let most = Limits {
        max_buffer_size: 1 << 31,
        max_storage_buffer_binding_size: 1_200_000_000,
        ..Limits::default()
    };
    let limits = Gpu::required_limits(Limits::default(), size, &most).unwrap();
    assert_eq!(limits.max_storage_buffer_binding_size, 1_200_000_000);
    // A move of all vertices has 24 bytes for each triangle, more than a buffer of this device.
    assert_eq!(limits.max_buffer_size, 2_147_483_648);
    // If a limit is below the size of a buffer, the buffer is bound in parts. Positions in two bindings
    // need an eighth binding.
    for (bound, bindings) in [(1_199_999_999, 7), (800_000_000, 7), (799_999_999, 8)] {
        let less = Limits { max_storage_buffer_binding_size: bound, ..most.clone() };
        let own = Limits { max_storage_buffers_per_shader_stage: 0, ..Limits::default() };
        let limits = Gpu::required_limits(own, size, &less).unwrap();
        assert_eq!(limits.max_storage_buffer_binding_size, bound);
        assert_eq!(limits.max_storage_buffers_per_shader_stage, bindings);
    }
    let less = Limits { max_storage_buffer_binding_size: 399_999_999, ..most };
    assert!(Gpu::required_limits(Limits::default(), size, &less).is_err());
}

#[test]
fn required_limits_and_features_are_what_this_adapter_has() {
    let adapter = adapter();
    let limits = least_limits(SIZE);
    assert!(limits.check_limits(&adapter.limits()));
    assert!(adapter.features().contains(Gpu::required_features()));
    assert!(Gpu::required_features().is_empty());
}

#[test]
fn a_device_with_exactly_the_required_limits_smooths() {
    let mesh = bad_plate(1000);
    let size = mesh.size();
    let app = App::with_limits(least_limits(size)).unwrap();
    let device_mesh = app.mesh(&mesh);
    let options = Options::default().track_all(true);
    let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
    let vertices = Vertices::new(&app, &mesh, 0, 8);
    app.submit(|encoder| {
        sweeps.encode_sweeps(encoder, 10);
        vertices.bind(&device_mesh).encode_export(encoder);
    });
    let points = app.points(&device_mesh);
    assert!(f_imr(&Mesh { points, ..mesh.clone() }) < f_imr(&mesh));
}

#[test]
fn a_device_with_exactly_the_required_limits_moves_all_vertices() {
    let mesh = bad_plate(3000);
    let size = mesh.size();
    let app = App::with_limits(least_limits(size)).unwrap();
    let device_mesh = app.mesh(&mesh);
    let all: Vec<u32> = (0..size.vertices as u32).collect();
    let [targets, share] =
        [8 * size.vertices as u64, 4].map(|bytes| app.buffer(bytes, wgpu::BufferUsages::STORAGE));
    device_mesh
        .bind_move(&all, &VertexBuffer::new(targets.slice(..), 8), 8.0, share.slice(..))
        .unwrap();
}

#[test]
fn a_device_with_exactly_the_limits_of_a_vertex_buffer_binds_it() {
    let mesh = bad_plate(300);
    let size = mesh.size();
    for (offset, stride) in [(0, 192), (4, 192), (1020, 196), (1 << 16, 256)] {
        let needed = VertexBuffer::binding_size(size.vertices, stride, offset);
        let own = Limits {
            max_storage_buffer_binding_size: needed,
            ..Limits::downlevel_webgl2_defaults()
        };
        let limits = Gpu::required_limits(own, size, &adapter().limits()).unwrap();
        assert_eq!(limits.max_storage_buffer_binding_size, needed);
        let app = App::with_limits(limits).unwrap();
        let vertices = Vertices::new(&app, &mesh, offset, stride);
        vertices.bind(&app.mesh(&mesh));
    }
    assert_eq!(VertexBuffer::binding_size(usize::MAX, u64::MAX, 0), u64::MAX);
    assert_eq!(VertexBuffer::binding_size(0, 8, 0), 8);
}

/// Makes a device that binds at most 32 KiB at once.
fn small() -> App {
    let limits = least_limits(SIZE);
    App::with_limits(Limits { max_storage_buffer_binding_size: 32 << 10, ..limits }).unwrap()
}

#[test]
fn a_mesh_too_large_for_the_device_is_refused() {
    let app = small();
    let mesh = lattice(70, 70);
    let text = "the buffer of vertex positions (5041 vertices) needs 40328, \
                but the device's max_storage_buffer_binding_size is 32768";
    let name = "max_storage_buffer_binding_size";
    let error = DeviceMesh::new(&app.gpu, &mesh).err().unwrap();
    assert_limit(&gpu_error(error), name, 32 << 10, text);
    let backend = Backend::Gpu(app.another_gpu());
    let smoother = Smoother::new(&mesh).unwrap();
    let run = smoother.run(&Options::default()).on(&backend).block();
    assert_limit(&gpu_error(run.unwrap_err()), name, 32 << 10, text);

    // After the refusal, a smaller mesh is accepted.
    let mesh = bad_plate(600);
    let device_mesh = app.mesh(&mesh);
    let mut sweeps = Sweeps::new(&device_mesh, &Options::default()).block().unwrap();
    app.submit(|encoder| sweeps.encode_sweeps(encoder, 5));
    let points = app.points(&device_mesh);
    assert!(f_imr(&Mesh { points, ..mesh.clone() }) < f_imr(&mesh));
}

#[test]
fn a_vertex_buffer_too_large_to_bind_is_refused() {
    let app = small();
    let mesh = bad_plate(600);
    let device_mesh = app.mesh(&mesh);
    let bytes = 64 * mesh.points.len() as u64;
    let buffer = app.buffer(bytes, wgpu::BufferUsages::STORAGE);
    let place = VertexBuffer::new(buffer.slice(..), 64);
    let error = device_mesh.bind_vertices(&place).err().unwrap();
    let needed = VertexBuffer::binding_size(mesh.points.len(), 64, 0);
    assert_eq!(needed, bytes - 56);
    assert_limit(
        &error,
        "max_storage_buffer_binding_size",
        32 << 10,
        &format!(
            "the application's buffer needs {needed}, \
             but the device's max_storage_buffer_binding_size is 32768"
        ),
    );
}

#[test]
fn a_device_that_binds_too_few_buffers_is_refused() {
    let error = App::with_limits(Limits::downlevel_defaults()).err().unwrap();
    assert_limit(
        &error,
        "max_storage_buffers_per_shader_stage",
        4,
        "the storage buffers of a kernel needs 7, \
         but the device's max_storage_buffers_per_shader_stage is 4",
    );
}

#[test]
fn a_device_with_small_workgroups_is_refused() {
    let limits = least_limits(SIZE);
    let limits = Limits {
        max_compute_invocations_per_workgroup: 128,
        max_compute_workgroup_size_x: 128,
        ..limits
    };
    let result = App::with_limits(limits).and_then(|app| {
        let device_mesh = app.mesh(&bad_plate(300));
        Sweeps::new(&device_mesh, &Options::default()).block().map_err(gpu_error).map(drop)
    });
    let text = result.unwrap_err().to_string();
    assert!(text.contains("128") && text.contains("256"), "{text}");
}
