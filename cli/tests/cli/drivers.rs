//! Failing drivers: a layer in front of Mesa's driver makes one function fail from a given call on (`faulty_driver.c`).

use super::{Folder, Run, assert_holds, assert_smoothed, finish, small};
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use tempfile::TempDir;

/// Results of Vulkan: the value of a `VkResult`.
const LOST: &str = "-4";
const NO_MEMORY: &str = "-2";

/// The path of Mesa's software driver, as this machine has registered it.
fn real_driver() -> String {
    let folders = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"];
    let files = folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
    let mut lavapipe = files.filter(|file| file.file_name().to_string_lossy().starts_with("lvp"));
    let file = lavapipe.next().expect("these tests need Mesa's lavapipe; tests/run installs it");
    let registered: serde_json::Value =
        serde_json::from_slice(&fs::read(file.path()).unwrap()).unwrap();
    registered["ICD"]["library_path"].as_str().unwrap().to_owned()
}

/// Returns a folder with the faulty driver, compiled once per process.
fn faulty_driver() -> &'static TempDir {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = TempDir::new().unwrap();
        let library = folder.path().join("libfaulty.so");
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cli/faulty_driver.c");
        let compiled = Command::new("cc")
            .args(["-shared", "-fPIC", "-o"])
            .arg(&library)
            .args([source, "-ldl"])
            .output()
            .expect("these tests need cc, with which Rust links as well");
        assert!(compiled.status.success(), "{compiled:?}");
        let icd = serde_json::json!({
            "file_format_version": "1.0.0",
            "ICD": { "library_path": library, "api_version": "1.1.0" },
        });
        fs::write(folder.path().join("icd.json"), icd.to_string()).unwrap();
        folder
    })
}

/// Makes a new directory for the files of a session, in which no driver has started yet.
fn session() -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let path = faulty_driver().path().join(format!("session-{number}"));
    fs::create_dir(&path).unwrap();
    path
}

/// Sets the environment so that the command finds only the faulty driver, which has not started before.
fn with_fault<'c>(
    command: &'c mut Command,
    function: &str,
    from: usize,
    result: &str,
) -> &'c mut Command {
    let icd = faulty_driver().path().join("icd.json");
    command.env("VK_DRIVER_FILES", &icd).env("VK_ICD_FILENAMES", icd);
    command.env_remove("VK_ADD_DRIVER_FILES").env("REAL_DRIVER", real_driver());
    command
        .env("XDG_RUNTIME_DIR", session())
        .env("FAULT_FUNCTION", function)
        .env("FAULT_FROM", from.to_string());
    command.env("FAULT_RESULT", result)
}

/// Checks that a fault is not reported as a bug of the program.
fn assert_told(run: &Run, label: &str) {
    for word in ["panicked", "unwrap", "RUST_BACKTRACE"] {
        assert!(!run.err.contains(word), "{label}:\n{}", run.err);
    }
}

const RUN: &str = "in out --engine gpu --tolerance 0 --max-sweeps 40 --report r.json";

#[test]
fn a_device_that_is_lost_in_the_middle_does_not_end_the_run() {
    let folder = small();
    folder.line(&RUN.replace("gpu", "cpu")).clean();
    let f = |folder: &Folder| folder.json("r.json")["after"]["f"]["imr"].as_f64().unwrap();
    let on_cpu = f(&folder);
    // A submission fails, and the program notices the lost device while waiting.
    for (function, from) in
        [("vkQueueSubmit", 12), ("vkWaitSemaphores", 7), ("vkGetSemaphoreCounterValue", 15)]
    {
        let mut command = folder.command();
        let command = with_fault(&mut command, function, from, LOST);
        let run = finish(command.args(RUN.split(' ')));
        assert_eq!(run.code, Some(0), "{function}: {}", run.err);
        let told = "gpu-smooth: the GPU failed: the device was lost: ";
        assert_holds(&run.err, &[told, "The run goes on on the CPU, from sweep "]);
        assert_told(&run, function);
        let report = folder.json("r.json");
        assert_holds(report["engine"]["fault"].to_string().as_str(), &["the device was lost"]);
        assert_eq!(report["sweeps"], 40, "{function}");
        assert_smoothed(&folder.mesh("in"), &folder.mesh("out"));
        assert!((f(&folder) / on_cpu - 1.0).abs() < 1e-5, "{function}: {}", f(&folder));
    }
}

