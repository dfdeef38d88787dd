//! Long runs: checkpoints, and the time limit.
#![cfg(unix)]

use super::interrupt::{Started, names};
use super::{Folder, Run, assert_holds, assert_smoothed, finish, small};
use gpu_smooth::Checkpoint;
use mesh_io::MeshFile;
use std::fs;
use std::time::{Duration, Instant};

/// A run that takes all of its 300 sweeps, long enough for a test to stop the run.
const LONG: &str = "in.node out --engine cpu --scheme edge+imr --tolerance 0 --max-sweeps 300";

/// Returns the result of the run without a stop: its folder and the mesh.
fn uninterrupted() -> (Folder, String) {
    let folder = small();
    folder.line(LONG).clean();
    let node = folder.text("out.node");
    (folder, node)
}

#[test]
fn a_run_that_was_killed_goes_on_to_the_same_bits() {
    let (folder, expected) = uninterrupted();
    fs::remove_file(folder.path("out.node")).unwrap();
    fs::remove_file(folder.path("out.ele")).unwrap();
    let checkpoint = ["--checkpoint", "run.ckpt", "--checkpoint-every", "0.001"];
    let mut args: Vec<&str> = LONG.split(' ').collect();
    args.extend(checkpoint);
    // Kills the run several times, and continues from the checkpoint each time.
    for round in 0..4 {
        let mut run = Started::new(&folder, &args);
        let start = Instant::now();
        let before = fs::read(folder.path("run.ckpt")).ok();
        while fs::read(folder.path("run.ckpt")).ok() == before {
            assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint in round {round}");
            if run.has_ended() {
                break;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        run.signal_if_running("-KILL");
        drop(run);
        if !folder.path("run.ckpt").exists() {
            break;
        }
        // Temporary files may be left, but the checkpoint is complete.
        Checkpoint::from_bytes(&fs::read(folder.path("run.ckpt")).unwrap()).unwrap();
        args.retain(|arg| !arg.contains("continue") && !checkpoint.contains(arg));
        args.extend(["--continue", "run.ckpt", "--checkpoint-every", "0.001"]);
    }
    if folder.path("run.ckpt").exists() {
        folder.run(&args).clean();
    }
    assert_eq!(folder.text("out.node"), expected);
    assert!(!folder.path("run.ckpt").exists(), "the checkpoint of a run that has ended");
}

#[test]
fn a_run_ended_by_the_time_limit_writes_its_mesh_and_goes_on() {
    let (folder, expected) = uninterrupted();
    let before = MeshFile::read(&folder.path("in.node")).unwrap();
    let limited = format!("{LONG} --time-limit 0.001 --checkpoint run.ckpt --report r.json");
    let Run { code, out, err } = folder.line(&limited);
    assert_eq!(code, Some(0), "{err}");
    assert_holds(&out, &["\nended by --time-limit after "]);
    assert_holds(&err, &["to continue the run, add --continue run.ckpt"]);
    assert_eq!(folder.json("r.json")["stop"], "time-limit");
    assert_smoothed(&support::mesh_of(&before), &folder.mesh("out"));
    assert_ne!(folder.text("out.node"), expected);
    let sweeps = folder.json("r.json")["sweeps"].as_u64();
    folder.line(&format!("{LONG} --continue run.ckpt --report r.json")).clean();
    assert_eq!(folder.text("out.node"), expected);
    assert_eq!(folder.json("r.json")["continued_from"].as_u64(), sweeps);
    assert_eq!(folder.json("r.json")["sweeps"], 300);
    assert!(!folder.path("run.ckpt").exists());
    // With --strict, an unfinished run is an error.
    let Run { code, err, .. } = folder.line(&format!("{LONG} --time-limit 0.001 --strict"));
    assert_eq!(code, Some(1));
    assert_holds(&err, &["ended by --time-limit after "]);
}

#[test]
fn an_interrupted_run_goes_on() {
    let (folder, expected) = uninterrupted();
    let line = format!("{LONG} -v --checkpoint run.ckpt");
    let mut run = Started::new(&folder, &line.split(' ').collect::<Vec<_>>());
    run.first_of("gpu-smooth: sweep ");
    run.signal("-INT");
    let (code, _, err) = run.end();
    // The run may have ended before the signal came.
    if err.contains("to continue the run, add --continue run.ckpt") {
        assert_eq!(code, Some(130));
        folder.line(&format!("{LONG} --continue run.ckpt")).clean();
    }
    assert_eq!(folder.text("out.node"), expected);
    assert_eq!(names(&folder), ["in.ele", "in.node", "out.ele", "out.node"]);
}

#[test]
fn a_checkpoint_that_does_not_fit_is_refused_before_anything_is_written() {
    let folder = small();
    let limited = format!("{LONG} --time-limit 0.001 --checkpoint run.ckpt");
    assert_eq!(folder.line(&limited).code, Some(0));
    fs::remove_file(folder.path("out.node")).unwrap();
    fs::remove_file(folder.path("out.ele")).unwrap();
    let kept = folder.content();
    let refused = |line: &str, parts: &[&str]| {
        folder.line(line).refused(parts);
        assert!(folder.content() == kept, "{line}: something was written");
    };
    // The run would overwrite the checkpoint of another run.
    refused(
        &limited,
        &["run.ckpt: the file is a checkpoint of another run", "--continue run.ckpt"],
    );
    refused(
        &format!("{LONG} --continue run.ckpt --omega 1.2"),
        &[
            "run.ckpt: the checkpoint cannot be used: the run of the checkpoint has",
            "with the same options",
        ],
    );
    refused(
        &format!("{LONG} --continue run.ckpt --fix-box 0,0,6,6 -q"),
        &["run.ckpt: the checkpoint cannot be used: mesh, held vertices"],
    );
    refused(&format!("{LONG} --continue none"), &["none: the file does not exist"]);
    fs::write(folder.path("foreign"), "no checkpoint").unwrap();
    folder
        .line(&format!("{LONG} --continue foreign"))
        .refused(&["foreign: the file is not a checkpoint of gpu-smooth. Without --continue"]);
    fs::remove_file(folder.path("foreign")).unwrap();
    let misused = |line: &str, parts: &[&str]| {
        folder.line(line).misused(parts);
        assert!(folder.content() == kept, "{line}: something was written");
    };
    misused(&format!("{LONG} --checkpoint in.node"), &["in.node: the checkpoint would replace"]);
    misused(&format!("{LONG} --checkpoint out.node"), &["out.node: a checkpoint is no mesh"]);
    let in_place = "in.node in.node --engine cpu --checkpoint new.ckpt";
    misused(in_place, &["in.node: a checkpoint continues a run only while IN is unchanged"]);
    refused(
        "in in.node --engine cpu --checkpoint new.ckpt",
        &["in.node: a checkpoint continues a run only while IN is unchanged"],
    );
    let mut bytes = fs::read(folder.path("run.ckpt")).unwrap();
    bytes[100] ^= 1;
    fs::write(folder.path("bad.ckpt"), bytes).unwrap();
    let bad = folder.line(&format!("{LONG} --continue bad.ckpt"));
    bad.refused(&["bad.ckpt: the checkpoint, written by gpu-smooth ", ", is damaged. Without"]);
    fs::write(folder.path("later.ckpt"), "gpu-smooth checkpoint 99\nwritten by gpu-smooth 7.0\n")
        .unwrap();
    let later = folder.line(&format!("{LONG} --continue later.ckpt"));
    later.refused(&[
        "later.ckpt: gpu-smooth ",
        " does not read checkpoints that gpu-smooth 7.0 wrote",
        "Continue the run by gpu-smooth 7.0",
    ]);
    fs::write(folder.path("notes.txt"), "mine").unwrap();
    folder
        .line(&format!("{LONG} --checkpoint notes.txt"))
        .refused(&["notes.txt: exists and is not a checkpoint"]);
    assert_eq!(folder.text("notes.txt"), "mine");
}

/// If the disk has no room for a checkpoint, the run continues and reports the problem.
#[test]
fn a_checkpoint_that_cannot_be_saved_is_reported() {
    let folder = small();
    fs::create_dir(folder.path("sub")).unwrap();
    let line = format!("{LONG} -v --checkpoint sub/run.ckpt --checkpoint-every 0.001");
    let mut command = folder.command();
    // The shell limits files to a few kilobytes.
    let shell = format!("ulimit -f 4; exec {} {line}", env!("CARGO_BIN_EXE_gpu-smooth"));
    drop(command);
    command = std::process::Command::new("sh");
    command.current_dir(&folder.0).env("XDG_RUNTIME_DIR", std::env::temp_dir());
    let Run { err, .. } = finish(command.args(["-c", &shell]));
    assert_holds(&err, &["no checkpoint was saved: "]);
    assert_eq!(fs::read_dir(folder.path("sub")).unwrap().count(), 0, "a temporary file stays");
}
