//! The interface between the control of Newton steps and the engine, which takes one step in one call.

/// How an engine takes a Newton step of all vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepRequest {
    /// f before the sweep, relative to which a device judges gains.
    pub(crate) objective: f64,
    /// Share of the model's gain within which conjugate gradients solve for the step.
    pub(crate) forcing: f64,
    /// Gain as a share of f below which conjugate gradients need not go.
    pub(crate) least_gain: f64,
    /// Smallest Ritz value that any solution of the run has shown.
    pub(crate) least_ritz: f64,
    /// Whether negative curvatures count that come from the bend of curves on which vertices slide.
    pub(crate) is_exact: bool,
}

impl StepRequest {
    /// Largest number of iterations. Hard meshes take up to some 150 in their last step.
    pub(crate) const MOST_ITERATIONS: u32 = 1000;
    /// Largest ratio of the accuracy that the model's gain asks for to the least gain, from which conjugate gradients go on to
    /// the least gain at once. Some three further iterations then save another step, which costs as much as ten.
    pub(crate) const NEAR_LEAST: f64 = 20.0;
    /// Smallest Ritz value for the bound of a step that cannot end the run, which need not be safe. On a distorted mesh of 60,000
    /// vertices, 0.1, 0.3 and 1 took 50, 38 and 38 iterations; with 1, an ordinary mesh of 10,000 took a step more.
    pub(crate) const ROUGH_RITZ: f64 = 0.3;

    /// Smallest eigenvalue to expect if every vertex moves, the boundary along closed curves: f hardly depends on a turn of the
    /// whole mesh. With the usual 0.1, ten runs by `imr` on perturbed rings left 2.5 to 8 times the reported gain, with 0.01 two of
    /// four runs left twice, and with 0.001 none of four left more. A device keeps the usual number: in single precision, conjugate
    /// gradients for eigenvalues of a thousandth met rounding as negative curvature.
    const RITZ_OF_TURNS: f64 = 1e-3;

    /// Returns the request for a mesh, given whether every vertex moves.
    pub(crate) fn for_mesh(self, all_move: bool) -> Self {
        let most = if all_move { Self::RITZ_OF_TURNS } else { f64::INFINITY };
        Self { least_ritz: self.least_ritz.min(most), ..self }
    }

    /// Returns how far the model may still fall when conjugate gradients end. `least_gain` is
    /// [`least_gain`](Self::least_gain) in the unit of `model_gain`. If vertices slide, conjugate gradients do not go on to the
    /// least gain early: vertices are released from bounds between steps, and 7 of 150 runs on random meshes left more than
    /// twice the reported gain with early ends, 3 without.
    pub(crate) fn accuracy(&self, model_gain: f64, least_gain: f64, slides: bool) -> f64 {
        match self.forcing * model_gain {
            wanted if slides => wanted.max(least_gain),
            wanted if wanted > Self::NEAR_LEAST * least_gain => wanted,
            _ => least_gain,
        }
    }
}

/// A Newton step of all vertices that an engine has taken after a sweep. Objectives are mean excesses, f - ideal² of the
/// base metric, and gains are in their unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NewtonStep {
    /// Mean excess after the sweep, before the step.
    pub(crate) swept: f64,
    /// Mean excess after the step.
    pub(crate) excess: f64,
    /// Gain of the quadratic model at the whole step.
    pub(crate) model_gain: f64,
    /// Bound of the model's gain beyond the whole step.
    pub(crate) bound: f64,
    /// Smallest Ritz value of the solution; infinite without iterations.
    pub(crate) least_ritz: f64,
    /// Length of the step, 1 for the whole step. 0 if no length lowered f.
    pub(crate) length: f64,
    /// Whether conjugate gradients met negative curvature, and ended there.
    pub(crate) is_curved_down: bool,
    /// Whether a longer step would invert a triangle or break the shape guard.
    pub(crate) is_broken: bool,
    /// Whether the model has the curvatures of all curves.
    pub(crate) is_exact: bool,
    /// Whether vertices slide.
    pub(crate) slides: bool,
    /// Number of sliding vertices that stayed at a bound.
    pub(crate) held: usize,
    /// Number of iterations of conjugate gradients.
    pub(crate) iterations: u32,
}

/// Returns how far a step could lower the objective: the gain of its quadratic model, and the bound of the gain that conjugate
/// gradients have left out. `None` with negative
/// curvature, and without a finite bound.
pub(crate) fn could_gain(model_gain: f64, bound: f64, is_curved_down: bool) -> Option<f64> {
    Some(model_gain + bound).filter(|gain| !is_curved_down && gain.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solution_near_the_least_gain_goes_on_to_it() {
        let request = StepRequest {
            objective: 1.0,
            forcing: 0.1,
            least_gain: 1e-6,
            least_ritz: 0.1,
            is_exact: false,
        };
        assert_eq!(request.accuracy(1.0, 1e-6, false), 0.1);
        assert_eq!(request.accuracy(1e-4, 1e-6, false), 1e-6);
        assert_eq!(request.accuracy(1e-4, 1e-6, true), 1e-5);
    }
}
