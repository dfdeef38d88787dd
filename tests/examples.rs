//! The examples run, and show the results that their comments promise. The code of README.md compiles.

#[allow(dead_code)]
#[path = "../examples/embed/main.rs"]
mod embed;

#[allow(dead_code)]
#[path = "../examples/moving_boundary/main.rs"]
mod moving_boundary;

#[allow(dead_code)]
#[path = "../examples/outside/src/main.rs"]
mod outside;

use std::path::Path;

use gpu_smooth::Metric;

/// The code of README.md and docs/library.md, each part in a function that provides its variables. The code is compiled, and not run.
#[allow(dead_code)]
mod readme {
    use gpu_smooth::untangle::Untangled;
    use gpu_smooth::{BackendReason, Outcome, wgpu};

    use gpu_smooth::gpu::{DeviceMesh, Sweeps, VertexBuffer};
    use gpu_smooth::{Backend, Gpu, Mesh, Options, Smoother, Untangle};

    type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

    fn smooth_a_file() -> Result<()> {
        use std::path::Path;

        use gpu_smooth::{Backend, Options};
        use gpu_smooth_job::Job;
        use mesh_io::MeshFile;

        let file = MeshFile::read(Path::new("in.bdf"))?;
        let smoothed = Job::of_file(&file)?.smooth(&Options::default(), &Backend::Cpu)?;
        smoothed.write(Path::new("out.bdf"))?;

        Ok(())
    }

    fn check(smoothed: Vec<[f64; 2]>, mesh: Mesh) -> Result<(f64, f64)> {
        use gpu_smooth::{Metric, Quality, Topology};

        let quality = Quality::of(&smoothed, &Topology::new(&mesh)?)?;
        assert_eq!(quality.inverted, 0);
        let (f, least_angle) = (quality.f(Metric::Imr), quality.min_angle);

        Ok((f, least_angle))
    }

    fn smooth_slices(points: Vec<[f64; 2]>, triangles: Vec<[u32; 3]>) -> Result<Vec<[f64; 2]>> {
        // 1. One blocking call on plain slices, without further fixed vertices.
        let options = Options::default();
        let points = gpu_smooth::smooth(&points, &triangles, &[], &options, &Backend::Cpu)?;

        Ok(points)
    }

    fn smooth_on_the_fastest_engine(
        mesh: Mesh,
        options: Options,
    ) -> Result<(Outcome, BackendReason)> {
        // Or with an Outcome (points, history, reason of the end), on the engine that is estimated to be done first.
        let (backend, reason) = Backend::auto(mesh.size(), &options);
        let outcome = Smoother::new(&mesh)?.run(&options).on(&backend).block()?;

        Ok((outcome, reason))
    }

    fn untangle(mesh: Mesh) -> Result<(Untangled, Mesh)> {
        // A tangled mesh is made feasible first.
        let untangled = Untangle::new(&mesh).run()?;
        let mesh = Mesh { points: untangled.points.clone(), ..mesh };

        Ok((untangled, mesh))
    }

    async fn await_a_run(
        device: wgpu::Device,
        queue: wgpu::Queue,
        mesh: Mesh,
        options: Options,
    ) -> Result<Outcome> {
        // 2. On your own wgpu device, awaited; your application polls the device as it draws.
        let gpu = Gpu::new(device.clone(), queue.clone())?;
        let outcome = Smoother::new(&mesh)?.run(&options).on(&Backend::Gpu(gpu.clone())).await?;

        Ok(outcome)
    }

    fn encode_sweeps(
        gpu: Gpu,
        mesh: Mesh,
        options: Options,
        vertex_buffer: wgpu::Buffer,
        mut encoder: wgpu::CommandEncoder,
    ) -> Result<()> {
        // 3. Into your own encoder and vertex buffer: nothing is submitted, nothing leaves the GPU.
        let on_device = DeviceMesh::new(&gpu, &mesh)?;
        let vertices = on_device.bind_vertices(&VertexBuffer::new(vertex_buffer.slice(..), 12))?;
        let mut sweeps = Sweeps::new(&on_device, &options).block()?;
        // once, so that the buffer has the positions before the first import
        vertices.encode_export(&mut encoder);
        // and in each frame
        vertices.encode_import(&mut encoder);
        sweeps.encode_sweeps(&mut encoder, 5);
        vertices.encode_export(&mut encoder);

        Ok(())
    }
}

#[test]
fn the_rust_code_of_the_documents_is_compiled() {
    let trimmed = |text: &str| text.lines().map(str::trim).collect::<Vec<_>>().join("\n");
    let source = trimmed(include_str!("examples.rs"));
    for (name, least) in [("README.md", 1), ("docs/library.md", 8)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name);
        let document = trimmed(&std::fs::read_to_string(path).unwrap());
        let blocks = document.split("```rust\n").skip(1);
        let blocks = blocks.map(|rest| rest.split("```").next().unwrap());
        let parts: Vec<&str> = blocks.flat_map(|block| block.trim().split("\n\n")).collect();
        assert!(parts.len() >= least, "{parts:?}");
        for part in parts {
            let is_there = source.contains(part);
            assert!(is_there, "tests/examples.rs must have this code of {name}:\n{part}");
        }
    }
}

