//! Rules of this project that a compiler does not check.

use std::collections::{BTreeMap, BTreeSet};
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

/// The files of the library by module path.
fn modules() -> BTreeMap<String, String> {
    modules_in(&root().join("src"))
}

/// The files of a crate by module path.
fn modules_in(source: &Path) -> BTreeMap<String, String> {
    let mut files = Vec::new();
    rust_files(source, &mut files);
    let mut modules = BTreeMap::new();
    for file in files {
        let relative = file.strip_prefix(source).unwrap().with_extension("");
        let parts: Vec<_> = relative.iter().map(|part| part.to_str().unwrap()).collect();
        modules.insert(parts.join("::"), fs::read_to_string(&file).unwrap());
    }
    modules
}

/// The paths that a file imports from this crate, one for each name in a group in braces. Tests inside a file are left out.
fn imports(text: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]").next().unwrap();
    let code: String = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .flat_map(|line| [line, "\n"])
        .collect();
    let mut found = Vec::new();
    for used in code.split("crate::").skip(1) {
        let end = used.find(|c: char| !(c.is_alphanumeric() || "_:".contains(c)));
        let path = &used[..end.unwrap_or(used.len())];
        match used[path.len()..].strip_prefix('{') {
            // `path` is empty, or ends in two colons.
            Some(names) => {
                let names = &names[..names.find('}').unwrap()];
                let names = names.split(',').map(str::trim).filter(|name| !name.is_empty());
                found.extend(names.map(|name| format!("{path}{name}")));
            }
            None => found.push(path.to_owned()),
        }
    }
    found
}

/// The file that defines what a path names. Follows names that `mod.rs` files re-export.
fn defined_in(path: &str, modules: &BTreeMap<String, String>) -> Option<String> {
    let parts: Vec<&str> = path.split("::").collect();
    for length in (1..=parts.len()).rev() {
        let module = parts[..length].join("::");
        if modules.contains_key(&module) {
            return Some(module);
        }
        let Some(text) = modules.get(&format!("{module}::mod")) else { continue };
        let name = parts.get(length)?;
        // `pub use file::{A, B};` or `pub(crate) use file::A;`
        for passed_on in text.split("use ").skip(1) {
            let passed_on = &passed_on[..passed_on.find(';').unwrap_or(0)];
            let words = passed_on.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            if let Some(from) = words.clone().next()
                && words.skip(1).any(|word| word == *name)
            {
                let from = if from == "crate" {
                    passed_on.trim_start_matches("crate::").to_owned()
                } else {
                    format!("{module}::{from}")
                };
                return defined_in(&format!("{from}::{name}"), modules);
            }
        }
        return None;
    }
    None
}

type Uses = BTreeMap<String, BTreeSet<String>>;

/// The files of the library that each file of the library uses.
fn uses() -> Uses {
    uses_of(&modules())
}

/// The files among `modules` that each of them uses.
fn uses_of(modules: &BTreeMap<String, String>) -> Uses {
    let mut uses = Uses::new();
    for (module, text) in modules {
        if module.ends_with("::mod") || module == "lib" {
            continue;
        }
        let used = imports(text).into_iter().filter_map(|path| defined_in(&path, modules));
        uses.insert(module.clone(), used.filter(|used| used != module).collect());
    }
    uses
}

/// Finds a cycle of files that use each other.
fn circle(uses: &Uses) -> Option<Vec<String>> {
    fn visit(at: &str, uses: &Uses, path: &mut Vec<String>, done: &mut BTreeSet<String>) -> bool {
        if let Some(start) = path.iter().position(|on_path| on_path == at) {
            path.drain(..start);
            return true;
        }
        if !done.insert(at.to_owned()) {
            return false;
        }
        path.push(at.to_owned());
        if uses.get(at).into_iter().flatten().any(|used| visit(used, uses, path, done)) {
            return true;
        }
        path.pop();
        false
    }
    let (mut path, mut done) = (Vec::new(), BTreeSet::new());
    uses.keys().any(|module| visit(module, uses, &mut path, &mut done)).then_some(path)
}

