//! The list of the kernels that are compiled before the first sweep of a run.

use crate::gpu::device::size::{objective_invocations, span_count};
use crate::gpu::kernels::form::MeshForm;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::mesh::MeshBuffers;
use crate::gpu::run::{levels, truncated};
use crate::layout::Problem;
use crate::run::{Ending, Plan, SweepParams, Work};

/// Lists the kernels of the given work in a run by a plan, each once, in the order of their first dispatches. A run with
/// accelerated corrections compiles further kernels later.
pub(super) fn kernels(
    plan: &Plan,
    work: &Work,
    problem: &Problem,
    mesh: &MeshBuffers,
) -> Vec<(Kernel, MeshForm)> {
    let form = mesh.parts.form();
    let slides = mesh.curves.is_some();
    let mut kernels = Vec::new();
    let mut add = |kernel: Kernel| {
        // A kernel that goes over elements is compiled for the triangles and for the quadrilaterals of the mesh.
        let goes_over_elements =
            matches!(kernel, Kernel::Objective(_) | Kernel::ObjectiveAlongCorrection(_));
        let forms: Vec<MeshForm> = match goes_over_elements {
            true => mesh.parts.elements.iter().map(|part| part.form(form)).collect(),
            false => vec![form],
        };
        for form in forms {
            let listed = (kernel.clone(), form);
            if !kernels.contains(&listed) {
                kernels.push(listed);
            }
        }
    };
    for &SweepParams { metric, derivatives, .. } in &work.steps {
        add(Kernel::Sweep(metric, derivatives));
        if slides {
            add(Kernel::Slide(metric));
        }
    }
    add(Kernel::Objective(plan.tracked()));
    if span_count(objective_invocations(problem.judged_count())) > 0 {
        add(Kernel::AddUpEvaluation(plan.tracked()));
    }
    add(Kernel::Finish(plan.tracked()));
    let takes_steps = truncated::serves(problem, mesh);
    let corrects = match work.ending {
        Ending::Sweeps => false,
        Ending::Corrections => true,
        Ending::Steps => !takes_steps,
    };
    if corrects {
        add(Kernel::Stiffness(plan.scheme.base()));
        levels::kernels(plan, problem).into_iter().for_each(&mut add);
    }
    if takes_steps && (work.ending == Ending::Steps || work.is_measured) {
        truncated::kernels(plan, problem, slides).into_iter().for_each(&mut add);
    }
    kernels
}
