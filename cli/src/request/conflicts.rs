//! The tables of options that contradict each other, by command.

use gpu_smooth::{Desired, Metric, Scheme};
use mesh_io::Format;

use crate::args::names;
use crate::args::{
    BenchArgs, ConvertArgs, DerivativesChoice, EngineChoice, MethodChoice, OnSurface, QualityArgs,
    SmoothArgs, Target,
};
use crate::request::target::TargetRequest;

/// Two options, or values of options, that do not go together.
pub(super) struct Conflict<A> {
    /// The options as messages name them.
    options: [&'static str; 2],
    /// Whether a command line has both options.
    has_both: fn(&A) -> bool,
    /// Words the sentence that refuses both options.
    reason: fn([&str; 2], &A) -> String,
}

const fn row<A>(
    options: [&'static str; 2],
    reason: fn([&str; 2], &A) -> String,
    has_both: fn(&A) -> bool,
) -> Conflict<A> {
    Conflict { options, has_both, reason }
}

/// Words the first conflict of a table that a command line has.
pub(super) fn first<A>(table: &[Conflict<A>], args: &A) -> Option<String> {
    let found = table.iter().find(|conflict| (conflict.has_both)(args))?;
    Some((found.reason)(found.options, args))
}

/// The options of a run, in the order in which conflicts are looked for.
pub(super) const OF_RUN: &[Conflict<SmoothArgs>] = &[
    row(["--target", "--scheme"], sizes_unseen, |a| {
        a.target.is_of_sizes() && !a.scheme().metrics().iter().any(sees_sizes)
    }),
    row(["--target-of place", "--slide"], of_places, |a| is_of_places(a) && a.sliding.slide),
    row(["--target-of place", "--max-move"], of_places, |a| {
        is_of_places(a) && a.max_move.is_some()
    }),
    row(["--target-of place", "--fraction"], of_places, |a| {
        is_of_places(a) && a.fraction.is_some()
    }),
    row(["--target-of place", "--desired"], of_places, |a| is_of_places(a) && a.desired.is_some()),
    row(["--target-of place", "--keep-altitude"], of_places, |a| {
        is_of_places(a) && a.keep_altitude
    }),
    row(["--target-of place", "--checkpoint"], of_places, |a| {
        is_of_places(a) && a.checkpoint.is_some()
    }),
    row(["--target-of place", "--continue"], of_places, |a| {
        is_of_places(a) && a.continued.is_some()
    }),
    row(["--target-of place", "--scheme"], one_metric, |a| is_of_places(a) && alternates(a)),
    row(["--keep-altitude", "--max-move"], together, |a| a.keep_altitude && a.max_move.is_some()),
    row(["--keep-altitude", "--checkpoint"], together, |a| {
        a.keep_altitude && a.checkpoint.is_some()
    }),
    row(["--keep-altitude", "--continue"], together, |a| a.keep_altitude && a.continued.is_some()),
    row(["--keep-altitude", "--scheme"], one_metric, |a| a.keep_altitude && alternates(a)),
    row(["--keep-altitude", "--derivatives finite-difference"], analytic, |a| {
        a.keep_altitude && has_finite_differences(a)
    }),
    row(["--keep-altitude", "--fraction"], searches, |a| a.keep_altitude && has_only_fraction(a)),
    row(["--keep-altitude", "--desired auto"], searches, |a| {
        a.keep_altitude && a.desired == Some(Desired::Auto)
    }),
    row(["--max-move", "--untangle"], together, |a| a.max_move.is_some() && a.untangle),
    row(["--max-move", "--checkpoint"], together, |a| {
        a.max_move.is_some() && a.checkpoint.is_some()
    }),
    row(["--max-move", "--continue"], together, |a| a.max_move.is_some() && a.continued.is_some()),
    row(["--max-move", "--scheme"], one_metric, |a| a.max_move.is_some() && alternates(a)),
    row(["--max-move", "--derivatives finite-difference"], analytic, |a| {
        a.max_move.is_some() && has_finite_differences(a)
    }),
    row(["--max-move", "--fraction"], searches, |a| a.max_move.is_some() && has_only_fraction(a)),
    row(["--max-move", "--desired auto"], searches, |a| {
        a.max_move.is_some() && a.desired == Some(Desired::Auto)
    }),
    row(["--slide", "--checkpoint or --continue"], together, |a| {
        a.sliding.slide && (a.checkpoint.is_some() || a.continued.is_some())
    }),
    row(["--slide", "--scheme"], one_metric, |a| a.sliding.slide && alternates(a)),
    row(["--slide", "--derivatives finite-difference"], analytic, |a| {
        a.sliding.slide && has_finite_differences(a)
    }),
    row(["--slide", "--fraction"], searches, |a| a.sliding.slide && has_only_fraction(a)),
    row(["--slide", "--desired auto"], searches, |a| {
        a.sliding.slide && a.desired == Some(Desired::Auto)
    }),
    row(["--target", "--derivatives finite-difference"], analytic, |a| {
        a.target.target != Target::Equilateral && has_finite_differences(a)
    }),
    row(["--surface sphere", "--derivatives finite-difference"], analytic, |a| {
        a.target.surface.surface == OnSurface::Sphere && has_finite_differences(a)
    }),
    row(["--target metric=VIEW", "a view of gmsh"], sizes_alone, |a| {
        matches!(a.target.target, Target::Metric { .. }) && a.target.has_view()
    }),
    row(["--method multilevel", "--scheme"], uncorrected, |a| {
        is_multilevel(a) && !a.scheme().base().properties().is_corrected
    }),
    row(["--method multilevel", "--derivatives finite-difference"], analytic, |a| {
        is_multilevel(a) && has_finite_differences(a)
    }),
    row(["--method multilevel", "--inner"], one_step, |a| is_multilevel(a) && a.inner != 1),
    row(["--edge-norm", "edge in --scheme"], without, |a| {
        a.edge_norm.is_some() && !a.scheme().metrics().contains(&Metric::Edge)
    }),
    row(["--target-rings", "--target keep-size or keep-shape"], without, |a| {
        a.target.target_rings.is_some() && !a.target.keeps()
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
];

/// The options of `quality`.
pub(super) const OF_QUALITY: &[Conflict<QualityArgs>] = &[
    row(["--picture", "several meshes"], one_mesh, |a| {
        a.picture.picture.is_some() && a.meshes.len() > 1
    }),
    row(["--picture-arrows", "no run"], no_arrows, |a| a.picture.picture_arrows),
];

/// The options of `bench`.
pub(super) const OF_BENCH: &[Conflict<BenchArgs>] =
    &[row(["--engine cpu", "--adapter"], idle, |a| {
        a.engine == EngineChoice::Cpu && a.adapter.is_some()
    })];

/// The options of `convert`.
pub(super) const OF_CONVERT: &[Conflict<ConvertArgs>] =
    &[row(["--to triangle", "-"], several_files, |a| {
        a.to == Some(Format::Triangle) && a.output.as_os_str() == "-"
    })];

fn together<A>([a, b]: [&str; 2], _: &A) -> String {
    format!("{a} does not go with {b}: drop one of them")
}

fn idle<A>([a, b]: [&str; 2], _: &A) -> String {
    format!("{b} has no effect with {a}: drop one of them")
}

fn without<A>([option, wanted]: [&str; 2], _: &A) -> String {
    format!("{option} has no effect without {wanted}: drop it")
}

fn analytic<A>([a, b]: [&str; 2], _: &A) -> String {
    format!("{a} needs analytic derivatives and does not go with {b}: drop one of them")
}

/// The library goes in rounds, each of which must lower f.
fn one_metric([a, _]: [&str; 2], args: &SmoothArgs) -> String {
    let scheme = args.scheme();
    format!("{a} needs one metric other than edge, such as imr, and not --scheme {scheme}")
}

fn searches<A>([a, b]: [&str; 2], _: &A) -> String {
    format!(
        "{b} makes a run search for the desired f, which does not go with {a}: give its value by --desired"
    )
}

fn of_places<A>([_, b]: [&str; 2], _: &A) -> String {
    format!(
        "a target that belongs to places does not go with {b}: drop {b}, or let vertices take their targets along (--target-of vertex)"
    )
}

fn sizes_unseen(_: [&str; 2], args: &SmoothArgs) -> String {
    let (scheme, target) = (args.scheme(), TargetRequest::from(&args.target).name());
    let others =
        names::either(&names::metrics(|metric| sees_sizes(&metric) && metric.properties().barrier));
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

fn uncorrected([a, _]: [&str; 2], args: &SmoothArgs) -> String {
    let base = args.scheme().base();
    format!(
        "{a} does not go with --scheme {base}, whose runs are not corrected from coarser levels: take another metric, such as imr, or drop {a}"
    )
}

fn one_step<A>([a, b]: [&str; 2], _: &A) -> String {
    format!(
        "{a} needs one Newton step per visit of a vertex and does not go with {b}: drop one of them"
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

fn is_of_places(args: &SmoothArgs) -> bool {
    args.target.is_of_places()
}

/// Whether the scheme is other than one metric whose every sweep lowers f.
fn alternates(args: &SmoothArgs) -> bool {
    let scheme: Scheme = args.scheme();
    scheme.period() > 1 || !scheme.is_monotone()
}

fn has_finite_differences(args: &SmoothArgs) -> bool {
    args.derivatives == DerivativesChoice::FiniteDifference
}

/// Whether the run ends at a share of the way to an f that is not given.
fn has_only_fraction(args: &SmoothArgs) -> bool {
    args.fraction.is_some() && args.desired.is_none()
}

fn is_multilevel(args: &SmoothArgs) -> bool {
    args.method == MethodChoice::Multilevel
}

fn sees_sizes(metric: &Metric) -> bool {
    !metric.properties().scale_invariant
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Cli, Command};
    use crate::request::command_line::checked;
    use clap::Parser;

    /// Returns the words that give an option of a table on a command line.
    fn words(options: [&str; 2], view: &str) -> Vec<String> {
        let of = |option: &str| match (option, options) {
            ("--target-of place", _) => "--target keep-shape --target-of place".to_owned(),
            ("--checkpoint or --continue", _) => "--checkpoint state".to_owned(),
            ("--target metric=VIEW", _) => format!("--target metric={view}"),
            ("--target", ["--target", "--scheme"]) => "--target keep-size".to_owned(),
            ("--target", _) => "--target keep-shape".to_owned(),
            ("--scheme", ["--target", _]) => "--scheme imr".to_owned(),
            ("--scheme", ["--method multilevel", _]) => "--scheme area".to_owned(),
            ("--scheme", _) => "--scheme edge+imr".to_owned(),
            ("--edge-norm", _) => "--edge-norm fixed".to_owned(),
            ("--target-of", _) => "--target-of vertex".to_owned(),
            ("--target-rings" | "--inner", _) => format!("{option} 3"),
            ("--max-move" | "--fraction" | "--desired" | "--omega", _) => format!("{option} 0.5"),
            ("--checkpoint" | "--continue" | "--adapter", _) => format!("{option} name"),
            ("--picture", _) => "--picture p.png".to_owned(),
            ("--picture-arrows", _) => "--picture p.png --picture-arrows".to_owned(),
            ("several meshes", _) => "another".to_owned(),
            // The other side of the pair has no words.
            ("a view of gmsh" | "no run" | "edge in --scheme" | "another --target", _)
            | ("--target keep-size or keep-shape", _) => String::new(),
            (option, _) => option.to_owned(),
        };
        options.map(of).join(" ").split_whitespace().map(str::to_owned).collect()
    }

    /// Checks each row of a table: it is the first of the table that its options meet, and they are refused by its words.
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

    #[test]
    fn each_pair_of_another_command_is_refused_by_its_own_words() {
        check(OF_QUALITY, &["gpu-smooth", "quality", "in"], |cli| match &cli.command {
            Some(Command::Quality(args)) => args,
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