/// Merges the files of a folder, up to `depth` folders deep. A file of the root counts as a folder.
fn by_folder(uses: &Uses, depth: usize) -> Uses {
    let folder = |module: &str| {
        let parts: Vec<&str> = module.split("::").collect();
        parts[..depth.min((parts.len() - 1).max(1))].join("::")
    };
    let mut folders = Uses::new();
    for (module, used) in uses {
        let own = folder(module);
        let others = used.iter().map(|used| folder(used)).filter(|used| *used != own);
        folders.entry(own.clone()).or_default().extend(others);
    }
    folders
}

#[test]
fn files_do_not_use_each_other_in_a_circle() {
    let uses = uses();
    let count: usize = uses.values().map(BTreeSet::len).sum();
    assert!(count > 200, "only {count} imports were found: the test looks in the wrong place");
    assert_eq!(circle(&uses), None);
}

#[test]
fn folders_do_not_use_each_other_in_a_circle() {
    let uses = uses();
    for depth in [1, 2] {
        assert_eq!(circle(&by_folder(&uses, depth)), None, "{depth} folders deep");
    }
}

#[test]
fn files_of_the_other_crates_do_not_use_each_other_in_a_circle() {
    for (source, least) in [("cli/src", 100), ("mesh-io/src", 200)] {
        let modules = modules_in(&root().join(source));
        let uses = uses_of(&modules);
        let count: usize = uses.values().map(BTreeSet::len).sum();
        assert!(
            count > least,
            "only {count} imports were found: the test looks in the wrong place"
        );
        assert_eq!(circle(&uses), None, "{source}");
        assert_eq!(circle(&by_folder(&uses, 1)), None, "{source}");
    }
}

#[test]
fn a_circle_is_found() {
    let uses = |pairs: &[(&str, &str)]| {
        let mut uses = Uses::new();
        for (from, to) in pairs {
            uses.entry((*from).into()).or_default().insert((*to).into());
        }
        uses
    };
    assert_eq!(circle(&uses(&[("a", "b"), ("a", "c"), ("b", "c")])), None);
    let found = circle(&uses(&[("a", "b"), ("b", "c::d"), ("c::d", "b")]));
    assert_eq!(found, Some(vec!["b".into(), "c::d".into()]));
    let files = uses(&[("x::a", "y::b"), ("y::c", "x::d")]);
    assert_eq!(circle(&files), None);
    assert!(circle(&by_folder(&files, 1)).is_some());
    let found =
        imports("use crate::{a::B, c};\nuse crate::d::E;\n// crate::f\nlet x = crate::g::h(1);");
    assert_eq!(found, ["a::B", "c", "d::E", "g::h"]);
}

/// Checks which folders use no other folder, and which folders others may not use.
#[test]
fn data_flows_one_way() {
    let folders = by_folder(&uses(), 1);
    let used_by = |folder: &str| folders[folder].iter().map(String::as_str).collect::<Vec<_>>();
    assert!(used_by("mesh").is_empty());
    assert!(used_by("error").is_empty());
    assert!(used_by("metric").is_empty());
    for lower in ["topology", "layout", "measure", "run", "slide"] {
        for upper in ["cpu", "gpu", "smoother"] {
            assert!(!used_by(lower).contains(&upper), "{lower}/ may not use {upper}/");
        }
    }
    assert!(!used_by("cpu").contains(&"gpu") && !used_by("gpu").contains(&"cpu"));
}

#[test]
fn only_the_gpu_modules_name_wgpu() {
    let source = root().join("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    for file in files {
        let inside = file.strip_prefix(&source).unwrap();
        let text = fs::read_to_string(&file).unwrap();
        let may = ["gpu", "lib.rs"];
        if !may.iter().any(|place| inside.starts_with(place)) {
            assert!(!text.contains("wgpu::"), "{} names wgpu", inside.display());
        }
    }
}

/// The clock of the standard library compiles for browsers, but panics there.
#[test]
fn only_the_command_asks_the_clock_of_the_standard_library() {
    let clocks = |text: &str| {
        let imports = text.split("std::time::").skip(1);
        let named = imports.filter_map(|named| named.split(';').next());
        named.filter(|named| named.contains("Instant") || named.contains("SystemTime")).count()
    };
    assert_eq!(clocks("use std::time::{Duration, Instant};"), 1);
    assert_eq!(clocks("use std::time::Duration;\nuse web_time::Instant;"), 0);
    for (module, text) in modules() {
        let code = text.split("#[cfg(test)]").next().unwrap();
        assert_eq!(clocks(code), 0, "{module} asks the clock of the standard library");
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
