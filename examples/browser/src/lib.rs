//! gpu-smooth in a browser: what the page in `index.html` calls.
//!
//! A mesh made in code is smoothed by the CPU engine, compiled to WebAssembly, and by the GPU through WebGPU. Then it lives on the
//! device, frame after frame: a hole can be dragged, and vertices thrown about.

mod plate;
mod scene;

use gpu_smooth::{Backend, Gpu, Metric, Objectives, Options, Outcome, SmoothError, Smoother};
use wasm_bindgen::prelude::*;

use plate::Plate;
use scene::Scene;

/// A mesh, and the device if there is one.
#[wasm_bindgen]
pub struct Page {
    plate: Plate,
    gpu: Result<Gpu, String>,
}

/// How a run went.
#[wasm_bindgen]
pub struct Run {
    /// f by the inverse mean ratio before and after.
    pub before: f64,
    pub after: f64,
    pub sweeps: u32,
    /// How many triangles are inverted or flat after it, by exact predicates.
    pub inverted: usize,
    points: Vec<f32>,
}

#[wasm_bindgen]
impl Run {
    /// x and y of all vertices after the run.
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

    /// What computes, or why nothing does.
    pub fn adapter(&self) -> String {
        match &self.gpu {
            Ok(gpu) => format!("{} ({})", gpu.adapter().name, gpu.adapter().backend),
            Err(error) => error.clone(),
        }
    }

    pub fn has_gpu(&self) -> bool {
        self.gpu.is_ok()
    }

    /// x and y of all vertices of the mesh as it was made.
    pub fn points(&self) -> Vec<f32> {
        single(&self.plate.mesh.points)
    }

    /// The three vertices of all triangles.
    pub fn triangles(&self) -> Vec<u32> {
        self.plate.mesh.triangles.as_flattened().to_vec()
    }

    /// Smooths the mesh on the one thread of the page, which is blocked meanwhile.
    pub fn run_on_cpu(&self) -> Result<Run, JsError> {
        let smoother = Smoother::new(&self.plate.mesh)?;
        Ok(told(&smoother, smoother.run(&Options::default(), &Backend::Cpu)?)?)
    }

    /// Smooths the mesh on the device; the page goes on.
    pub async fn run_on_gpu(&self) -> Result<Run, JsError> {
        let smoother = Smoother::new(&self.plate.mesh)?;
        let outcome = smoother.run_async(&Options::default(), self.gpu()?).await?;
        Ok(told(&smoother, outcome)?)
    }

    /// Takes the mesh as it was made to the device, to live there.
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

/// The mesh on the device.
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
    /// Takes what has arrived of the frames before, and does another one unless the device is behind: what the user does would show
    /// later and later.
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

    /// How many frames were submitted, how many of them have not arrived, and how many sweeps the next one has time for.
    pub fn frames(&self) -> Vec<u32> {
        vec![self.scene.frames(), self.scene.behind(), self.scene.sweeps()]
    }

    /// x and y of all vertices as they arrived last; none before the first frame has.
    pub fn points(&self) -> Vec<f32> {
        self.points.clone()
    }

    /// f, the worst inverse mean ratio and the number of inverted triangles, as they arrived last.
    pub fn numbers(&self) -> Vec<f32> {
        self.numbers.to_vec()
    }

    /// Takes the hole to x, y, as far as triangles allow; it was at 0, 0.
    pub fn hold(&mut self, x: f32, y: f32) {
        self.scene.hold(Some([x, y]));
    }

    pub fn let_go(&mut self) {
        self.scene.hold(None);
    }

    /// Throws vertices about, so that triangles are inverted.
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
        inverted: smoother.quality(&outcome.points)?.inverted,
        points: single(&outcome.points),
    })
}

fn single(points: &[[f64; 2]]) -> Vec<f32> {
    points.as_flattened().iter().map(|&x| x as f32).collect()
}
