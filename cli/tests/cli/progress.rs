//! Progress of a run on a terminal and in a log.

use super::{Folder, assert_holds, small};
use serde_json::Value;

/// Parses the events on standard error, one JSON object per line.
fn events(text: &str) -> Vec<Value> {
    let event =
        |line: &str| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error} in {line}"));
    text.lines().map(event).collect()
}

#[test]
fn a_log_of_json_has_an_object_on_every_line() {
    let folder = small();
    let run = folder.line("in out --log json --engine cpu --report r.json --fix-box 0,0,1,1");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let events = events(&run.err);
    let stages: Vec<_> = events.iter().filter_map(|event| event["stage"].as_str()).collect();
    assert_eq!(stages, ["reading", "preparing", "smoothing", "writing"]);
    let note = events.iter().find(|event| event["event"] == "note").unwrap();
    assert_holds(note["message"].as_str().unwrap(), &["--fix-box 0,0,1,1: "]);
    let seconds: Vec<f64> = events.iter().map(|event| event["seconds"].as_f64().unwrap()).collect();
    assert!(seconds.is_sorted(), "{seconds:?}");
    let (end, report) = (&events[events.len() - 1], folder.json("r.json"));
    assert_eq!((&end["event"], &end["mesh"]), (&"end".into(), &"in".into()));
    assert_eq!((&end["stop"], &end["sweeps"]), (&report["stop"], &report["sweeps"]));
    assert_eq!(end["f_after"], report["after"]["f"]["imr"]);
    // Pictures and pages are drawn in a stage of their own.
    let run = folder.line("in out --log json --engine cpu --picture p.png --html p.html");
    let events_of_drawing = self::events(&run.err);
    let mut stages = events_of_drawing.iter().filter_map(|event| event["stage"].as_str());
    assert_eq!(stages.next_back(), Some("drawing"), "{}", run.err);
    let run = folder.line("quality in --log json --picture p.png");
    assert_holds(&run.err, &["\"stage\":\"reading\"", "\"stage\":\"drawing\""]);
    assert_eq!(folder.line("quality in --log json").err, "");
    let run = folder.line("in out --log json --engine cpu --report r.json --fix-box 0,0,1,1");
    // The result is printed to standard output as without `--log`.
    assert_holds(&run.out, &["\nconverged after "]);

    let run = folder.line("none out --log json");
    let error = &self::events(&run.err)[1];
    assert_eq!((run.code, &error["event"]), (Some(3), &"error".into()));
    assert_holds(error["message"].as_str().unwrap(), &["none: "]);
    assert_eq!(error["kind"], "input");
    assert_holds(error["remedy"].as_str().unwrap(), &["Check the name"]);
    // The codes are those of the table in docs/guide.md.
    for (line, kind, code) in [
        ("in out --engine cpu --strict --max-sweeps 1", "run", 1),
        ("convert in out.xyz", "usage", 2),
        ("quality in none --threshold min-angle<90", "input", 3),
        ("in none/out --engine cpu", "output", 4),
        ("in out --adapter none-of-this-name", "device", 5),
    ] {
        let run = folder.line(&format!("{line} --log json"));
        let error = &self::events(&run.err).pop().unwrap();
        assert_eq!((run.code, &error["kind"]), (Some(code), &kind.into()), "{line}: {error}");
    }
    let run = folder.line("in out --log json --engine cpu -q").clean();
    assert_eq!(run.out, "");
}

#[test]
fn many_meshes_are_logged_one_by_one() {
    let folder = small();
    let run = folder.line("in none.msh --out-dir d --engine cpu --log json");
    let events = events(&run.err);
    let meshes: Vec<_> = events.iter().filter(|event| event["event"] == "mesh").collect();
    assert_eq!(meshes.len(), 2);
    assert_eq!((&meshes[1]["done"], &meshes[1]["meshes"]), (&2.into(), &2.into()));
    let failed = meshes.iter().find(|mesh| mesh["mesh"] == "none.msh").unwrap();
    assert_holds(failed["problem"].as_str().unwrap(), &["none.msh: "]);
    assert_eq!(events[2]["event"], "error");
}

/// Each stage reports its elapsed time, even if it cannot report its progress.
#[cfg(target_os = "linux")]
#[test]
fn a_long_stage_is_shown_on_a_terminal_and_in_a_log() {
    use std::fs;
    use std::process::{Command, Stdio};
    use std::time::Duration;

    let program = env!("CARGO_BIN_EXE_gpu-smooth");
    for on_terminal in [true, false] {
        let folder = Folder::new(&[]);
        let pipe = folder.path("in.msh");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let mut command = Command::new("script");
        command.args([
            "-qec",
            &format!("stty rows 24 cols 40 <&1; {program} in.msh out.msh"),
            "/dev/null",
        ]);
        if !on_terminal {
            command = Command::new(program);
            command.args(["in.msh", "out.msh", "-v"]);
        }
        command.current_dir(&folder.0).stdin(Stdio::null()).env("TERM", "xterm");
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let writer = fs::OpenOptions::new().write(true).open(&pipe).unwrap();
        std::thread::sleep(Duration::from_millis(1300));
        drop(writer);
        let output = child.wait_with_output().unwrap();
        let told = if on_terminal { output.stdout } else { output.stderr };
        let text = String::from_utf8(told).unwrap();
        assert_eq!(text.contains("\u{1b}["), on_terminal, "{text}");
        assert_holds(&text, &["reading  1 s"]);
        assert_holds(&text, &["in.msh: the file is empty"]);
        for line in text.split(['\r', '\n']).filter(|line| line.contains("reading")) {
            assert!(!on_terminal || line.chars().count() < 50, "{line:?}");
        }
    }
}

/// A signal removes the bar, so that no estimate stays on the terminal.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_removes_the_bar_from_the_terminal() {
    use std::fs;
    use std::process::{Command, Stdio};
    use std::time::Duration;

    let program = env!("CARGO_BIN_EXE_gpu-smooth");
    for line in ["in.msh out.msh", "try in.msh", "quality in.msh --picture p.png"] {
        let folder = Folder::new(&[]);
        let pipe = folder.path("in.msh");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let mut command = Command::new("script");
        let shell = format!("stty rows 24 cols 60 <&1; {program} {line} & echo $! > id; wait $!");
        command.args(["-qec", &shell, "/dev/null"]);
        command.current_dir(&folder.0).stdin(Stdio::null()).env("TERM", "xterm");
        let child = command.stdout(Stdio::piped()).spawn().unwrap();
        let writer = fs::OpenOptions::new().write(true).open(&pipe).unwrap();
        std::thread::sleep(Duration::from_millis(1300));
        let id = folder.text("id");
        assert!(Command::new("kill").args(["-TERM", id.trim()]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        drop(writer);
        let text = String::from_utf8(output.stdout).unwrap();
        let (bars, note) = text.split_once("gpu-smooth: interrupted").unwrap();
        assert_holds(note, &[": nothing was written"]);
        let last = bars.rsplit("reading").next().unwrap();
        assert!(bars.contains("reading  1 s"), "{line}: {text:?}");
        assert!(last.contains("\u{1b}[2K") || last.contains("\u{1b}[K"), "{line}: {text:?}");
    }
}
