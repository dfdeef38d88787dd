//! Options of the target shapes and sizes of elements.

use clap::Args;
use clap_complete::engine::{ArgValueCandidates, CompletionCandidate};

const HEADING: &str = "Target elements";

/// Options of the target shapes and sizes of elements.
#[derive(Args)]
pub(crate) struct TargetArgs {
    /// Desired shape and size of elements: equilateral, of any size (equilateral); equilateral, of their present sizes
    /// (keep-size); of their present size, stretching and orientation (keep-shape); equilateral, of the sizes in SOURCE
    /// (size=SOURCE); or equilateral under the tensors in SOURCE (metric=SOURCE). SOURCE has a value for each vertex: a
    /// .sol file of Medit, a metric file of BAMG, or the name of point data of IN. SOURCE may also refer to another
    /// mesh: BACKGROUND:DATA, where BACKGROUND is a mesh file and DATA its point data or a .sol or BAMG file, or a view
    /// of gmsh (.pos) of scalars on triangles
    #[arg(long, default_value = "equilateral", value_name = "TARGET", help_heading = HEADING, value_parser = target, add = ArgValueCandidates::new(complete_targets))]
    pub(crate) target: Target,
}

#[derive(Clone, PartialEq, Eq)]
pub(crate) enum Target {
    Equilateral,
    KeepSize,
    KeepShape,
    Size { source: String },
    Metric { source: String },
}

/// Returns the targets for completions, without SOURCE.
fn complete_targets() -> Vec<CompletionCandidate> {
    let targets = ["equilateral", "keep-size", "keep-shape", "size=", "metric="];
    targets.map(CompletionCandidate::new).into()
}

fn target(text: &str) -> Result<Target, String> {
    let source = |source: &str| match source.is_empty() {
        true => Err("the name of a file or of point data is needed after =".to_owned()),
        false => Ok(source.to_owned()),
    };
    match (text, text.split_once('=')) {
        ("equilateral", _) => Ok(Target::Equilateral),
        ("keep-size", _) => Ok(Target::KeepSize),
        ("keep-shape", _) => Ok(Target::KeepShape),
        (_, Some(("size", name))) => Ok(Target::Size { source: source(name)? }),
        (_, Some(("metric", name))) => Ok(Target::Metric { source: source(name)? }),
        _ => Err("give equilateral, keep-size, keep-shape, size=SOURCE or metric=SOURCE".into()),
    }
}
