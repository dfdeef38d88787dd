//! Which adapter a run takes, and what happens without one.

use super::{Folder, Run, assert_holds, small};

#[test]
fn the_adapter_listed_first_is_taken_and_found_by_name() {
    let folder = small();
    let list = folder.line("adapters").clean().out;
    folder.line("in out --engine gpu --report r.json").clean();
    let report = folder.json("r.json");
    let [name, driver] = ["adapter", "driver"].map(|key| report["engine"][key].as_str().unwrap());
    assert!(list.starts_with(name) && list.contains(driver), "{name}, {driver} not in:\n{list}");
    let first = list.lines().next().unwrap();
    assert!(first.ends_with(": arithmetic checked"), "{first}");

    let part: String = name.chars().take(4).collect();
    for part in [part.to_uppercase(), part.to_lowercase()] {
        let engines = ["gpu", "auto"];
        for engine in engines {
            let args = ["in", "out", "--engine", engine, "--adapter", &part, "--report", "r.json"];
            folder.run(args).clean();
            assert_eq!(folder.json("r.json")["engine"]["adapter"], name);
        }
    }
}

#[test]
fn an_unknown_adapter_is_answered_with_those_there_are() {
    let folder = small();
    let before = folder.content();
    folder.line("in there --report r.json").clean();
    let report = folder.json("r.json");
    let name = report["engine"]["adapter"].as_str().unwrap();
    for file in ["there.node", "there.ele", "r.json"] {
        std::fs::remove_file(folder.path(file)).unwrap();
    }
    for engine in ["auto", "gpu"] {
        let run = folder.line(&format!("in out --engine {engine} --adapter nonsense"));
        run.refused(&["no GPU adapter has 'nonsense' in its name. There are: ", name]);
    }
    assert!(folder.content() == before);
}

/// Hides every driver from the loaders of Vulkan and of OpenGL.
#[cfg(target_os = "linux")]
fn without_drivers(folder: &Folder, line: &str) -> Run {
    let mut command = folder.command();
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "__EGL_VENDOR_LIBRARY_FILENAMES"] {
        command.env(variable, "/nonexistent");
    }
    for variable in ["VK_ADD_DRIVER_FILES", "__EGL_VENDOR_LIBRARY_DIRS"] {
        command.env_remove(variable);
    }
    super::finish(command.args(line.split(' ')))
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

#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_the_cpu_does_it_and_says_so() {
    let folder = small();
    folder.line("in cpu --engine cpu").clean();
    for options in ["", " --engine auto"] {
        let run = without_drivers(&folder, &format!("in out{options} --report r.json"));
        assert_eq!(run.code, Some(0));
        assert_eq!(run.err, "gpu-smooth: no GPU adapter was found: smoothing on the CPU\n");
        assert_eq!(folder.json("r.json")["engine"]["kind"], "cpu");
        assert_eq!(folder.text("out.node"), folder.text("cpu.node"));
    }
    assert_eq!(without_drivers(&folder, "in out -q").clean().out, "");
    // What is wrong with the file comes alone.
    without_drivers(&folder, "none out").refused(&["none: "]);
}
