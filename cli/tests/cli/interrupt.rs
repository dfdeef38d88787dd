//! Effects of signals on a run, in each of its stages.
#![cfg(unix)]

use super::{Folder, assert_holds, assert_smoothed, plate_path, small};
use mesh_io::MeshFile;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

/// Time limit of a command. A command that exceeds the limit is killed, and its test fails.
const PATIENCE: Duration = Duration::from_secs(120);

/// A running command to which a test can send signals.
pub(crate) struct Started {
    child: Child,
    err: Option<BufReader<ChildStderr>>,
    /// Dropping this sender tells the watchdog that the process has ended.
    _running: Sender<()>,
}

impl Started {
    pub(crate) fn new(folder: &Folder, args: &[&str]) -> Self {
        let mut command = folder.command();
        // A child process whose parent ignores SIGHUP, as tests under nohup do, would ignore the signal too.
        #[cfg(target_os = "linux")]
        {
            let program = command;
            command = Command::new("env");
            command.arg("--default-signal=HUP").arg(program.get_program()).stdin(Stdio::null());
            command.current_dir(&folder.0);
            command.envs(program.get_envs().filter_map(|(name, value)| Some((name, value?))));
        }
        command.args(args);
        Self::of(command)
    }

    fn of(mut command: Command) -> Self {
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let err = Some(BufReader::new(child.stderr.take().unwrap()));
        let (running, ended) = mpsc::channel();
        let id = child.id().to_string();
        std::thread::spawn(move || {
            if ended.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                let _ = Command::new("kill").args(["-KILL", &id]).status();
            }
        });
        Self { child, err, _running: running }
    }

    /// Starts a long run on the plate, and waits until f is below 2. The first line of progress may be of an earlier sweep.
    fn sweeping(folder: &Folder, args: &[&str]) -> Self {
        let plate = plate_path().to_str().unwrap();
        let lasting = ["-v", "--tolerance", "0", "--max-sweeps", "100000000"];
        let mut started = Self::new(folder, &[&[plate], args, &lasting].concat());
        let mut line = String::new();
        while !line.contains("  f 1.") {
            line = started.first_of("gpu-smooth: sweep ");
            assert_holds(&line, &["/100000000  f "]);
        }
        started
    }

    /// Returns the next line on standard error.
    fn line(&mut self) -> String {
        let mut line = String::new();
        self.err.as_mut().unwrap().read_line(&mut line).unwrap();
        line
    }

    /// Returns the next line on standard error that begins with `start`, skipping lines of progress.
    pub(crate) fn first_of(&mut self, start: &str) -> String {
        loop {
            let line = self.line();
            if line.starts_with(start) || line.is_empty() {
                return line;
            }
        }
    }

    /// Returns the next line on standard error that is not a line of progress.
    fn remark(&mut self) -> String {
        loop {
            let line = self.line();
            if !line.starts_with("gpu-smooth: sweep ") {
                return line;
            }
        }
    }

    pub(crate) fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args([name, &id]).status().unwrap().success());
    }

    pub(crate) fn has_ended(&mut self) -> bool {
        self.child.try_wait().unwrap().is_some()
    }

    /// Sends a signal, unless the command has ended.
    pub(crate) fn signal_if_running(&mut self, name: &str) {
        if !self.has_ended() {
            self.signal(name);
            self.child.wait().unwrap();
        }
    }

    /// Closes the reading ends of the command's output pipes.
    fn close_streams(&mut self) {
        self.err = None;
        self.child.stdout = None;
    }

    /// Waits for the process to end. Returns the exit code.
    fn wait(mut self) -> Option<i32> {
        self.child.wait().unwrap().code()
    }

    /// Waits for the process to end. Returns exit code, standard output, and the rest of standard error.
    pub(crate) fn end(mut self) -> (Option<i32>, String, String) {
        let (mut out, mut err) = (String::new(), String::new());
        self.child.stdout.take().unwrap().read_to_string(&mut out).unwrap();
        self.err.as_mut().unwrap().read_to_string(&mut err).unwrap();
        (self.child.wait().unwrap().code(), out, err)
    }
}

