//! All output of the program to standard output and standard error.

use std::fmt::Arguments;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use gpu_smooth::gpu::AdapterSummary;

use serde_json::{Value, json};

use crate::error::CliError;
use crate::terminal::requested;

/// Whether standard error receives JSON. `START` is the time from which events count seconds.
static JSON: AtomicBool = AtomicBool::new(false);
static START: OnceLock<Instant> = OnceLock::new();

/// Exit code of a process whose standard output is closed before its end: that of the signal SIGPIPE, which ends usual
/// programs.
const CLOSED_PIPE: i32 = 128 + 13;

/// Switches standard error to JSON, one object per line.
pub(crate) fn log_json() {
    START.get_or_init(Instant::now);
    JSON.store(true, Ordering::Relaxed);
}

/// Returns whether standard error receives JSON.
pub(crate) fn is_json() -> bool {
    JSON.load(Ordering::Relaxed)
}

/// Writes a line to standard error. Ignores failures, such as a closed terminal, because the run must continue to its
/// end.
fn put(line: Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Writes an event to standard error as a line of JSON, with the seconds since the process began.
pub(crate) fn event(mut event: Value) {
    event["seconds"] = START.get_or_init(Instant::now).elapsed().as_secs_f64().into();
    put(format_args!("{event}"));
}

/// Prints a result for people to standard output. Escapes control characters, which names of files and groups may
/// contain.
pub(crate) fn say(text: &str) {
    say_data(&printable(text));
}

/// Prints a result for programs to standard output, without any change unless standard output is a terminal. If the reader has
/// closed the pipe, as `head` does, the process ends without a message. Other failures, such as a full disk, end the process
/// with an error.
pub(crate) fn say_data(text: &str) {
    let mut out = std::io::stdout();
    let written = match out.is_terminal() {
        true => writeln!(out, "{}", printable(text)),
        false => writeln!(out, "{text}"),
    };
    if let Err(problem) = written {
        end_if_closed(&problem);
        let failed = CliError::output(format!("standard output: {problem}"));
        error(&failed);
        std::process::exit(failed.kind.exit_code().into());
    }
}

/// Ends the process without a message if `problem` is that of a pipe whose reader has gone.
pub(crate) fn end_if_closed(problem: &std::io::Error) {
    if problem.kind() == ErrorKind::BrokenPipe {
        // A signal has its own exit code, such as that of a closed terminal.
        std::process::exit(match requested::exit_code() {
            0 => CLOSED_PIPE,
            code => code.into(),
        });
    }
}

/// Prints a result to standard error, for commands whose standard output receives the mesh.
pub(crate) fn aside(text: &str) {
    put(format_args!("{}", printable(text)));
}

/// Prints a remark to standard error, unless `quiet` is true.
pub(crate) fn note(quiet: bool, text: &str) {
    match () {
        () if quiet => {}
        () if is_json() => event(json!({ "event": "note", "message": text })),
        () => put(format_args!("gpu-smooth: {}", printable(text))),
    }
}

/// Escapes control characters of a message, except for line ends and tabs. File names may contain control characters, which a
/// terminal would execute.
fn printable(text: &str) -> String {
    let shown = |c: char| match c.is_control() && !matches!(c, '\n' | '\t') {
        true => c.escape_default().to_string(),
        false => c.to_string(),
    };
    text.chars().map(shown).collect()
}

/// Prints an error to standard error. A line of JSON also contains the error's kind and remedy.
pub(crate) fn error(error: &CliError) {
    let text = error.to_string();
    let shown = printable(&text);
    match is_json() {
        true => {
            let kind = error.kind.name();
            let mut line = json!({ "event": "error", "message": text, "kind": kind });
            if let Some(remedy) = error.remedy() {
                line["remedy"] = remedy.into();
            }
            event(line);
        }
        false if is_colored() => {
            put(format_args!("gpu-smooth: \u{1b}[1;31merror:\u{1b}[0m {shown}"));
        }
        false => put(format_args!("gpu-smooth: error: {shown}")),
    }
}

/// Returns whether errors are colored: on a terminal with colors, unless `NO_COLOR` (<https://no-color.org>) is set;
/// anywhere if `CLICOLOR_FORCE` (<https://bixense.com/clicolors>) is set.
fn is_colored() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let forced = set("CLICOLOR_FORCE");
    let is_dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    !set("NO_COLOR") && (forced || std::io::stderr().is_terminal() && !is_dumb)
}

/// Describes an adapter by its type, backend and driver.
pub(crate) fn adapter(adapter: &AdapterSummary) -> String {
    let software = if adapter.is_software() { ": software" } else { "" };
    format!("({}{software}, {}; {})", adapter.kind, adapter.backend, adapter.driver)
}
