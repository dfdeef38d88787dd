//! The tables of options that contradict each other, by command.

use gpu_smooth::{Metric, OptionError, options::Feature};
use mesh_io::Format;

use gpu_smooth_job::TargetKind;

use crate::args::names;
use crate::args::{
    BenchArgs, CompareArgs, ConvertArgs, DerivativesChoice, EngineChoice, MethodChoice, MoveArgs,
    QualityArgs, ReadArgs, SmoothArgs, SurfaceArg, Target, ZArg,
};
use crate::request::smooth::options;
use crate::request::target::TargetRequest;

/// Two options, or values of options, that do not go together.
pub(super) struct Conflict<A> {
    /// The options as messages name them.
    options: [&'static str; 2],
    /// Whether a command line has both options.
    has_both: fn(&A) -> bool,
    /// Returns the message that refuses both options.
    reason: fn([&str; 2], &A) -> String,
}

const fn row<A>(
    options: [&'static str; 2],
    reason: fn([&str; 2], &A) -> String,
    has_both: fn(&A) -> bool,
) -> Conflict<A> {
    Conflict { options, has_both, reason }
}

/// Returns the message for the first conflict of a table that a command line has.
pub(super) fn first<A>(table: &[Conflict<A>], args: &A) -> Option<String> {
    let found = table.iter().find(|conflict| (conflict.has_both)(args))?;
    Some((found.reason)(found.options, args))
}

/// Conflicts between options of a run, in the order of the search.
pub(super) const OF_RUN: &[Conflict<SmoothArgs>] = &[
    row(["--target", "--scheme"], sizes_unseen, |a| {
        a.target.kind().is_of_sizes() && !a.scheme().metrics().iter().any(sees_sizes)
    }),
    row(["--target metric=VIEW", "a view of gmsh"], sizes_alone, |a| {
        a.target.kind() == TargetKind::Tensors && a.target.has_view()
    }),
    row(["--method multilevel", "--derivatives finite-difference"], of_paper, |a| {
        is_multilevel(a) && has_finite_differences(a)
    }),
    row(["--method multilevel", "--inner"], of_paper, |a| is_multilevel(a) && a.inner != 1),
    row(["--method relaxed", "--derivatives finite-difference"], of_paper, |a| {
        is_relaxed(a) && has_finite_differences(a)
    }),
    row(["--method relaxed", "--inner"], of_paper, |a| is_relaxed(a) && a.inner != 1),
    row(["--omega", "--derivatives finite-difference"], of_paper, |a| {
        a.method == MethodChoice::Auto && a.omega.is_some() && has_finite_differences(a)
    }),
    row(["--omega", "--inner"], of_paper, |a| {
        a.method == MethodChoice::Auto && a.omega.is_some() && a.inner != 1
    }),
    row(["--edge-norm", "edge in --scheme"], without, |a| {
        a.edge_norm.is_some() && !a.scheme().metrics().contains(&Metric::Edge)
    }),
    row(["--target-rings", "--target keep-size or keep-shape"], without, |a| {
        a.target.target_rings.is_some() && !a.target.kind().keeps()
    }),
    row(["--target-of", "another --target"], without, |a| {
        a.target.target_of.is_some() && a.target.target == Target::Equilateral
    }),
    row(["--method paper", "--omega"], idle, |a| {
        a.method == MethodChoice::Paper && a.omega.is_some()
    }),
    row(["--method multilevel", "--omega"], idle, |a| is_multilevel(a) && a.omega.is_some()),
    row(["--engine cpu", "--adapter"], idle, |a| {
        a.engine == EngineChoice::Cpu && a.adapter.is_some()
    }),
    row(REGIONS_OF_FREE, idle, |a| has_free_regions(&a.reading, &a.moving)),
];

/// Conflicts between options of `compare`.
pub(super) const OF_COMPARE: &[Conflict<CompareArgs>] =
    &[row(REGIONS_OF_FREE, idle, |a| has_free_regions(&a.reading, &a.moving))];

/// Regions have no other effect than to fix the vertices between them.
const REGIONS_OF_FREE: [&str; 2] = ["--free-interfaces", "--regions"];

/// Conflicts between options of `quality`.
pub(super) const OF_QUALITY: &[Conflict<QualityArgs>] = &[
    row(["--picture", "several meshes"], one_mesh, |a| {
        a.picture.picture.is_some() && a.meshes.len() > 1
    }),
    row(["--picture-arrows", "no run"], no_arrows, |a| a.picture.picture_arrows),
];

/// Conflicts between options of `bench`.
pub(super) const OF_BENCH: &[Conflict<BenchArgs>] = &[
    row(["--engine cpu", "--adapter"], idle, |a| {
        a.engine == EngineChoice::Cpu && a.adapter.is_some()
    }),
    row(["--surface sphere", "a MESH"], without, |a| {
        a.surface.surface == SurfaceArg::Sphere && a.mesh.is_none()
    }),
    row(["--z data", "a MESH"], without, |a| a.surface.z == ZArg::Data && a.mesh.is_none()),
];

/// Conflicts between options of `convert`.
pub(super) const OF_CONVERT: &[Conflict<ConvertArgs>] =
    &[row(["--to triangle", "-"], several_files, |a| {
        a.to == Some(Format::Triangle) && a.output.as_os_str() == "-"
    })];

/// Returns the message for the first conflict in the library's table; `None` if the options of a run are valid.
pub(super) fn of_library(args: &SmoothArgs) -> Option<String> {
    let targets = args.target.target != Target::Equilateral
        || args.target.surface.surface == SurfaceArg::Sphere;
    let more = Feature::present([
        (Feature::Slide, args.sliding.slide),
        (Feature::Targets, targets),
        (Feature::TargetField, TargetRequest::from(&args.target).is_of_places()),
        (Feature::Untangle, args.untangle),
    ]);
    match options(args).check_with(&more) {
        Err(OptionError::Conflict { features, why }) => {
            let [a, b] = features.map(|feature| flag(feature, args));
            let remedy = match features {
                _ if features.contains(&Feature::TargetField) => " (--target-of vertex)",
                _ => "",
            };
            Some(format!("{a} does not go with {b}: {why}{remedy}"))
        }
        // Other errors concern ranges, which parsers have checked.
        Err(error) => Some(error.to_string()),
        Ok(()) => None,
    }
}

/// Returns the option of a command line by which a run has a feature.
fn flag(feature: Feature, args: &SmoothArgs) -> String {
    match feature {
        Feature::UnevenScheme | Feature::UncorrectedScheme => format!("--scheme {}", args.scheme()),
        Feature::Multilevel => "--method multilevel".into(),
        Feature::FiniteDifferences => "--derivatives finite-difference".into(),
        Feature::Goal if args.desired.is_none() => "--fraction".into(),
        Feature::Goal => "--desired".into(),
        Feature::WorstGuard => "--guard worst".into(),
        Feature::MaxMove => "--max-move".into(),
        Feature::KeepAltitude => "--keep-altitude".into(),
        Feature::ImproveWorst => "--improve-worst".into(),
        Feature::Slide => "--slide".into(),
        Feature::Targets if args.target.target == Target::Equilateral => "--surface sphere".into(),
        Feature::Targets => "--target".into(),
        Feature::TargetField => "--target-of place".into(),
        Feature::Untangle => "--untangle".into(),
        other => other.to_string(),
    }
}

fn idle<A>([a, b]: [&str; 2], _: &A) -> String {
    format!("{b} has no effect with {a}: drop one of them")
}

fn of_paper<A>([a, b]: [&str; 2], _: &A) -> String {
    format!("{a} does not go with {b}, a setting of --method paper: drop one of them")
}

fn without<A>([option, wanted]: [&str; 2], _: &A) -> String {
    format!("{option} has no effect without {wanted}: drop it")
}

fn sizes_unseen(_: [&str; 2], args: &SmoothArgs) -> String {
    let (scheme, target) = (args.scheme(), TargetRequest::from(&args.target).name());
    let others =
        names::either(&names::metrics(|metric| sees_sizes(&metric) && metric.has_barrier()));
    format!(
        "--target {target} has no effect on {scheme}, which sees no sizes: leave --scheme out, or take {others}"
    )
}

fn sizes_alone(_: [&str; 2], args: &SmoothArgs) -> String {
    let source = args.target.source().unwrap_or_default();
    format!(
        "the background of --target: {source}: a view of gmsh holds sizes, not tensors: give size={source}"
    )
}

fn one_mesh(_: [&str; 2], args: &QualityArgs) -> String {
    let picture = args.picture.picture.as_deref().unwrap_or("".as_ref());
    format!("{}: --picture draws a single mesh: give only one", picture.display())
}

fn no_arrows<A>([arrows, _]: [&str; 2], _: &A) -> String {
    format!("{arrows} needs a run, as arrows go from the old place of a vertex to the new one")
}

fn several_files<A>(_: [&str; 2], _: &A) -> String {
    "a Triangle mesh has several files and cannot go to standard output: name OUT".to_owned()
}

fn has_free_regions(reading: &ReadArgs, moving: &MoveArgs) -> bool {
    reading.regions.is_some() && moving.free_interfaces
}

fn has_finite_differences(args: &SmoothArgs) -> bool {
    args.derivatives == DerivativesChoice::FiniteDifference
}

fn is_multilevel(args: &SmoothArgs) -> bool {
    args.method == MethodChoice::Multilevel
}

fn is_relaxed(args: &SmoothArgs) -> bool {
    args.method == MethodChoice::Relaxed
}

fn sees_sizes(metric: &Metric) -> bool {
    !metric.is_scale_invariant()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Cli, Command};
    use crate::request::command_line::checked;
    use clap::Parser;

    /// Returns the words of a command line that give both options of a table's row.
    fn words(options: [&str; 2], view: &str) -> Vec<String> {
        let of = |option: &str| match (option, options) {
            ("--target metric=VIEW", _) => format!("--target metric={view}"),
            ("--target", _) => "--target keep-size".to_owned(),
            ("--scheme", _) => "--scheme imr".to_owned(),
            ("--edge-norm", _) => "--edge-norm fixed".to_owned(),
            ("--target-of", _) => "--target-of vertex".to_owned(),
            ("--target-rings" | "--inner", _) => format!("{option} 3"),
            ("--omega", _) => format!("{option} 0.5"),
            ("--adapter" | "--regions", _) => format!("{option} name"),
            ("--picture", _) => "--picture p.png".to_owned(),
            ("--picture-arrows", _) => "--picture p.png --picture-arrows".to_owned(),
            ("several meshes", _) => "another".to_owned(),
            // The other side of the pair has no words.
            (
                "a view of gmsh" | "no run" | "edge in --scheme" | "another --target" | "a MESH",
                _,
            )
            | ("--target keep-size or keep-shape" | "--target keep-shape", _) => String::new(),
            (option, _) => option.to_owned(),
        };
        options.map(of).join(" ").split_whitespace().map(str::to_owned).collect()
    }

    /// Checks for each row that a command line with its options meets no earlier row, and is refused with the row's
    /// message.
    fn check<A>(table: &[Conflict<A>], command: &[&str], args_of: fn(&Cli) -> &A) {
        let folder = tempfile::tempdir().unwrap();
        let view = folder.path().join("view.pos");
        std::fs::write(&view, "View").unwrap();
        for (i, row) in table.iter().enumerate() {
            let words = words(row.options, view.to_str().unwrap());
            let line = command.iter().map(|word| (*word).to_owned()).chain(words);
            let line: Vec<String> = line.collect();
            let cli =
                Cli::try_parse_from(&line).unwrap_or_else(|error| panic!("{line:?}: {error}"));
            let args = args_of(&cli);
            let met = table.iter().position(|row| (row.has_both)(args));
            assert_eq!(met, Some(i), "{line:?} meets another row of the table");
            let reason = (row.reason)(row.options, args);
            let error = checked(line.iter().map(Into::into)).err().map(|error| error.to_string());
            assert!(error.is_some_and(|error| error.contains(&reason)), "{line:?}: {reason}");
        }
    }

    #[test]
    fn each_pair_of_a_run_is_refused_by_its_own_words() {
        check(OF_RUN, &["gpu-smooth", "in", "out"], |cli| &cli.smooth);
    }

    /// Errors would name a feature in the library's terms if `flag` returned no option for the feature.
    #[test]
    fn each_feature_of_a_run_has_an_option() {
        let cli = Cli::try_parse_from(["gpu-smooth", "in", "out"]).unwrap();
        for feature in Feature::ALL {
            let is_encoded = matches!(feature, Feature::Encoded | Feature::EncodedCorrections);
            let option = flag(feature, &cli.smooth);
            assert!(is_encoded || option.starts_with("--"), "add an arm to `flag`: {option}");
        }
    }

    #[test]
    fn each_pair_of_another_command_is_refused_by_its_own_words() {
        check(OF_QUALITY, &["gpu-smooth", "quality", "in"], |cli| match &cli.command {
            Some(Command::Quality(args)) => args,
            _ => panic!("another command"),
        });
        check(OF_COMPARE, &["gpu-smooth", "compare", "in", "out"], |cli| match &cli.command {
            Some(Command::Compare(args)) => args,
            _ => panic!("another command"),
        });
        check(OF_BENCH, &["gpu-smooth", "bench"], |cli| match &cli.command {
            Some(Command::Bench(args)) => args,
            _ => panic!("another command"),
        });
        check(OF_CONVERT, &["gpu-smooth", "convert", "in"], |cli| match &cli.command {
            Some(Command::Convert(args)) => args,
            _ => panic!("another command"),
        });
    }
}