/// Functions of a driver that a run calls, each with an error code to return.
const FAULTS: [(&str, &str); 17] = [
    ("vkQueueSubmit", LOST),
    ("vkQueueSubmit", NO_MEMORY),
    ("vkWaitSemaphores", LOST),
    ("vkGetSemaphoreCounterValue", LOST),
    ("vkAllocateMemory", NO_MEMORY),
    ("vkMapMemory", "-5"),
    ("vkCreateBuffer", NO_MEMORY),
    ("vkBindBufferMemory", NO_MEMORY),
    ("vkCreateComputePipelines", NO_MEMORY),
    ("vkCreateComputePipelines", LOST),
    ("vkCreateShaderModule", NO_MEMORY),
    ("vkBeginCommandBuffer", NO_MEMORY),
    ("vkEndCommandBuffer", NO_MEMORY),
    ("vkAllocateCommandBuffers", NO_MEMORY),
    ("vkAllocateDescriptorSets", NO_MEMORY),
    ("vkCreateDevice", "-3"),
    ("vkEnumeratePhysicalDevices", "-3"),
];

/// A function fails from one call on. The command must smooth the mesh, or write nothing and name a remedy. Several
/// calls of each function are tried, or all calls if the environment variable ALL_FAULTS is set.
#[test]
fn whatever_call_of_a_driver_fails_the_mesh_is_smoothed_or_untouched() {
    let line = "in out -q --engine gpu --max-sweeps 6";
    let (mut smoothed, mut refused) = (0, 0);
    for (function, result) in FAULTS {
        let folder = small();
        let count = folder.path("count");
        fs::write(&count, "").unwrap();
        let mut command = folder.command();
        command.env("FAULT_COUNT", &count);
        finish(with_fault(&mut command, function, usize::MAX >> 40, result).args(line.split(' ')))
            .clean();
        let calls = fs::read(&count).unwrap().len();
        assert!(calls > 0, "{function} is not called");
        let numbers: Vec<usize> = match std::env::var_os("ALL_FAULTS") {
            Some(_) => (1..=calls).collect(),
            None => vec![calls.div_ceil(2)],
        };
        for from in numbers {
            let folder = small();
            let before = folder.content();
            let mut command = folder.command();
            let run =
                finish(with_fault(&mut command, function, from, result).args(line.split(' ')));
            let label = format!("{function} from call {from} of {calls}: {result}");
            assert_told(&run, &label);
            match run.code {
                Some(0) => {
                    assert_smoothed(&folder.mesh("in"), &folder.mesh("out"));
                    smoothed += 1;
                }
                _ => {
                    assert!(folder.content() == before, "{label}");
                    let run = run.refused(&["--engine cpu"]);
                    assert!(run.err.lines().count() == 1, "{label}:\n{}", run.err);
                    refused += 1;
                }
            }
        }
    }
    assert!(smoothed > 3 && refused > 3, "{smoothed} smoothed, {refused} refused");
}

#[test]
fn a_driver_that_crashes_on_start_does_not_end_a_run_that_was_free_to_choose() {
    // The mesh is large and the scheme needs many sweeps, so that a run on one core considers a GPU.
    let [node, ele] = support::triangle_text(&support::lattice(200, 200), "");
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    for function in ["vkCreateInstance", "vkCreateDevice", "vkQueueSubmit"] {
        let mut command = folder.command();
        let command = with_fault(&mut command, function, 1, "crash").env("RAYON_NUM_THREADS", "1");
        let run = finish(command.args(["in", "out", "--scheme", "edge", "--desired", "1e6"]));
        let told =
            "edge on cpu (all cores): the driver of the GPU failed when it was tried: signal: 6";
        assert_holds(&run.clean().out, &[told]);
    }
}

#[test]
fn a_driver_that_crashes_on_start_is_an_error_where_a_gpu_is_asked_for() {
    let folder = small();
    let before = folder.content();
    let told = "the driver of the GPU failed when it was tried: signal: 6";
    let remedy = "Use --engine cpu, or another driver";
    let lines = ["in out --engine gpu", "in out --adapter llvm", "in --out-dir d --engine gpu"];
    let others = ["adapters", "bench --engine gpu"];
    for (line, function) in lines.into_iter().chain(others).zip([
        "vkCreateInstance",
        "vkCreateDevice",
        "vkQueueSubmit",
        "vkCreateDevice",
        "vkCreateInstance",
    ]) {
        let mut command = folder.command();
        let run = finish(with_fault(&mut command, function, 1, "crash").args(line.split(' ')));
        run.refused(&[told, remedy]);
    }
    fs::remove_dir(folder.path("d")).unwrap();
    assert!(folder.content() == before);
}

