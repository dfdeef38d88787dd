//! The table of options. An option more is one row here, and the field that the row sets.

use gpu_smooth::Guard;
use gpu_smooth::options::{Derivatives, OptionRange, Paper, WorstBy};
use gpu_smooth::targets::Surface;

use crate::options::row::Belongs::{ToMesh, ToRun};
use crate::options::row::Kind::{
    Count, Flag, Number, NumberOrAuto, Scheme, Seconds, Text, Word, WordOrFlag,
};
use crate::options::row::{OptionRow, row};
use crate::run::{EngineRequest, MethodName};

const METRIC: &str = "Metric and engine";
const STOPPING: &str = "Stopping";
const METHOD: &str = "Method";
const TARGET: &str = "Target elements";
const MOVABLE: &str = "What may move";
const UNTANGLING: &str = "Untangling";
const OUTPUT: &str = "Output";

/// All options that the command line and the Python package share, in the order of help texts.
pub const OPTIONS: &[OptionRow] = &[
    row(
        "scheme",
        ToRun,
        METRIC,
        Scheme(|to, scheme| to.run.scheme = Some(scheme)),
        "The metric to minimize, or several in turn, sweep by sweep until corrections begin, as in edge+imr; the first judges \
         convergence. Metrics: {all metrics}",
    )
    .takes("A[+B...]")
    .usually("imr, tmop-94 for {target=keep-size}, and soft-size for given sizes")
    .and("See `gpu-smooth metrics`", "Several metrics may also be a list. `metrics` describes each"),
    row(
        "engine",
        ToRun,
        METRIC,
        Word(&["auto", "gpu", "cpu"], |to, place| {
            let gpu = EngineRequest::Gpu { adapter: None };
            to.engine = [EngineRequest::Auto, gpu, EngineRequest::Cpu][place].clone();
        }),
        "Where to compute: on a GPU adapter, even if it is software (gpu), on the CPU (cpu), or where the run is estimated \
         to be done first, but not on a software adapter (auto)",
    )
    .takes("ENGINE")
    .default("auto"),
    row(
        "adapter",
        ToRun,
        METRIC,
        Text(|to, name| to.adapter = Some(name)),
        "Take the first GPU adapter with this text in its name",
    )
    .takes("NAME")
    .and("`gpu-smooth adapters` lists them", "`adapters` lists them"),
    row(
        "max-sweeps",
        ToRun,
        STOPPING,
        Count([0, u32::MAX], |to, count| to.run.options.max_sweeps = count),
        "Stop after this many sweeps at the latest",
    )
    .takes("N")
    .default("1000"),
    row(
        "tolerance",
        ToRun,
        STOPPING,
        Number(OptionRange::TOLERANCE, |to, share| to.run.tolerance = Some(share)),
        "Stop when f is estimated to be within this share of its limit; 0 to go on to the last sweep",
    )
    .takes("T")
    .usually("1e-6, 1e-4 by acute, and 1e-3 by acute with {slide}")
    .excludes(&["fraction", "desired"]),
    row(
        "fraction",
        ToRun,
        STOPPING,
        Number(OptionRange::FRACTION, |to, share| to.run.fraction = Some(share)),
        "Stop after this fraction of the reduction from the initial f to the desired f, instead of at the tolerance. Park \
         & Shontz use 0.95",
    )
    .takes("SHARE")
    .usually("0.95 with {desired}"),
    row(
        "desired",
        ToRun,
        STOPPING,
        NumberOrAuto(OptionRange::DESIRED, |to, desired| to.run.desired = Some(desired)),
        "The desired f by the first metric; auto finds the optimum before the run, in tries of up to 5000 sweeps",
    )
    .takes("F|auto")
    .usually("auto with {fraction}"),
    row(
        "time-limit",
        ToRun,
        STOPPING,
        Seconds(|to, limit| to.time_limit = Some(limit)),
        "Stop after this many seconds, with the best mesh so far",
    )
    .takes("SECONDS")
    .and(
        "The time counts from when the mesh begins to be read. A mesh that is still being untangled then is written only \
         with {keep-going}",
        "The time counts from the call, also while the mesh is prepared and untangled; with a `Smoother`, from the call of its \
         `run`. A mesh that is still being untangled then is a `MeshError`",
    ),
    row(
        "checkpoint-every",
        ToRun,
        STOPPING,
        Seconds(|to, every| to.checkpoint_every = Some(every)),
        "The time between two checkpoints. A run that is ended early saves its state too",
    )
    .takes("SECONDS")
    .default("300"),
    row(
        "method",
        ToRun,
        METHOD,
        Word(&["auto", "multilevel", "relaxed", "paper"], |to, place| {
            use MethodName::{Auto, Multilevel, Paper, Relaxed};
            to.run.method = [Auto, Multilevel, Relaxed, Paper][place];
        }),
        "Sweeps with Newton steps of all vertices or corrections from coarser levels of the mesh, by all metrics but \
         {metrics without corrections} (multilevel), over-relaxed sweeps (relaxed), or the plain sweeps of Park & Shontz \
         (paper). auto takes relaxed with {omega}, paper with {inner} or {derivatives}, and otherwise multilevel where the \
         scheme allows corrections",
    )
    .takes("METHOD")
    .default("auto"),
    row(
        "omega",
        ToRun,
        METHOD,
        Number(OptionRange::OMEGA, |to, omega| to.run.omega = Some(omega)),
        "Over-relaxation factor of {method=relaxed}, above 0 and below 2",
    )
    .takes("W")
    .usually("by metric; 1 if metrics alternate"),
    row(
        "inner",
        ToRun,
        METHOD,
        Count([1, Paper::MAX_NEWTON_STEPS], |to, steps| to.run.newton_steps = Some(steps)),
        "Newton steps per visit of a vertex, by {method=paper}",
    )
    .takes("N")
    .default("1"),
    row(
        "derivatives",
        ToRun,
        METHOD,
        Word(&["analytic", "finite-difference"], |to, place| {
            let all = [Derivatives::Analytic, Derivatives::FiniteDifference];
            to.run.derivatives = Some(all[place]);
        }),
        "How {method=paper} differentiates metrics; finite differences only serve to test the paper's cost model",
    )
    .takes("DERIVATIVES")
    .default("analytic"),
    row(
        "edge-norm",
        ToRun,
        METHOD,
        Word(&["fixed", "continued"], |to, place| to.run.doubles_exponent = Some(place == 1)),
        "Exponent of the p-norm that replaces edge in Newton steps: 16 throughout (fixed), or doubled from 2 up to 8192 \
         (continued; 512 without corrections from coarser levels), which reaches a lower f",
    )
    .takes("EDGE_NORM")
    .usually("continued with corrections, fixed without"),
    row(
        "guard",
        ToRun,
        METHOD,
        Word(&["by-metric", "worst"], |to, place| {
            to.run.options.guard = [Guard::ByMetric, Guard::Worst][place];
        }),
        "Bound on the inverse mean ratio of triangles after a step, measured under the {target}: by-metric bounds only \
         metrics without a barrier; worst lets no triangle exceed the initial maximum of the triangles with a free vertex",
    )
    .takes("GUARD")
    .default("by-metric"),
    row(
        "improve-worst",
        ToRun,
        METHOD,
        WordOrFlag(&["imr", "min-angle", "altitude"], |to, place| {
            to.run.options.improve_worst =
                Some([WorstBy::Imr, WorstBy::MinAngle, WorstBy::Altitude][place]);
        }),
        "Improve the worst triangles after the last sweep, at a small cost in f: move the vertices around the worst \
         thousandth of the triangles until the largest imr is as small as it can be made, or the least angle or altitude \
         as large. Least angles grow at the cost of angles above 90 degrees, so min-angle is not for solvers that need \
         orthogonal meshes",
    )
    .takes("MEASURE")
    .and("Without =MEASURE: imr", "True stands for imr"),
    row(
        "target-rings",
        ToMesh,
        TARGET,
        Count([0, 1000], |to, rings| to.target_rings = Some(rings)),
        "Over how many rings of neighbors the sizes and shapes to keep are averaged: more leave less of the mesh's noise",
    )
    .takes("N")
    .usually("1 for keep-shape, 0 for keep-size"),
    row(
        "target-of",
        ToMesh,
        TARGET,
        Word(&["vertex", "place"], |to, place| to.of_places = Some(place == 1)),
        "Owner of targets: vertices, which carry them along, or places, so that targets are evaluated again at the new \
         positions of vertices",
    )
    .takes("WHAT")
    .usually("place for targets on another mesh, else vertex"),
    row(
        "surface",
        ToMesh,
        TARGET,
        Word(&["plane", "sphere"], |to, place| {
            to.surface = [Surface::Plane, Surface::Sphere][place];
        }),
        "Meaning of coordinates: lengths in the plane, or longitude and latitude in degrees on a sphere, continued across \
         the meridian at which longitudes wrap",
    )
    .takes("SURFACE")
    .default("plane"),
    row(
        "z",
        ToMesh,
        TARGET,
        Word(&["coordinate", "data"], |to, place| to.z_is_data = place == 1),
        "Meaning of third coordinates that differ: a coordinate of a mesh that lies in any plane and is smoothed in it, or \
         data of a mesh in x and y, such as depths. A mesh on a curved surface is refused unless z is data",
    )
    .takes("MEANING")
    .default("coordinate")
    .and(
        "Files of SMS 2dm, MIKE, ADCIRC, SCHISM, FVCOM, SELAFIN and UGRID have z as data",
        "Each vertex keeps its z if z is data, as it is on the sphere",
    ),
    row(
        "slide",
        ToMesh,
        MOVABLE,
        Flag(|to| (to.slides, to.run.slides) = (true, true)),
        "Let vertices of the boundary, between regions and on lines slide along them, from corner to corner. Straight lines \
         stay straight; on other lines, vertices follow a cubic through the vertices of {IN}",
    )
    .and("", "Two vertices with equal coordinates, as on both sides of a crack, slide together"),
    row(
        "corner-angle",
        ToMesh,
        MOVABLE,
        Number(OptionRange::CORNER_ANGLE, |to, angle| to.corner_angle = Some(angle)),
        "A vertex where a line turns by more than this angle is a corner, and stays where it is",
    )
    .takes("DEGREES")
    .default("40")
    .needs(&["slide"]),
    row(
        "hausdorff",
        ToMesh,
        MOVABLE,
        Number(OptionRange::HAUSDORFF, |to, distance| to.hausdorff = Some(distance)),
        "Largest distance of lines from the lines of {IN}, in the unit of the mesh",
    )
    .takes("DISTANCE")
    .usually("a tenth of the local edge length")
    .needs(&["slide"]),
    row(
        "free-lines",
        ToMesh,
        MOVABLE,
        Flag(|to| to.frees_lines = true),
        "Let vertices on lines inside of the mesh move, and not slide along these lines: for files that list all edges of the \
         mesh as lines, as some converters write them. Vertices on the boundary, between regions, on points and on elements \
         other than lines stay",
    ),
    row(
        "only-bad",
        ToMesh,
        MOVABLE,
        Number(OptionRange::RATIO, |to, ratio| to.only_bad = Some(ratio)),
        "Let only vertices move that are near a triangle with an inverse mean ratio above this number",
    )
    .takes("Q"),
    row(
        "rings",
        ToMesh,
        MOVABLE,
        Count([0, u32::MAX], |to, rings| to.rings = Some(rings)),
        "Number of rings of triangles, around the bad triangles of {only-bad}, that count as near",
    )
    .takes("N")
    .default("2")
    .needs(&["only-bad"]),
    row(
        "max-move",
        ToRun,
        MOVABLE,
        Number(OptionRange::MAX_MOVE, |to, edges| to.run.options.max_move = Some(edges)),
        "Let no vertex move farther than this many times the mean length of the edges around it before the run",
    )
    .takes("EDGES"),
    row(
        "keep-altitude",
        ToRun,
        MOVABLE,
        Flag(|to| to.run.options.keep_altitude = true),
        "Let no triangle's altitude fall below the least altitude of {IN}, which bounds the time step of explicit solvers",
    ),
    row(
        "untangle",
        ToMesh,
        UNTANGLING,
        Flag(|to| to.untangles = true),
        "Untangle the mesh first if triangles are inverted or flat: move free vertices until no triangle is. Done on the CPU",
    ),
    row(
        "history",
        ToRun,
        OUTPUT,
        Word(&["base", "all"], |to, place| to.run.options.track_all = place == 1),
        "Which f the history of a run has: that of the first metric (base), or those of all metrics (all)",
    )
    .takes("HISTORY")
    .default("base"),
];
