//! gpu-smooth in a browser: the functions that the page `index.html` calls.
//!
//! The mesh is made in code. The CPU engine, compiled to WebAssembly, smooths it, and so does the GPU through WebGPU. Then
//! the mesh stays on the device for frames in which a hole can be dragged and vertices thrown about.

mod plate;
mod scene;

use gpu_smooth::{Backend, Gpu, Metric, Options, Outcome, Quality, SmoothError, Smoother, outcome::Objectives};
use wasm_bindgen::prelude::*;

use plate::Plate;
use scene::Scene;

/// A mesh, and the device or the reason why there is none.
#[wasm_bindgen]
pub struct Page {
    plate: Plate,
    gpu: Result<Gpu, String>,
}

/// The result of a run.
#[wasm_bindgen]
pub struct Run {
    /// f by the inverse mean ratio before the run; `after` is f after it.
    pub before: f64,
    pub after: f64,
    pub sweeps: u32,
    /// The number of triangles that are inverted or flat after the run, by exact predicates.
    pub inverted: usize,
    points: Vec<f32>,
}

#[wasm_bindgen]
impl Run {
    /// x and y of all vertices after the run, vertex by vertex.
    pub fn points(&self) -> Vec<f32> {
        self.points.clone()
    }
}

#[wasm_bindgen]
impl Page {
    /// Makes a mesh of about this many vertices, and asks the browser for a device.
    pub async fn open(vertices: usize) -> Page {
        console_error_panic_hook::set_once();
        let gpu = Gpu::open_async(None).await.map_err(|error| error.to_string());
        Page { plate: Plate::new(vertices), gpu }
    }

    /// The name of the adapter, or why there is no device.
    pub fn adapter(&self) -> String {
        match &self.gpu {
            Ok(gpu) => format!("{} ({})", gpu.adapter().name, gpu.adapter().backend),
            Err(error) => error.clone(),
        }
    }

    pub fn has_gpu(&self) -> bool {
        self.gpu.is_ok()
    }

    /// x and y of all vertices as the mesh was made, vertex by vertex.
    pub fn points(&self) -> Vec<f32> {
        single(&self.plate.mesh.points)
    }

    /// The three vertices of each triangle, triangle by triangle.
    pub fn triangles(&self) -> Vec<u32> {
        self.plate.mesh.triangles.as_flattened().to_vec()
    }

    /// Smooths the mesh on the page's only thread, and blocks it meanwhile.
    pub fn run_on_cpu(&self) -> Result<Run, JsError> {
        let smoother = Smoother::new(&self.plate.mesh)?;
        Ok(told(&smoother, smoother.run(&Options::default()).on(&Backend::Cpu).block()?)?)
    }

    /// Smooths the mesh on the device, without blocking the page.
    pub async fn run_on_gpu(&self) -> Result<Run, JsError> {
        let smoother = Smoother::new(&self.plate.mesh)?;
        let outcome = smoother.run(&Options::default()).on(&Backend::Gpu(self.gpu()?.clone())).await?;
        Ok(told(&smoother, outcome)?)
    }

    /// Uploads the mesh as it was made, to be smoothed in frames.
    pub async fn live(&self) -> Result<Live, JsError> {
        let plate = self.plate.clone();
        let scene = Scene::new(self.gpu()?, &plate).await?;
        let [f, worst, inverted] = [f32::NAN, f32::NAN, 0.0];
        Ok(Live { scene, plate, points: Vec::new(), numbers: [f, worst, inverted] })
    }

    fn gpu(&self) -> Result<&Gpu, JsError> {
        self.gpu.as_ref().map_err(|error| JsError::new(error))
    }
}

/// A mesh on the device that is smoothed in frames.
#[wasm_bindgen]
pub struct Live {
    scene: Scene,
    plate: Plate,
    points: Vec<f32>,
    /// f, the worst inverse mean ratio, and the number of inverted triangles.
    numbers: [f32; 3],
}

#[wasm_bindgen]
impl Live {
    /// Takes the results of earlier frames that have arrived. Submits another frame, unless three are under way: with more, the
    /// user would see the effect of a drag later and later.
    pub fn frame(&mut self) -> Result<(), JsError> {
        if let Some((values, points)) = self.scene.seen()? {
            self.numbers = [values.of(Metric::Imr), values.worst_imr, values.inverted as f32];
            self.points.clear();
            self.points.extend(points.as_flattened());
        }
        if self.scene.behind() < 3 {
            self.scene.frame();
        }
        Ok(())
    }

    /// The number of frames submitted, of those that have not arrived, and of the sweeps that the next frame has time for.
    pub fn frames(&self) -> Vec<u32> {
        vec![self.scene.frames(), self.scene.behind(), self.scene.sweeps()]
    }

    /// x and y of all vertices as they arrived last; empty before the first frame has arrived.
    pub fn points(&self) -> Vec<f32> {
        self.points.clone()
    }

    /// f, the worst inverse mean ratio and the number of inverted triangles, as they arrived last.
    pub fn numbers(&self) -> Vec<f32> {
        self.numbers.to_vec()
    }

    /// Drags the hole's center toward x, y, as far as triangles allow. It is at 0, 0 at first.
    pub fn hold(&mut self, x: f32, y: f32) {
        self.scene.hold(Some([x, y]));
    }

    pub fn let_go(&mut self) {
        self.scene.hold(None);
    }

    /// Throws vertices about, which inverts triangles.
    pub fn tear(&mut self) {
        self.scene.tear(&self.plate);
    }
}

fn told(smoother: &Smoother<'_>, outcome: Outcome) -> Result<Run, SmoothError> {
    let f = |at: Option<&Objectives>| at.and_then(|f| f.of(Metric::Imr));
    Ok(Run {
        before: f(outcome.history.first()).unwrap_or(f64::NAN),
        after: smoother.f(Metric::Imr, &outcome.points)?,
        sweeps: outcome.sweeps,
        inverted: Quality::of(&outcome.points, smoother.topology())?.inverted,
        points: single(&outcome.points),
    })
}

fn single(points: &[[f64; 2]]) -> Vec<f32> {
    points.as_flattened().iter().map(|&x| x as f32).collect()
}
