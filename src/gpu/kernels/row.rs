//! The columns of the table of kernels, and the arguments of kernels.

use crate::gpu::kernels::layouts::BindLayout;
use crate::metric::Metric;
use crate::options::Derivatives;
use crate::run::Plan;

/// The columns of the table.
pub(crate) struct Row {
    /// The name of the function in WGSL.
    pub(crate) entry_point: &'static str,
    pub(crate) layout: BindLayout,
    /// Number of invocations in a workgroup.
    pub(crate) width: u32,
    /// Whether the kernel's source differs for meshes with maps at the vertices.
    pub(crate) sees_maps: bool,
    /// Whether the kernel's source differs for meshes whose free vertices are bounded.
    pub(crate) sees_bounds: bool,
    /// Whether the kernel's source differs for meshes with quadrilaterals.
    pub(crate) sees_quadrilaterals: bool,
    pub(crate) user: User,
    /// Sources of the kernel, appended to the files of its layout.
    pub(crate) source: &'static [Source],
}

/// The work that needs a kernel. [`Gpu::prepare`](crate::gpu::Gpu::prepare) compiles the kernels of a user beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum User {
    /// Sweeps, and all other calls that an application's frame may encode, except corrections.
    Sweeps,
    /// Vertices that slide along curves.
    Curves,
    /// Corrections from coarser levels.
    Corrections,
    /// Newton steps of all vertices at the end of a run.
    Steps,
    /// Newton steps with vertices that slide along curves.
    Slides,
    /// The arithmetic check of an adapter, made once.
    Check,
}

/// A part of a kernel's source.
pub(crate) enum Source {
    /// A file of `shaders/`.
    File(&'static str),
    /// The formulas of the kernel's metric.
    ActiveMetric,
    /// The derivatives of the kernel's metric by the invariants of a triangle.
    MetricSlopes,
    /// The objectives of the kernel's metrics.
    TrackedMetrics,
    /// The indices of the kernel's metrics in an evaluation.
    TrackedSlots,
    /// The constants of the energy that untangles.
    UntanglingEnergy,
}

/// Values that a kernel's arguments may take, such as the metrics of sweeps.
pub(super) trait Arguments: Sized {
    /// Lists the values that a run by this plan needs. Without a plan, lists the values that tests try.
    fn list(plan: Option<&Plan>) -> Vec<Self>;
}

impl Arguments for () {
    fn list(_: Option<&Plan>) -> Vec<Self> {
        vec![()]
    }
}

impl Arguments for Metric {
    fn list(plan: Option<&Plan>) -> Vec<Self> {
        plan.map_or(Metric::ALL.to_vec(), |plan| vec![plan.scheme.base()])
    }
}

/// A metric of the invariants of a triangle: every metric but EDGE and ACUTE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct InvariantMetric(pub(crate) Metric);

impl Arguments for InvariantMetric {
    fn list(plan: Option<&Plan>) -> Vec<Self> {
        let metrics = <Metric as Arguments>::list(plan).into_iter();
        metrics.filter(|metric| metric.is_of_invariants()).map(Self).collect()
    }
}

impl Arguments for (Metric, Derivatives) {
    fn list(plan: Option<&Plan>) -> Vec<Self> {
        match plan {
            Some(plan) => {
                let metrics = plan.scheme.metrics().iter();
                metrics.map(|&metric| (metric, plan.derivatives[metric as usize])).collect()
            }
            None => {
                let both = [Derivatives::Analytic, Derivatives::FiniteDifference];
                let of_metric = |&metric| both.map(|derivatives| (metric, derivatives));
                Metric::ALL.iter().flat_map(of_metric).collect()
            }
        }
    }
}

impl Arguments for Vec<Metric> {
    fn list(plan: Option<&Plan>) -> Vec<Self> {
        match plan {
            Some(plan) => vec![plan.tracked()],
            None => Metric::ALL.chunks(1).chain([Metric::ALL]).map(<[_]>::to_vec).collect(),
        }
    }
}

/// Arguments of any kernel, in the form that the composition of its source reads.
pub(crate) struct Composition {
    /// The metrics of the kernel. Empty for kernels without a metric.
    pub(crate) metrics: Vec<Metric>,
    /// Analytic if the kernel has no choice.
    pub(crate) derivatives: Derivatives,
    /// Whether metrics see corners of quadrilaterals, by their weights and slopes.
    pub(crate) has_quadrilaterals: bool,
}

impl From<()> for Composition {
    fn from(_: ()) -> Self {
        Vec::new().into()
    }
}

impl From<Metric> for Composition {
    fn from(metric: Metric) -> Self {
        vec![metric].into()
    }
}

impl From<InvariantMetric> for Composition {
    fn from(metric: InvariantMetric) -> Self {
        metric.0.into()
    }
}

impl From<(Metric, Derivatives)> for Composition {
    fn from(of: (Metric, Derivatives)) -> Self {
        Self { derivatives: of.1, ..vec![of.0].into() }
    }
}

impl From<Vec<Metric>> for Composition {
    fn from(metrics: Vec<Metric>) -> Self {
        Self { metrics, derivatives: Derivatives::Analytic, has_quadrilaterals: false }
    }
}
