//! Choice of an adapter by a run, and runs on machines without adapters.

use super::{Folder, Run, assert_holds, assert_smoothed, finish, small};
use std::process::Command;

#[test]
fn the_adapter_listed_first_is_taken_and_found_by_name() {
    let folder = small();
    let list = folder.line("adapters").clean().out;
    folder.line("in out --engine gpu --report r.json").clean();
    let report = folder.json("r.json");
    let [name, driver] = ["adapter", "driver"].map(|key| report["engine"][key].as_str().unwrap());
    assert!(list.starts_with(name) && list.contains(driver), "{name}, {driver} not in:\n{list}");
    let first = list.lines().next().unwrap();
    assert!(first.contains("; arithmetic checked"), "{first}");

    let part: String = name.chars().take(4).collect();
    for part in [part.to_uppercase(), part.to_lowercase()] {
        assert_eq!(folder.run(["adapters", &part]).clean().out.trim_end(), first);
        for engine in ["gpu", "auto"] {
            let args = ["in", "out", "--engine", engine, "--adapter", &part, "--report", "r.json"];
            folder.run(args).clean();
            assert_eq!(folder.json("r.json")["engine"]["adapter"], name);
        }
    }
}

#[test]
fn an_unknown_adapter_is_refused_with_a_list_of_those_there_are() {
    let folder = small();
    let before = folder.content();
    folder.line("in there --engine gpu --report r.json").clean();
    let report = folder.json("r.json");
    let name = report["engine"]["adapter"].as_str().unwrap();
    for file in ["there.node", "there.ele", "r.json"] {
        std::fs::remove_file(folder.path(file)).unwrap();
    }
    for engine in ["auto", "gpu"] {
        let run = folder.line(&format!("in out --engine {engine} --adapter nonsense"));
        run.refused(&["no GPU adapter has 'nonsense' in its name. There are: ", name]);
    }
    folder.line("adapters nonsense").refused(&["no GPU adapter has 'nonsense' in its name", name]);
    assert!(folder.content() == before);
}

/// Hides every driver from the loader of Vulkan.
#[cfg(target_os = "linux")]
fn hide_vulkan(command: &mut Command) -> &mut Command {
    command.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent");
    command.env_remove("VK_ADD_DRIVER_FILES")
}

/// Hides every driver from the loaders of Vulkan and of OpenGL.
#[cfg(target_os = "linux")]
fn hide_drivers(command: &mut Command) -> &mut Command {
    hide_vulkan(command).env("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent");
    command.env_remove("__EGL_VENDOR_LIBRARY_DIRS")
}

#[cfg(target_os = "linux")]
fn without_drivers(folder: &Folder, line: &str) -> Run {
    finish(hide_drivers(&mut folder.command()).args(line.split(' ')))
}

#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_the_gpu_engine_tells_what_to_install() {
    let folder = small();
    let before = folder.content();
    let install = ["no GPU adapter was found. Install a Vulkan driver", "--engine cpu"];
    for options in ["--engine gpu", "--engine gpu -q", "--adapter nonsense"] {
        let run = without_drivers(&folder, &format!("in out {options}")).refused(&install);
        assert!(!run.err.contains("nonsense"), "{}", run.err);
    }
    assert!(folder.content() == before);
    let list = without_drivers(&folder, "adapters").clean().out;
    assert_holds(&list, &install[..1]);
}

/// Without a Vulkan driver, a run uses OpenGL. `tests/run` installs an OpenGL driver.
#[cfg(target_os = "linux")]
#[test]
fn where_there_is_no_vulkan_a_driver_of_opengl_is_taken() {
    let folder = small();
    let list = finish(hide_vulkan(&mut folder.command()).arg("adapters")).clean().out;
    let first = list.lines().next().unwrap();
    assert_holds(first, &[", gl; ", "; arithmetic checked"]);
    let line = "in out --engine gpu --method relaxed --max-sweeps 12 --report r.json";
    finish(hide_vulkan(&mut folder.command()).args(line.split(' '))).clean();
    let engine = &folder.json("r.json")["engine"];
    assert_eq!(engine["kind"], "gpu");
    assert_holds(first, &[engine["driver"].as_str().unwrap()]);
    let on_opengl = folder.mesh("out");
    assert_smoothed(&folder.mesh("in"), &on_opengl);
    // The engines take equal sweeps, and end runs by different steps.
    folder.line("in out --engine cpu --method relaxed --max-sweeps 12").clean();
    for (a, b) in on_opengl.points.iter().zip(&folder.mesh("out").points) {
        // Edges are about 1 long, so this is a distance in edges.
        assert!(support::check::squared_distance(*a, *b) < 1e-4 * 1e-4, "{a:?}, {b:?}");
    }
}

#[test]
fn a_small_mesh_is_smoothed_on_the_cpu_and_the_summary_says_why() {
    let folder = small();
    folder.line("in cpu --engine cpu --report r.json").clean();
    assert!(folder.json("r.json")["engine"]["reason"].is_null());
    for options in ["", " --engine auto"] {
        let out = folder.line(&format!("in out{options} --report r.json")).clean().out;
        let engine = &folder.json("r.json")["engine"];
        let reason = engine["reason"].as_str().unwrap();
        assert_eq!(engine["kind"], "cpu");
        assert_holds(reason, &["; --engine gpu to force"]);
        assert_holds(&out, &[&format!("\nimr on cpu (all cores): {reason}\n")]);
        assert_eq!(folder.text("out.node"), folder.text("cpu.node"));
    }
    assert_eq!(folder.line("in out -q").clean().out, "");
    // An error in the file is the only message.
    folder.line("none out").refused(&["none: "]);
}

/// Returns a mesh and arguments for which a run on one core considers a GPU: the mesh is large, and the scheme needs
/// many sweeps. The goal is reached at the start, so the run itself is short.
fn large() -> (Folder, [&'static str; 6]) {
    let [node, ele] = support::triangle_text(&support::lattice(200, 200), "");
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    (folder, ["in", "out", "--scheme", "edge", "--desired", "1e6"])
}

#[test]
fn a_software_adapter_is_not_taken_unless_asked_for() {
    let (folder, args) = large();
    let adapters = folder.line("adapters").clean().out;
    let is_software = adapters.lines().next().unwrap().contains("(CPU: software, ");
    let run = finish(folder.command().args(args).env("RAYON_NUM_THREADS", "1"));
    let out = run.clean().out;
    // The adapter that the test machine uses by default, which may be a real GPU.
    let name = adapters.split(" (").next().unwrap();
    let told = match is_software {
        true => format!("edge on cpu (all cores): only a software adapter ({name}"),
        false => format!("edge on gpu ({name}"),
    };
    assert_holds(&out, &[&told]);
}

#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_the_cpu_does_a_large_mesh_and_says_so() {
    let (folder, args) = large();
    let run = finish(hide_drivers(folder.command().args(args)).env("RAYON_NUM_THREADS", "1"));
    assert_holds(&run.clean().out, &["\nedge on cpu (all cores): no GPU adapter was found\n"]);
}
