//! Checks of arbitrary command lines, parsed without a process: nothing panics, each refusal has a message, and each
//! accepted command line can be carried out. Unit tests choose the words at random, the fuzzer by its input bytes.

use std::ffi::OsString;

use clap::error::ErrorKind;
use clap::{Arg, Command, CommandFactory};
use gpu_smooth::{
    Backend, Mesh, Slide, Smoother, Stopping, TargetField, Targets, options::Precision,
    targets::Surface,
};

use gpu_smooth_job::TargetKind;

use crate::args::Cli;
use crate::request::SmoothRequest;
use crate::request::command_line::checked;

/// A source of choices: random numbers, or bytes of the fuzzer.
pub(crate) trait Choices {
    /// Returns a number below `n`. `n` must be positive.
    fn below(&mut self, n: usize) -> usize;
}

/// Values that some options accept and others refuse.
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

/// Returns a random command line with up to four options and their values. Half of the lines begin with IN and OUT, a
/// quarter with a subcommand. Some lines contain a misplaced word, others a word in invalid UTF-8.
fn line(program: &Command, choices: &mut impl Choices) -> Vec<OsString> {
    let mut words = vec!["gpu-smooth".to_owned()];
    let mut command = program;
    let commands: Vec<&Command> =
        program.get_subcommands().filter(|command| command.get_name() != "help").collect();
    match choices.below(4) {
        0 => {
            command = commands[choices.below(commands.len())];
            words.extend([command.get_name().to_owned(), "in.msh".to_owned()]);
        }
        1 => {}
        _ => words.extend(["in.msh", "out.msh"].map(str::to_owned)),
    }
    let options: Vec<&Arg> = command.get_arguments().filter(|arg| !arg.is_positional()).collect();
    for _ in 0..choices.below(5) {
        let arg = options[choices.below(options.len())];
        words.push(match (arg.get_long(), arg.get_short()) {
            (Some(long), _) => format!("--{long}"),
            (None, short) => format!("-{}", short.unwrap_or('x')),
        });
        let has_value = arg.get_action().takes_values();
        if has_value != (choices.below(12) == 0) {
            // Values of other options may be right where the help does not list the possible ones, such as edge+imr.
            let own: Vec<String> = match arg.is_hide_possible_values_set() {
                true => Vec::new(),
                false => {
                    let values = arg.get_possible_values();
                    values.iter().map(|value| value.get_name().to_owned()).collect()
                }
            };
            words.push(match own.len() {
                0 => VALUES[choices.below(VALUES.len())].to_owned(),
                count => own[choices.below(count)].clone(),
            });
        }
    }
    if choices.below(8) == 0 {
        words
            .insert(1 + choices.below(words.len()), VALUES[choices.below(VALUES.len())].to_owned());
    }
    #[cfg_attr(not(unix), expect(unused_mut))]
    let mut words: Vec<OsString> = words.into_iter().map(OsString::from).collect();
    #[cfg(unix)]
    if choices.below(20) == 0 {
        use std::os::unix::ffi::OsStringExt;
        words.push(OsString::from_vec(vec![b'a', 0xFF, 0x80]));
    }
    words
}

/// Returns a mesh of six triangles around a vertex.
fn small_mesh() -> Mesh {
    let mut points = vec![[0.1, 0.2]];
    points.extend((0..6).map(|k| f64::from(k).to_radians() * 60.0).map(|a| [a.cos(), a.sin()]));
    let triangles = (0..6).map(|k| [0, 1 + k, 1 + (k + 1) % 6]).collect();
    Mesh { points, triangles, ..Mesh::default() }
}

/// Parses command lines as the program does.
pub(crate) struct Checker {
    program: Command,
    mesh: Mesh,
}

impl Checker {
    pub(crate) fn new() -> Self {
        let mut program = Cli::command();
        program.build();
        Self { program, mesh: small_mesh() }
    }

    /// Prepares the mesh, with default sliding and equilateral targets if the request has sliding or targets.
    fn smoother(&self, request: &SmoothRequest) -> Smoother<'_> {
        let mut smoother = Smoother::new(&self.mesh).unwrap();
        if request.slide.is_some() {
            smoother.set_slide(Some(&Slide::default())).unwrap();
        }
        let targets = Targets::equilateral(self.mesh.points.len());
        let is_plain = request.target.kind == TargetKind::Equilateral;
        if request.target.is_of_places() {
            let field = TargetField::new(&self.mesh, &targets).unwrap();
            smoother.set_target_field(field).unwrap();
        } else if !is_plain || request.surface != Surface::Plane {
            smoother.set_targets(&targets).unwrap();
        }
        smoother
    }

    /// Checks the command line chosen by `choices`, and returns the kind of its result. Runs are limited to three
    /// sweeps.
    ///
    /// # Panics
    ///
    /// Panics if a check fails.
    pub(crate) fn check(&self, choices: &mut impl Choices) -> &'static str {
        let words = line(&self.program, choices);
        match checked(words.clone()) {
            Ok(cli) if cli.command.is_some() => "command",
            Ok(cli) => {
                assert!(cli.smooth.input.is_some(), "{words:?}");
                // `SmoothRequest::new` refuses a picture whose extension is neither `.png` nor `.svg`.
                let Ok(request) = SmoothRequest::new(cli.smooth) else { return "contradiction" };
                let mut options = request.options(Precision::Double);
                options.max_sweeps = options.max_sweeps.min(3);
                // The search of the optimum would take most of the time.
                if let Stopping::Goal(goal) = &mut options.stopping {
                    goal.desired = goal.desired.or(Some(1.0));
                }
                // The parser must have refused all options that the library refuses.
                match self.smoother(&request).run(&options).on(&Backend::Cpu).block() {
                    Ok(_) => "run",
                    Err(error) => panic!("{words:?}: {error}"),
                }
            }
            Err(error) if !error.use_stderr() => "help",
            // Without arguments, the help is the answer, on standard error.
            Err(error) if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                assert!(words.len() == 1 && error.exit_code() == 2, "{words:?}");
                "help"
            }
            Err(error) => {
                let message = error.render().to_string();
                assert!(
                    message.starts_with("error: ") && message.contains("--help"),
                    "{words:?}\n{message}"
                );
                assert_eq!(error.exit_code(), 2, "{words:?}");
                match error.kind() {
                    ErrorKind::ArgumentConflict => "contradiction",
                    ErrorKind::ValueValidation => "value out of range",
                    _ => "other error",
                }
            }
        }
    }
}

/// Checks the command line chosen by `bytes`, one byte per choice. Choices beyond the last byte are 0.
#[cfg(fuzzing)]
pub(crate) fn any_line(bytes: &[u8]) {
    struct Bytes<'a>(std::slice::Iter<'a, u8>);

    impl Choices for Bytes<'_> {
        fn below(&mut self, n: usize) -> usize {
            self.0.next().map_or(0, |&byte| usize::from(byte) % n)
        }
    }

    static CHECKER: std::sync::LazyLock<Checker> = std::sync::LazyLock::new(Checker::new);
    CHECKER.check(&mut Bytes(bytes.iter()));
}
