//! Command lines of any words, taken apart without a process: nothing panics, what is refused is told, and what is not can be carried out.
//! `FUZZ_ROUNDS`, a factor, makes more of them.

#[allow(dead_code, unreachable_pub)]
#[path = "../../../tests/support/rng.rs"]
mod rng;

use std::collections::BTreeMap;
use std::ffi::OsString;

use clap::error::ErrorKind;
use clap::{Arg, Command, CommandFactory};
use gpu_smooth::{Backend, Desired, Mesh, Precision, SmoothError, Smoother};

use super::Cli;
use rng::SplitMix64;

/// Values that some options take and others do not.
const VALUES: [&str; 34] = [
    "in.msh",
    "out.msh",
    "-",
    "",
    "--",
    "0",
    "1",
    "2",
    "3",
    "-1",
    "0.5",
    "1.5",
    "0.9",
    "1e-3",
    "1e400",
    "nan",
    "inf",
    "-0.0",
    "99999999999999999999",
    "18446744073709551616",
    "0,0,1,1",
    "inlet,3",
    "edge+imr",
    "area",
    "imr+",
    "soft-size",
    "auto",
    "keep-size",
    "keep-shape",
    "size=s.sol",
    "metric=b.msh:m",
    "size=",
    "min-angle<20",
    "é\u{301}\u{7f}",
];

/// A random command line: options of the program with values, in half of the cases after IN and OUT, and at times words that belong nowhere.
fn line(program: &Command, random: &mut SplitMix64) -> Vec<OsString> {
    let mut words = vec!["gpu-smooth".to_owned()];
    let mut command = program;
    let commands: Vec<&Command> =
        program.get_subcommands().filter(|command| command.get_name() != "help").collect();
    match random.below(4) {
        0 => {
            command = commands[random.below(commands.len())];
            words.extend([command.get_name().to_owned(), "in.msh".to_owned()]);
        }
        1 => {}
        _ => words.extend(["in.msh", "out.msh"].map(str::to_owned)),
    }
    let options: Vec<&Arg> = command.get_arguments().filter(|arg| !arg.is_positional()).collect();
    for _ in 0..random.below(5) {
        let arg = options[random.below(options.len())];
        words.push(match (arg.get_long(), arg.get_short()) {
            (Some(long), _) => format!("--{long}"),
            (None, short) => format!("-{}", short.unwrap_or('x')),
        });
        let has_value = arg.get_action().takes_values();
        if has_value != (random.below(12) == 0) {
            let own: Vec<String> =
                arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
            words.push(match own.len() {
                0 => VALUES[random.below(VALUES.len())].to_owned(),
                count => own[random.below(count)].clone(),
            });
        }
    }
    if random.below(8) == 0 {
        words.insert(1 + random.below(words.len()), VALUES[random.below(VALUES.len())].to_owned());
    }
    #[cfg_attr(not(unix), expect(unused_mut))]
    let mut words: Vec<OsString> = words.into_iter().map(OsString::from).collect();
    #[cfg(unix)]
    if random.below(20) == 0 {
        use std::os::unix::ffi::OsStringExt;
        words.push(OsString::from_vec(vec![b'a', 0xFF, 0x80]));
    }
    words
}

/// Six triangles around a vertex.
fn small_mesh() -> Mesh {
    let mut points = vec![[0.1, 0.2]];
    points.extend((0..6).map(|k| f64::from(k).to_radians() * 60.0).map(|a| [a.cos(), a.sin()]));
    let triangles = (0..6).map(|k| [0, 1 + k, 1 + (k + 1) % 6]).collect();
    Mesh { points, triangles, fixed: Vec::new() }
}

#[test]
fn command_lines_of_any_words_are_refused_or_can_be_carried_out() {
    let factor: Option<usize> =
        std::env::var("FUZZ_ROUNDS").ok().and_then(|text| text.parse().ok());
    let mut random = SplitMix64::new(31);
    let mut program = Cli::command();
    program.build();
    let mesh = small_mesh();
    let smoother = Smoother::new(&mesh).unwrap();
    let mut seen = BTreeMap::<&str, usize>::new();
    for _ in 0..1000 * factor.unwrap_or(1) {
        let words = line(&program, &mut random);
        let kind = match Cli::checked(words.clone()) {
            Ok(cli) if cli.command.is_some() => "command",
            Ok(cli) => {
                assert!(cli.smooth.input.is_some(), "{words:?}");
                let mut options = cli.smooth.options(Precision::Double);
                options.max_sweeps = options.max_sweeps.min(3);
                // To look for the optimum would take most of the time.
                if let Some(goal) =
                    options.goal.as_mut().filter(|goal| goal.desired == Desired::Auto)
                {
                    goal.desired = Desired::Value(1.0);
                }
                match smoother
                    .run(&options, &Backend::Cpu, &mut |_| std::ops::ControlFlow::Continue(()))
                {
                    Ok(_) => "run",
                    Err(SmoothError::Option { .. }) => "options that do not go together",
                    Err(error) => panic!("{words:?}: {error}"),
                }
            }
            Err(error) if !error.use_stderr() => "help",
            Err(error) => {
                let told = error.render().to_string();
                assert!(
                    told.starts_with("error: ") && told.contains("--help"),
                    "{words:?}\n{told}"
                );
                assert_eq!(error.exit_code(), 2, "{words:?}");
                match error.kind() {
                    ErrorKind::ArgumentConflict => "contradiction",
                    ErrorKind::ValueValidation => "value out of range",
                    _ => "other error",
                }
            }
        };
        *seen.entry(kind).or_default() += 1;
    }
    assert!(
        seen.len() >= 6
            && seen.iter().all(|(kind, count)| kind.starts_with("options") || *count > 8),
        "{seen:?}"
    );
}