/// Returns the perceived brightness of a pixel, from 0 to 255.
fn luminance([red, green, blue, _]: [u8; 4]) -> f64 {
    0.2126 * f64::from(red) + 0.7152 * f64::from(green) + 0.0722 * f64::from(blue)
}

#[test]
fn examples_find_their_mesh_from_any_directory() {
    for path in [Path::new(embed::DEFAULT_MESH), &outside::default_mesh()] {
        assert!(path.is_absolute() && path.is_file(), "{}", path.display());
    }
}

#[test]
fn embed_draws_a_better_mesh_within_the_same_boundary() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../meshes/plate.node");
    let mesh = support::read_mesh(&path);
    let [before, after] = embed::smooth_and_draw(&mesh, 5).unwrap();

    let f = support::f_imr(&mesh);
    let [before_f, after_f] = [&before, &after].map(|frame| frame.quality.of(Metric::Imr));
    assert!((f64::from(before_f) / f - 1.0).abs() < 1e-5, "{before_f} for {f}");
    assert!(after_f < 1.2 && [&before, &after].iter().all(|frame| frame.quality.inverted == 0));
    let worst = support::worst_imr(&mesh);
    assert!((f64::from(before.quality.worst_imr) / worst - 1.0).abs() < 1e-3, "{worst}");
    assert!(after.quality.worst_imr < 5.0);

    // Pixels outside of the plate and in its holes remain white.
    let is_white = |&&pixel: &&[u8; 4]| pixel == [255; 4];
    let white = before.pixels.iter().filter(is_white).count();
    let pairs = || before.pixels.iter().zip(&after.pixels);
    let switched = pairs().filter(|(a, b)| is_white(a) != is_white(b)).count();
    assert!(white > 100_000, "only {white} pixels show no mesh");
    assert!(switched < 50, "{switched} pixels of the background changed");

    // Inside, good triangles have bright colors, bad triangles dark ones.
    let inside: Vec<_> =
        pairs().filter(|(a, b)| !is_white(a) && !is_white(b)).map(|(a, b)| [*a, *b]).collect();
    let mean = |which: usize| {
        inside.iter().map(|pair| luminance(pair[which])).sum::<f64>() / inside.len() as f64
    };
    let dark = |which: usize| inside.iter().filter(|pair| luminance(pair[which]) < 60.0).count();
    assert!(mean(1) > mean(0) + 30.0, "{} after {}", mean(1), mean(0));
    assert!(dark(1) * 5 < dark(0), "{} dark pixels after {}", dark(1), dark(0));
    let changed = pairs().filter(|(a, b)| a != b).count();
    assert!(changed > inside.len() / 2);
}

#[test]
fn an_application_outside_drags_pins_recovers_meshes_anew_and_survives_a_lost_device() {
    let text = "loop\n0 0\n3 0\n3 2\n0 2\ncircle 1.2 1 0.5 24\n";
    let plate = support::triangulate(&support::Outline::parse(text).unwrap(), 400).unwrap();
    let mesh = support::perturb_random(&plate, 0.6, 3);
    let acts = outside::acts(&mesh).unwrap();
    let names: Vec<_> = acts.iter().map(|(name, _)| *name).collect();
    assert_eq!(names.len(), 10, "{names:?}");
    for (name, told) in acts {
        let is_torn = name.contains("torn inside out");
        // The torn mesh is evaluated once before sweeps, so one of its frames has no sweeps.
        let swept = told.frames - u32::from(is_torn);
        assert!(told.frames > 0 && told.sweeps >= swept, "{name}: {told:?}");
        assert_eq!(told.inverted > 0, is_torn, "{name}: {told:?}");
        let (settles, drags) = (name.contains("settle"), name.contains("drag"));
        assert!(told.has_converged || !settles, "{name}: {told:?}");
        let bound = if settles { 3.0 } else { 8.1 };
        assert!(
            told.worst_imr < bound || is_torn && told.worst_imr.is_finite(),
            "{name}: {told:?}"
        );
        assert!(told.least_share == 1.0 || drags, "{name}: {told:?}");
    }
}

#[test]
fn embed_writes_what_it_drew() {
    let mesh = support::lattice(4, 3);
    let [frame, _] = embed::smooth_and_draw(&mesh, 1).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mesh.png");
    frame.write(&path).unwrap();
    let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((info.width, info.height), (960, 640));
    assert!(bytes == frame.pixels.as_flattened());
}

#[test]
fn sweeps_keep_a_mesh_good_whose_boundary_moves() {
    let steps = moving_boundary::simulate(800, 4, 20, 3.0).unwrap();
    assert_eq!(steps.len(), 20);
    assert!(steps.iter().all(|step| step.kept.inverted == 0));
    for step in &steps[5..] {
        let (kept, left) = (step.kept.worst_imr, step.left.worst_imr);
        assert!(kept < left, "{} degrees: {kept} with sweeps, {left} without", step.angle);
    }
    let last = steps.last().unwrap();
    assert!(last.kept.worst_imr < 6.0 && last.left.inverted > 10);
}