/// A driver that has started well starts once in the next commands of the session. If the driver then ends a process on
/// start, the command after that tries the driver again.
#[test]
fn a_driver_that_has_started_is_tried_again_only_after_a_crash() {
    let folder = small();
    let (session, count) = (session(), folder.path("count"));
    // The arguments are a function that fails, its first failing call, and how it fails.
    let with = |function: &str, from: usize, result: &str| {
        fs::write(&count, "").unwrap();
        let mut command = folder.command();
        with_fault(&mut command, function, from, result);
        command.env("XDG_RUNTIME_DIR", &session).env("FAULT_TRIALS", &count);
        command.args("in out --engine gpu --max-sweeps 2 -q --force".split(' '));
        command
    };
    let is_tried = || {
        finish(&mut with("vkCreateDevice", usize::MAX >> 40, LOST)).clean();
        !fs::read(&count).unwrap().is_empty()
    };
    assert_eq!([is_tried(), is_tried(), is_tried()], [true, false, false]);
    let ended = with("vkCreateDevice", 1, "crash").output().unwrap();
    assert_eq!(ended.status.signal(), Some(6), "{ended:?}");
    let told = "the driver of the GPU failed when it was tried: signal: 6";
    finish(&mut with("vkCreateDevice", 1, "crash")).refused(&[told, "Use --engine cpu"]);
    assert_eq!([is_tried(), is_tried()], [true, false]);
    // Other variables of drivers may name another driver.
    let mut command = with("vkCreateDevice", 1, "crash");
    finish(command.env("VK_LOADER_DRIVERS_SELECT", "*")).refused(&[told]);
}

/// A driver that ends the process leaves no time for a message. The checkpoint remains, and the next command names the
/// option to continue.
#[test]
fn after_a_driver_has_ended_the_process_the_run_goes_on_from_its_checkpoint() {
    let folder = small();
    let line = "in out --tolerance 0 --max-sweeps 40 --checkpoint c --checkpoint-every 1e-9";
    let mut command = folder.command();
    with_fault(&mut command, "vkQueueSubmit", 14, "crash");
    let ended = command.args(format!("{line} --engine gpu").split(' ')).output().unwrap();
    assert_eq!(ended.status.signal(), Some(6), "{ended:?}");
    assert!(!folder.path("out.node").exists());
    folder.line(line).refused(&["--continue c (with --engine cpu as well, if the driver of a GPU"]);
    let line = "in out --tolerance 0 --max-sweeps 40 --continue c --engine cpu --report r.json";
    folder.line(line).clean();
    assert!(folder.json("r.json")["continued_from"].as_u64().unwrap() > 0);
    assert_eq!(folder.json("r.json")["sweeps"], 40);
    assert_smoothed(&folder.mesh("in"), &folder.mesh("out"));
    // With an automatic choice of the engine, the crashing driver is never started in the run's own process.
    folder.line(
        "in out --tolerance 0 --max-sweeps 40 --time-limit 1e-9 --checkpoint c --engine gpu -q",
    );
    let mut command = folder.command();
    with_fault(&mut command, "vkCreateDevice", 1, "crash");
    let run = finish(command.args("in out --tolerance 0 --max-sweeps 40 --continue c".split(' ')));
    assert_holds(&run.clean().out, &["which cannot be opened: the driver of the GPU failed when"]);
}

#[test]
fn a_device_that_was_chosen_serves_all_meshes_of_a_command() {
    let [node, ele] = support::triangle_text(&support::lattice(200, 200), "");
    let files = ["a.node", "b.node", "c.node"].map(|name| (name, &*node));
    let elements = ["a.ele", "b.ele", "c.ele"].map(|name| (name, &*ele));
    let folder = Folder::new(&[files, elements].concat());
    let count = folder.path("count");
    fs::write(&count, "").unwrap();
    let mut command = folder.command();
    // The software driver says that it is a graphics card.
    with_fault(&mut command, "vkCreateDevice", usize::MAX >> 40, LOST);
    command.env("FAULT_KIND", "2").env("FAULT_COUNT", &count).env("RAYON_NUM_THREADS", "1");
    let words = "a.node b.node c.node --out-dir d --scheme edge --desired 1e6";
    let run = finish(command.args(words.split(' ')));
    assert_holds(&run.clean().out, &["3 smoothed of 3 meshes"]);
    assert_eq!(fs::read(&count).unwrap().len(), 1, "devices that were opened");
}