impl Drop for Started {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn make_pipe(folder: &Folder, name: &str) {
    assert!(Command::new("mkfifo").arg(folder.path(name)).status().unwrap().success());
}

pub(crate) fn names(folder: &Folder) -> Vec<String> {
    let entries = fs::read_dir(&folder.0).unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn an_interrupted_run_leaves_the_best_mesh_so_far() {
    for (engine, signal, code) in
        [("cpu", "-INT", 130), ("cpu", "-TERM", 143), ("cpu", "-HUP", 129), ("gpu", "-INT", 130)]
    {
        let folder = Folder::new(&[]);
        let mut run =
            Started::sweeping(&folder, &["out", "--engine", engine, "--report", "r.json"]);
        run.signal(signal);
        let remark = run.remark();
        assert!(remark.starts_with("gpu-smooth: interrupted: writing the best mesh"), "{remark}");
        let (found, out, err) = run.end();
        assert_eq!((found, err.as_str()), (Some(code), ""), "{out}");
        assert_holds(&out, &["\ninterrupted after ", " sweeps", "\nworst imr"]);
        let plate = MeshFile::read(plate_path()).unwrap();
        assert_smoothed(&support::mesh_of(&plate), &folder.mesh("out"));
        assert!(support::worst_imr(&folder.mesh("out")) < 2.0);
        assert_eq!(folder.json("r.json")["stop"], "canceled");
        assert_eq!(names(&folder), ["out.ele", "out.node", "r.json"]);
    }
}

/// Returns a folder with `in.off`, a square lattice of `side` cells along each side with randomly moved
/// vertices.
fn perturbed_lattice(side: usize) -> Folder {
    let mesh = support::perturb_random(&support::lattice(side, side), 1.0, 1);
    let mut text = format!("OFF\n{} {} 0\n", mesh.points.len(), mesh.triangles.len());
    text.extend(mesh.points.iter().map(|[x, y]| format!("{x} {y} 0\n")));
    text.extend(mesh.triangles.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n")));
    Folder::new(&[("in.off", &text)])
}

#[test]
fn an_interrupted_run_reports_that_its_goal_was_not_reached() {
    // The mesh is so large and the sweeps so slow that the run cannot end before the signal.
    let folder = perturbed_lattice(90);
    let args = ["in.off", "out.off", "-v", "--engine", "cpu", "--method", "paper"];
    let args = [&args[..], &["--desired", "1", "--fraction", "1", "--scheme", "edge+imr"]].concat();
    let args = [&args[..], &["--derivatives", "finite-difference", "--inner", "30"]].concat();
    let mut run = Started::new(&folder, &[&args[..], &["--max-sweeps", "100000000"]].concat());
    run.first_of("gpu-smooth: sweep ");
    run.signal("-INT");
    let (code, out, _) = run.end();
    assert_eq!(code, Some(130));
    assert_holds(&out, &["\ninterrupted after ", " % of the way to f = 1.000000"]);
}

/// A closed terminal accepts no more text; a pipe without a reader, as standard error, simulates one.
#[test]
fn a_run_whose_terminal_is_closed_leaves_the_best_mesh_and_its_checkpoint() {
    let folder = small();
    let lasting = ["-v", "--tolerance", "0", "--max-sweeps", "100000000"];
    let args = ["in", "out", "--engine", "cpu", "--checkpoint", "state"];
    let mut run = Started::new(&folder, &[&args[..], &lasting].concat());
    run.first_of("gpu-smooth: sweep ");
    run.close_streams();
    run.signal("-HUP");
    assert_eq!(run.wait(), Some(129));
    assert_smoothed(&folder.mesh("in"), &folder.mesh("out"));
    assert_eq!(names(&folder), ["in.ele", "in.node", "out.ele", "out.node", "state"]);
}

#[test]
fn a_run_that_was_started_to_outlive_its_terminal_does() {
    let folder = small();
    let program = env!("CARGO_BIN_EXE_gpu-smooth");
    let line = format!(
        "trap '' HUP; exec {program} in out --engine cpu -v --tolerance 0 --max-sweeps 100000000"
    );
    let mut command = Command::new("sh");
    command.current_dir(&folder.0).args(["-c", &line]);
    let mut run = Started::of(command);
    run.first_of("gpu-smooth: sweep ");
    run.signal("-HUP");
    std::thread::sleep(Duration::from_millis(300));
    assert!(!run.has_ended());
    run.signal("-TERM");
    assert_eq!(run.end().0, Some(143));
}

#[test]
fn an_interrupt_while_the_file_is_read_ends_at_once_with_nothing_written() {
    let folder = Folder::new(&[]);
    make_pipe(&folder, "in.msh");
    let run = Started::new(&folder, &["in.msh", "out.msh", "--report", "r.json"]);
    // Opening the pipe waits until the command reads from it.
    let pipe = fs::OpenOptions::new().write(true).open(folder.path("in.msh")).unwrap();
    run.signal("-INT");
    let (code, out, err) = run.end();
    drop(pipe);
    assert_eq!((code, out.as_str()), (Some(130), ""), "{err}");
    assert_eq!(err, "gpu-smooth: interrupted: nothing was written\n");
    fs::remove_file(folder.path("in.msh")).unwrap();
    assert!(names(&folder).is_empty());
}

#[test]
fn an_interrupt_while_the_optimum_is_sought_ends_at_once_with_nothing_written() {
    let folder = perturbed_lattice(200);
    // Without corrections, the search for the optimum by `area` takes thousands of sweeps.
    let goal = ["--scheme", "area", "--desired", "auto"];
    let args = [&["in.off", "out.off", "-v", "--engine", "cpu"][..], &goal].concat();
    let mut run = Started::new(&folder, &args);
    run.first_of("gpu-smooth: finding the optimum: sweep ");
    run.signal("-TERM");
    let (code, out, err) = run.end();
    assert_eq!((code, out.as_str()), (Some(143), ""), "{err}");
    assert_holds(&err, &["gpu-smooth: interrupted: nothing was written\n"]);
    assert_eq!(names(&folder), ["in.off"]);
}

/// The `.ele` of OUT is a pipe without a reader, so the run blocks while writing.
#[test]
fn a_second_interrupt_ends_at_once_with_nothing_half_written() {
    let folder = small();
    fs::write(folder.path("out.node"), "old\n").unwrap();
    make_pipe(&folder, "out.ele");
    let lasting = ["-v", "--tolerance", "0", "--max-sweeps", "100000000"];
    let args =
        [&["in", "out.node", "--engine", "cpu", "--report", "r.json", "--force"][..], &lasting]
            .concat();
    let mut run = Started::new(&folder, &args);
    run.first_of("gpu-smooth: sweep ");
    run.signal("-INT");
    assert_holds(&run.remark(), &["interrupted: writing"]);
    let start = Instant::now();
    while !names(&folder).iter().any(|name| name.ends_with(".tmp")) {
        assert!(start.elapsed() < PATIENCE, "no temporary file appears: {:?}", names(&folder));
        std::thread::sleep(Duration::from_millis(5));
    }
    run.signal("-INT");
    let (code, out, err) = run.end();
    assert_eq!((code, out.as_str()), (Some(130), ""), "{err}");
    assert_holds(&err, &["gpu-smooth: interrupted again: ended at once\n"]);
    fs::remove_file(folder.path("out.ele")).unwrap();
    assert_eq!(names(&folder), ["in.ele", "in.node", "out.node"]);
    assert_eq!(folder.text("out.node"), "old\n");
}

/// The `.ele` of OUT is a pipe without a reader, so the command blocks while writing.
#[test]
fn an_interrupted_conversion_leaves_no_temporary_file() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let folder = perturbed_lattice(4);
        make_pipe(&folder, "out.ele");
        let run = Started::new(&folder, &["convert", "in.off", "out.node", "--force"]);
        let start = Instant::now();
        while !names(&folder).iter().any(|name| name.ends_with(".tmp")) {
            assert!(start.elapsed() < PATIENCE, "no temporary file appears: {:?}", names(&folder));
            std::thread::sleep(Duration::from_millis(5));
        }
        run.signal(signal);
        let (found, out, err) = run.end();
        assert_eq!((found, out.as_str()), (Some(code), ""), "{err}");
        assert_eq!(err, "gpu-smooth: interrupted: nothing was written\n");
        fs::remove_file(folder.path("out.ele")).unwrap();
        assert_eq!(names(&folder), ["in.off"]);
    }
}

/// An interrupt of a batch keeps the finished meshes, and leaves no file of the mesh under way.
#[test]
fn an_interrupted_call_of_many_meshes_leaves_whole_ones() {
    let folder = small();
    make_pipe(&folder, "waits.msh");
    let args = ["waits.msh", "in.node", "--out-dir", "out", "--engine", "cpu", "--json"];
    let run = Started::new(&folder, &args);
    // A pipe has no size, so it is read last.
    let pipe = fs::OpenOptions::new().write(true).open(folder.path("waits.msh")).unwrap();
    let start = Instant::now();
    while !folder.path("out/in.ele").exists() {
        assert!(start.elapsed() < PATIENCE, "the other mesh is not smoothed");
        std::thread::sleep(Duration::from_millis(5));
    }
    run.signal("-INT");
    std::thread::sleep(Duration::from_millis(200));
    // Closes the pipe: the run notices the interrupt at the end of the file.
    drop(pipe);
    let (code, out, err) = run.end();
    assert_eq!(code, Some(130), "{err}");
    assert_holds(&err, &["interrupted: unfinished meshes are not written"]);
    let told: serde_json::Value = serde_json::from_str(&out).unwrap();
    let statuses = [0, 1].map(|i| told[i]["status"].as_str().unwrap());
    assert_eq!(statuses, ["interrupted", "smoothed"], "{out}");
    let mut written = fs::read_dir(folder.path("out")).unwrap();
    assert!(written.all(|entry| entry.unwrap().file_name().to_string_lossy().starts_with("in.")));
}
