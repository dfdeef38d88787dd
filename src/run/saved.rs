//! The state of a run between two sweeps, from which the run can continue.

use glam::DVec2;

use crate::layout::Problem;
use crate::run::named::Named;
use crate::run::objectives::Objectives;

/// Name of the CPU engine in [`EngineState::engine`].
pub(crate) const CPU: &str = "cpu";

/// Name of the local maps of the vertices in [`EngineState::own`].
const LOCAL_MAPS: &str = "local maps";
/// Name of the flag for coarser levels in the coordinates of the plane in [`EngineState::own`].
const IN_PLANE: &str = "levels in the plane";

/// The state of a run between two sweeps: log, corrections and engine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Saved {
    /// Tracked objectives before the first sweep and after each sweep.
    pub(crate) log: Vec<Objectives>,
    /// Estimated remaining gain as a share of f. `None` without an estimate.
    pub(crate) remaining: Option<f64>,
    /// State that determines which sweeps, corrections and steps follow, and when the run ends.
    pub(crate) control: Named,
    pub(crate) engine: EngineState,
}

impl Saved {
    /// Returns the number of completed sweeps.
    pub(crate) fn sweeps(&self) -> u32 {
        (self.log.len() as u32).saturating_sub(1)
    }
}

/// The state of the stage of a target field when a period began.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PeriodState {
    /// Number of sweeps before the period.
    pub(crate) began: u32,
    /// Positions before the period, normalized and in the order of the problem.
    pub(crate) before: Vec<DVec2>,
    /// Base objective f before the period.
    pub(crate) f_before: f64,
    /// State of the stage.
    pub(crate) stage: Named,
}

/// The state of an engine between two sweeps.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct EngineState {
    /// Name of the engine: [`CPU`], or the name of the adapter.
    pub(crate) engine: String,
    /// Positions of all vertices, normalized and in the order of the problem.
    pub(crate) positions: Vec<DVec2>,
    /// Positions of the best state. `None` if every sweep lowers f.
    pub(crate) best: Option<Vec<DVec2>>,
    /// Roots from which the coarser levels were built, and then the roots to which the levels were fitted, in order.
    /// Empty without levels, or if the state is not whole.
    pub(crate) roots: Vec<Vec<f32>>,
    /// Data for engines of equal kind, such as secant pairs.
    pub(crate) own: Named,
}

impl EngineState {
    /// Adds the coordinates in which the coarser levels of a problem work, and its local maps if the state is whole.
    pub(crate) fn add_maps(&mut self, problem: &Problem, whole: bool) {
        self.own.add_flag(IN_PLANE, problem.are_levels_in_plane());
        if let (true, true, Some(maps)) = (whole, problem.has_local_maps(), problem.maps()) {
            self.own.add_list(LOCAL_MAPS, maps);
        }
    }

    /// Restores what [`add_maps`](Self::add_maps) added. Returns false, and changes nothing, if the state has no local maps
    /// for this problem, and if its coarser levels work in the coordinates of the maps.
    pub(crate) fn restore_maps(&self, problem: &mut Problem) -> bool {
        let is_in_plane = self.own.flag(IN_PLANE) == Some(true);
        if is_in_plane {
            problem.set_levels_in_plane();
        }
        let maps = self.own.list_of::<[f32; 3]>(LOCAL_MAPS, problem.positions().len());
        let maps = maps.filter(|maps| maps.as_flattened().iter().all(|x| x.is_finite()));
        let maps = maps.filter(|_| problem.has_local_maps());
        maps.map(|maps| problem.set_local_maps(maps)).is_some() || is_in_plane
    }
}
