//! The tables of options that contradict each other, by command.

use gpu_smooth_job::TargetKind;
use gpu_smooth_job::options::Spelling;
use mesh_io::Format;

use crate::args::{
    BenchArgs, CompareArgs, ConvertArgs, MoveArgs, QualityArgs, ReadArgs, SmoothArgs,
};
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
    row(["--target metric=VIEW", "a view of gmsh"], sizes_alone, |a| {
        a.target.kind() == TargetKind::Tensors && a.target.has_view()
    }),
    row(REGIONS_OF_FREE, idle, |a| has_free_regions(&a.reading, &a.moving)),
];

/// Conflicts between options of `compare`.
pub(super) const OF_COMPARE: &[Conflict<CompareArgs>] =
    &[row(REGIONS_OF_FREE, idle, |a| has_free_regions(&a.reading, &a.moving))];

/// Regions fix the vertices between them, and are groups that --fix and --only name.
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
        a.options.has("engine=cpu") && a.options.has("adapter")
    }),
    row(["--surface sphere", "a MESH"], without, |a| {
        a.options.has("surface=sphere") && a.mesh.is_none()
    }),
    row(["--z data", "a MESH"], without, |a| a.options.has("z=data") && a.mesh.is_none()),
];

/// Conflicts between options of `convert`.
pub(super) const OF_CONVERT: &[Conflict<ConvertArgs>] =
    &[row(["--to triangle", "-"], several_files, |a| {
        a.form.to == Some(Format::Triangle) && a.output.as_os_str() == "-"
    })];

/// Returns the message for the first conflict in the table of options; `None` if the options of a run are valid.
pub(super) fn of_table(args: &SmoothArgs) -> Option<String> {
    let target = TargetRequest::of(&args.target, args.options.settings());
    let more = args.options.features(target.kind, target.is_of_places());
    args.options.check(target.kind, &more, Spelling::CommandLine).err()
}

fn idle<A>([a, b]: [&str; 2], _: &A) -> String {
    format!("{b} has no effect with {a}: drop one of them")
}

fn without<A>([option, wanted]: [&str; 2], _: &A) -> String {
    format!("{option} has no effect without {wanted}: drop it")
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
    let names_groups = !moving.fix.is_empty() || !moving.only.is_empty();
    reading.regions.is_some() && moving.free_interfaces && !names_groups
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
            ("--adapter" | "--regions", _) => format!("{option} name"),
            ("--picture", _) => "--picture p.png".to_owned(),
            ("--picture-arrows", _) => "--picture p.png --picture-arrows".to_owned(),
            ("several meshes", _) => "another".to_owned(),
            // The other side of the pair has no words.
            ("a view of gmsh" | "no run" | "a MESH", _) => String::new(),
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

    #[test]
    fn each_pair_of_the_table_is_refused_in_words_of_the_command_line() {
        for (words, message) in [
            (
                "--method paper --omega 0.5",
                "--omega does not go with --method paper: it is a setting of --method relaxed",
            ),
            (
                "--engine cpu --adapter name",
                "--adapter does not go with --engine cpu: it names a GPU",
            ),
            (
                "--target keep-size --scheme imr",
                "--target keep-size has no effect on imr, which sees no sizes",
            ),
            (
                "--target keep-size --target-of place --scheme imr+rms",
                "--target-of place does not go with --scheme imr+rms: targets of places need a scheme of one metric other \
                 than edge. Take --scheme tmop-94, or targets of vertices: --target-of vertex",
            ),
            ("--edge-norm fixed", "--edge-norm has no effect without edge in --scheme"),
            ("--max-move 1 --untangle", "--max-move does not go with --untangle"),
        ] {
            let line = format!("gpu-smooth in out {words}");
            let error =
                checked(line.split(' ').map(Into::into)).err().map(|error| error.to_string());
            assert!(error.is_some_and(|error| error.contains(message)), "{line}: {message}");
        }
    }

    /// The metric in the message about targets of places must suit every target.
    #[test]
    fn tmop_94_goes_with_each_target_of_places() {
        for target in ["keep-size", "keep-shape", "size=h", "metric=h"] {
            let line =
                format!("gpu-smooth in out --target {target} --target-of place --scheme tmop-94");
            assert!(checked(line.split(' ').map(Into::into)).is_ok(), "{line}");
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
