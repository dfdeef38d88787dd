//! The engine on which a run sweeps, and the decisions at which the engine changes.

use std::cmp::Ordering;

use glam::DVec2;

use crate::cpu::{CpuEngine, mean_excess};
use crate::error::{GpuError, SmoothError};
use crate::layout::Problem;
use crate::mesh::MeshSize;
use crate::outcome::DeviceFault;
use crate::parallel::paced;
use crate::run::opening::{self, DoublePrelude, Obstacle};
use crate::run::{CPU, Checkpoint, CheckpointPolicy, Plan};
use crate::whole::device::Device;

/// Largest sum of q² - ideal² with which a device begins. The limit is far below the largest f32, 3e38, as metrics of
/// size multiply powers of their arguments.
const MAX_SUM_ON_DEVICE: f64 = 1e15;

/// The engine for the next sweeps of a run.
#[derive(Clone)]
pub(crate) enum Place<'s> {
    Device(Device<'s>),
    Cpu(OnCpu),
}

/// The reason why a run sweeps on the CPU.
#[derive(Clone)]
pub(crate) enum OnCpu {
    /// No device was given, the run has no use for a device (no vertex is free, or vertices slide in a projection), or the run
    /// continues from a checkpoint of the CPU.
    Begun,
    /// The device cannot represent the mesh: triangles are too flat or too small, sums too large, a vertex has more maps than
    /// a device stores, or bounds lie in a projection. The run had done `from` sweeps on the device, without opening sweeps.
    Unfit { from: u32 },
    /// The device failed.
    Failed(DeviceFault),
}

impl<'s> Place<'s> {
    /// Returns the place of a run, and of the search runs for its goal, before the mesh is examined: the device, if one is given and `is_useful`, after checks that the mesh fits
    /// the device and that its arithmetic keeps all digits. If the device drops digits, `policy` may let runs begin on the
    /// CPU. A run that continues from a checkpoint of the CPU needs no checks.
    pub(crate) async fn given(
        device: Option<Device<'s>>,
        is_useful: bool,
        size: MeshSize,
        resumed: Option<&Checkpoint>,
        policy: &mut dyn CheckpointPolicy,
    ) -> Result<Self, SmoothError> {
        let Some(device) = device.filter(|_| is_useful) else { return Ok(Self::Cpu(OnCpu::Begun)) };
        if resumed.is_some_and(|checkpoint| checkpoint.saved.engine.engine == CPU) {
            return Ok(Self::Device(device));
        }
        device.check_size(size)?;
        match device.check_arithmetic().await {
            Ok(()) => Ok(Self::Device(device)),
            Err(error) => Self::Device(device).after_failure(error, 0, policy),
        }
    }

    /// Returns the place of a run of `problem` that begins at the positions `from`. `with_maps` is `problem` with the local
    /// maps of the run. Triangles that are too flat for a device are opened by sweeps on the CPU, which are returned if any
    /// were needed.
    pub(crate) async fn at_start(
        self,
        problem: &Problem,
        with_maps: &Problem,
        plan: &Plan,
        from: &[DVec2],
    ) -> Result<(Self, Option<DoublePrelude>), SmoothError> {
        let Self::Device(_) = self else { return Ok((self, None)) };
        let unfit = Self::Cpu(OnCpu::Unfit { from: 0 });
        if with_maps.is_for_cpu_alone() || exceeds_single_precision(problem, plan, from).await {
            return Ok((unfit, None));
        }
        match opening::obstacle(problem, from).await {
            Obstacle::None => return Ok((self, None)),
            Obstacle::Flat => {}
            Obstacle::Small => return Ok((unfit, None)),
        }
        let engine = CpuEngine::new(problem, paced::copied(from).await, None, plan);
        Ok(match opening::open(problem, engine, plan).await? {
            Some(opened) => (self, Some(opened)),
            None => (unfit, None),
        })
    }

    /// Returns the place of a run of `problem` that continues from a checkpoint.
    pub(crate) fn of_checkpoint(self, problem: &Problem, checkpoint: &Checkpoint) -> Self {
        let Checkpoint { about, saved, .. } = checkpoint;
        match self {
            Self::Device(_) if saved.engine.engine == CPU || problem.is_for_cpu_alone() => {
                let unfit = about.on_cpu_from.map(|from| OnCpu::Unfit { from });
                Self::Cpu(unfit.unwrap_or(OnCpu::Begun))
            }
            place => place,
        }
    }

    /// Returns the place after the host has moved vertices to `positions`, at the end of `sweeps` sweeps: a device cannot sweep
    /// triangles that are too flat or too small.
    pub(crate) async fn after_move(
        self,
        problem: &Problem,
        positions: &[DVec2],
        sweeps: u32,
    ) -> Self {
        match self {
            Self::Device(_) if opening::obstacle(problem, positions).await != Obstacle::None => {
                Self::Cpu(OnCpu::Unfit { from: sweeps })
            }
            place => place,
        }
    }

    /// Returns the place after the device has failed. The run would continue from the state after sweep `sweep`. Returns the
    /// error if the run has no device, or if the policy refuses the CPU.
    pub(crate) fn after_failure(
        self,
        error: GpuError,
        sweep: u32,
        policy: &mut dyn CheckpointPolicy,
    ) -> Result<Self, SmoothError> {
        match self {
            Self::Device(_) if policy.falls_back_to_cpu(&error, sweep) => {
                Ok(Self::Cpu(OnCpu::Failed(DeviceFault { sweep, error })))
            }
            _ => Err(error.into()),
        }
    }

    /// Returns the device. `None` for the CPU.
    pub(crate) fn device(&self) -> Option<Device<'s>> {
        match self {
            Self::Device(device) => Some(*device),
            Self::Cpu(_) => None,
        }
    }

    /// Returns the number of sweeps after which the CPU replaced a device that cannot represent the mesh: 0 if the CPU did all
    /// sweeps. `None` without such a change.
    pub(crate) fn unfit_from(&self) -> Option<u32> {
        match self {
            Self::Cpu(OnCpu::Unfit { from }) => Some(*from),
            _ => None,
        }
    }

    /// Returns the fault of the device. `None` if no device failed.
    pub(crate) fn fault(self) -> Option<DeviceFault> {
        match self {
            Self::Cpu(OnCpu::Failed(fault)) => Some(fault),
            _ => None,
        }
    }
}

/// Returns whether sums of some metric exceed the range of single precision, as sizes of triangles differ very much.
async fn exceeds_single_precision(problem: &Problem, plan: &Plan, positions: &[DVec2]) -> bool {
    let mut metrics = plan.tracked();
    metrics.extend(plan.scheme.metrics());
    metrics.retain(|metric| !metric.properties().is_inverse_mean_ratio);
    let count = problem.judged_count() as f64;
    for metric in metrics {
        let sum = mean_excess(metric, problem, positions).await * count;
        // A sum of NaN counts as too large.
        if sum.partial_cmp(&MAX_SUM_ON_DEVICE) != Some(Ordering::Less) {
            return true;
        }
    }
    false
}
