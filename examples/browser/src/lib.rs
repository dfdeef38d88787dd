//! gpu-smooth in a browser: the functions that the page `index.html` calls.
//!
//! The page generates its mesh. The CPU engine, compiled to WebAssembly, smooths the mesh, and so does the GPU through
//! WebGPU. Then the mesh stays on the device for frames, in which the user can drag a hole and scatter vertices.

mod faults;
mod plate;
mod scene;

use gpu_smooth::{Backend, Gpu, Metric, Options, Outcome, Quality, SmoothError, Smoother, outcome::Objectives};
use wasm_bindgen::prelude::*;

use plate::Plate;
use scene::Scene;

/// A mesh, with its device or the reason why no device was opened.
#[wasm_bindgen]
pub struct Page {
    plate: Plate,
    gpu: Result<Gpu, String>,
}

/// The result of a run.
#[wasm_bindgen]
pub struct Run {
    /// f by the inverse mean ratio before the run; `after` is f after the run.
    pub before: f64,
    pub after: f64,
    pub sweeps: u32,
    /// Number of elements after the run that are inverted or flat, or not convex, by exact predicates.
    pub inverted: usize,
    points: Vec<f32>,
}

#[wasm_bindgen]
impl Run {
    /// Returns x and y of all vertices after the run, vertex by vertex.
    pub fn points(&self) -> Vec<f32> {
        self.points.clone()
    }
}

#[wasm_bindgen]
impl Page {
    /// Makes a mesh of approximately `vertices` vertices, and requests a device from the browser.
    pub async fn open(vertices: usize) -> Page {
        console_error_panic_hook::set_once();
        let gpu = Gpu::open(None).await.map_err(|error| error.to_string());
        Page { plate: Plate::new(vertices), gpu }
    }

    /// Returns the name of the adapter, or the reason why no device was opened.
    pub fn adapter(&self) -> String {
        match &self.gpu {
            Ok(gpu) => format!("{} ({})", gpu.adapter().name, gpu.adapter().backend),
            Err(error) => error.clone(),
        }
    }

    pub fn has_gpu(&self) -> bool {
        self.gpu.is_ok()
    }

    /// Returns x and y of all vertices before smoothing, vertex by vertex.
    pub fn points(&self) -> Vec<f32> {
        single(&self.plate.mesh.points)
    }

    /// Returns the vertices of all triangles, three per triangle.
    pub fn triangles(&self) -> Vec<u32> {
        self.plate.mesh.triangles.as_flattened().to_vec()
    }

    /// Returns the vertices of all quadrilaterals, four per quadrilateral.
    pub fn quadrilaterals(&self) -> Vec<u32> {
        self.plate.mesh.quadrilaterals.as_flattened().to_vec()
    }

    /// Smooths the mesh on the page's only thread. The page does not respond during the run.
    pub fn run_on_cpu(&self) -> Result<Run, JsError> {
        let smoother = Smoother::new(&self.plate.mesh)?;
        Ok(told(&smoother, smoother.run(&Options::default()).on(&Backend::Cpu).block()?)?)
    }

    /// Smooths the mesh on the device without blocking the page.
    pub async fn run_on_gpu(&self) -> Result<Run, JsError> {
        let smoother = Smoother::new(&self.plate.mesh)?;
        let outcome = smoother.run(&Options::default()).on(&Backend::Gpu(self.gpu()?.clone())).await?;
        Ok(told(&smoother, outcome)?)
    }

    /// Makes calls that the browser refuses, and returns the error that each caller receives.
    pub async fn faults(&self) -> Result<Vec<String>, JsError> {
        Ok(faults::all(&self.plate.mesh).await?)
    }

    /// Uploads the generated mesh to the device, for smoothing in frames.
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
    /// f, the worst inverse mean ratio, and the number of inverted triangles and of inverted corners of quadrilaterals.
    numbers: [f32; 3],
}

#[wasm_bindgen]
impl Live {
    /// Takes results of earlier frames that have been read back. Submits another frame, unless three frames are under
    /// way: more frames would delay the visible effect of a drag.
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

    /// Returns the number of submitted frames, the number of frames not yet read back, and the number of sweeps for the
    /// next frame.
    pub fn frames(&self) -> Vec<u32> {
        vec![self.scene.frames(), self.scene.behind(), self.scene.sweeps()]
    }

    /// Returns x and y of all vertices from the latest frame read back; empty before the first.
    pub fn points(&self) -> Vec<f32> {
        self.points.clone()
    }

    /// Returns f, the worst inverse mean ratio, and the number of inverted triangles and of inverted corners of quadrilaterals from
    /// the latest frame read back.
    pub fn numbers(&self) -> Vec<f32> {
        self.numbers.to_vec()
    }

    /// Drags the hole's center toward x, y, as far as elements allow. The center starts at 0, 0.
    pub fn hold(&mut self, x: f32, y: f32) {
        self.scene.hold(Some([x, y]));
    }

    pub fn let_go(&mut self) {
        self.scene.hold(None);
    }

    /// Scatters vertices, which inverts elements.
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
