//! The house rules that a compiler does not check.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn rust_files(directory: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// What each module of the library may use of the others: data flows one way.
const MAY_USE: &[(&str, &[&str])] = &[
    ("dual", &[]),
    ("metric", &["dual"]),
    ("scheme", &["metric"]),
    ("plan", &["metric", "scheme"]),
    ("error", &["gpu"]),
    ("options", &["error", "metric", "plan", "scheme"]),
    ("mesh", &["error"]),
    ("validity", &["error", "topology", "mesh"]),
    ("clamp", &["error", "metric", "topology", "validity"]),
    ("groups", &[]),
    ("stars", &["groups"]),
    ("topology", &["error", "groups", "mesh", "stars", "validity"]),
    ("boundary", &["topology"]),
    ("curve", &["groups", "mesh", "topology"]),
    ("coloring", &["groups", "topology", "mesh"]),
    ("problem", &["coloring", "curve", "groups", "mesh", "topology"]),
    ("engine", &["gpu", "metric", "plan"]),
    ("multilevel", &["engine", "gpu", "metric", "plan", "problem"]),
    (
        "cpu",
        &["dual", "engine", "gpu", "mesh", "metric", "multilevel", "plan", "prepare", "problem"],
    ),
    ("opening", &["cpu", "engine", "metric", "plan", "problem"]),
    ("prepare", &["coloring", "curve", "error", "mesh", "problem", "topology"]),
    (
        "gpu",
        &[
            "engine",
            "error",
            "mesh",
            "metric",
            "multilevel",
            "options",
            "plan",
            "prepare",
            "problem",
        ],
    ),
    ("quality", &["metric", "topology", "validity", "mesh"]),
    (
        "drive",
        &["cpu", "engine", "error", "gpu", "multilevel", "opening", "options", "plan", "problem"],
    ),
    (
        "smoother",
        &[
            "cpu", "drive", "engine", "error", "gpu", "mesh", "metric", "options", "plan",
            "prepare", "problem", "quality", "scheme", "topology", "validity",
        ],
    ),
];

#[test]
fn data_flows_one_way() {
    let source = root().join("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    let mut checked = 0;
    for file in files {
        let relative = file.strip_prefix(&source).unwrap();
        let first = relative.components().next().unwrap().as_os_str().to_str().unwrap();
        let module = first.trim_end_matches(".rs");
        if module == "lib" || module == "bin" {
            continue;
        }
        let (_, allowed) = MAY_USE
            .iter()
            .find(|(name, _)| *name == module)
            .unwrap_or_else(|| panic!("{module} has no row in MAY_USE"));
        let text = fs::read_to_string(&file).unwrap();
        for used in text.split("crate::").skip(1) {
            let used: String =
                used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            // Names of types stand in links of the documentation, not in imports.
            let is_module = MAY_USE.iter().any(|(name, _)| *name == used);
            assert!(
                !is_module || used == module || allowed.contains(&used.as_str()),
                "{} may not use {used}",
                relative.display()
            );
            checked += usize::from(is_module);
        }
    }
    assert!(checked > 50, "only {checked} imports were found: the test looks in the wrong place");
}

#[test]
fn only_the_gpu_modules_name_wgpu() {
    let source = root().join("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    for file in files {
        let inside = file.strip_prefix(&source).unwrap();
        let text = fs::read_to_string(&file).unwrap();
        // The command's benchmark copies memory by a kernel of its own.
        let may = ["gpu", "lib.rs", "bin/gpu-smooth/bench"];
        if !may.iter().any(|place| inside.starts_with(place)) {
            assert!(!text.contains("wgpu::"), "{} names wgpu", inside.display());
        }
    }
}

#[test]
fn no_dependency_needs_a_newer_rust_than_the_package_promises() {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let version = |text: &str| {
        let mut parts = text.split('.').map(|part| part.parse::<u32>().unwrap());
        [(); 3].map(|()| parts.next().unwrap_or(0))
    };
    let packages = metadata["packages"].as_array().unwrap();
    let own = packages.iter().find(|p| p["name"] == "gpu-smooth").unwrap();
    let promised = version(own["rust_version"].as_str().unwrap());
    let mut told = 0;
    for package in packages {
        if let Some(needed) = package["rust_version"].as_str() {
            told += 1;
            assert!(version(needed) <= promised, "{} needs Rust {needed}", package["name"]);
        }
    }
    assert!(told > 20);
}
