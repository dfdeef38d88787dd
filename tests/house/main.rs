//! Rules of this project that the compiler does not check.

mod api;
mod dependencies;
mod documents;

use dependencies::{Uses, by_folder, circles};
use gpu_smooth::Metric;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Returns the text of a file of the repository.
fn text_of(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap().replace("\r\n", "\n")
}

/// Returns the text of a file of the repository as one line, without the marks of comments.
fn one_line(path: &str) -> String {
    let text = text_of(path);
    let words = text.split_whitespace().filter(|word| !["//!", "///", "//", "#"].contains(word));
    words.collect::<Vec<_>>().join(" ")
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

/// Source folders of the crates.
const CRATES: [&str; 5] = ["src", "mesh-io/src", "job/src", "cli/src", "python/src"];

/// Each crate for users, by its name and source folder.
const PUBLIC_CRATES: [(&str, &str); 3] =
    [("gpu-smooth", "src"), ("gpu-smooth-job", "job/src"), ("mesh-io", "mesh-io/src")];

/// A crate by its sources.
struct Crate {
    /// The files that each file uses.
    uses: Uses,
    /// The public items, of the crates for users alone.
    public_items: Vec<String>,
}

/// Returns a crate by its source folder. All tests share the crates, as parsing the sources takes most of their time.
fn crate_of(source: &str) -> &'static Crate {
    static CRATES_PARSED: OnceLock<BTreeMap<&str, Crate>> = OnceLock::new();
    let all = CRATES_PARSED.get_or_init(|| {
        let of_folder = |source: &'static str| {
            let parsed = dependencies::parsed(&root().join(source));
            let is_for_users = PUBLIC_CRATES.iter().any(|(_, folder)| *folder == source);
            let public_items = if is_for_users { api::public_items(&parsed) } else { Vec::new() };
            (source, Crate { uses: dependencies::uses_of(&parsed), public_items })
        };
        CRATES.map(of_folder).into()
    });
    &all[source]
}

/// Returns the uses of all files of a crate.
fn uses_of(source: &str) -> &'static Uses {
    let uses = &crate_of(source).uses;
    let count: usize = uses.values().map(BTreeSet::len).sum();
    let least = match source {
        "job/src" => 5,
        "python/src" => 40,
        _ => 200,
    };
    assert!(count > least, "only {count} uses in {source}: the test looks in the wrong place");
    uses
}

#[test]
fn all_uses_of_a_small_crate_are_found() {
    let used = &uses_of("job/src")["job"];
    let expected = ["domain", "error", "plane", "precision"].map(String::from);
    assert!(expected.iter().all(|name| used.contains(name)), "{used:?}");
}

#[test]
fn files_do_not_use_each_other_in_a_circle() {
    for source in CRATES {
        assert_eq!(circles(uses_of(source)), [[""; 0]; 0], "{source}");
    }
}

#[test]
fn folders_do_not_use_each_other_in_a_circle() {
    for source in CRATES {
        let uses = uses_of(source);
        for depth in [1, 2] {
            let is_of_folders = |circle: &Vec<String>| !circles(uses).contains(circle);
            let mut found = circles(&by_folder(uses, depth));
            found.retain(is_of_folders);
            assert_eq!(found, [[""; 0]; 0], "{source}, {depth} deep");
        }
    }
}

/// Reads the floors of a crate from ARCHITECTURE.md. In a block that begins with the crate's folder, each line contains
/// the folders and files of a floor, the lowest floor first.
fn floors(source: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let block = text.split(&format!("```text\n{source}\n")).nth(1);
    let block = block.unwrap_or_else(|| panic!("ARCHITECTURE.md has no floors of {source}"));
    let lines = block.split("```").next().unwrap().lines();
    lines.map(|line| line.split_whitespace().map(str::to_owned).collect()).collect()
}

/// Returns the uses that do not point from a floor to a lower floor.
fn uses_against_the_order(folders: &Uses, floors: &[Vec<String>]) -> Vec<String> {
    let floor = |name: &str| floors.iter().position(|floor| floor.iter().any(|own| own == name));
    let mut against = Vec::new();
    for (folder, used) in folders {
        let Some(own) = floor(folder) else {
            against.push(format!("{folder} is on no floor"));
            continue;
        };
        let not_below = used.iter().filter(|used| floor(used).is_none_or(|floor| floor >= own));
        against.extend(not_below.map(|used| format!("{folder} uses {used}")));
    }
    against
}

#[test]
fn folders_use_folders_of_lower_floors_alone() {
    for source in CRATES {
        let against = uses_against_the_order(&by_folder(uses_of(source), 1), &floors(source));
        assert_eq!(against, [""; 0], "{source}");
    }
}

/// Behind the requests, options are typed and free of contradictions.
#[test]
fn only_requests_and_commands_name_the_arguments_of_the_command_line() {
    let uses = by_folder(uses_of("cli/src"), 1);
    let naming = uses.iter().filter(|(_, used)| used.contains("args"));
    let naming: Vec<&str> = naming.map(|(folder, _)| folder.as_str()).collect();
    assert_eq!(naming, ["commands", "lib", "request"]);
}

/// Parses files given by their paths and texts.
fn parsed_texts(files: &[(&str, &str)]) -> dependencies::Parsed {
    let texts = files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
    dependencies::parsed_texts(&texts.collect())
}

#[test]
fn every_kind_of_use_and_of_circle_is_found() {
    let uses = dependencies::uses_of(&parsed_texts(&[
        ("lib", "mod a; mod b; pub use b::Deep;"),
        ("a", "use crate::b::{Deep, own}; #[cfg(test)] mod tests { use crate::d::D; }"),
        ("b/mod", "mod deep; mod other; pub(crate) use deep::Deep; pub(crate) fn own() {}"),
        ("b/deep", "pub struct Deep; fn f() { super::other::g(); }"),
        ("b/other", "use super::own; fn g() -> String { format!(\"{}\", crate::c::h()) }"),
        ("c", "use crate::d; fn h() { d::D::new(); }"),
        ("d", "pub struct D; impl D { fn new(_: super::a::A) {} }"),
        ("e", "pub struct E; impl E { fn f(&self) { self.g(); } }"),
        (
            "f",
            "use crate::e::E; impl E { fn g(&self) {} } impl Drop for E { fn drop(&mut self) {} }",
        ),
        ("g", "use crate::e::E as Other; impl Other { fn h() { Self::g(); self::i(); } }"),
    ]));
    let used = |file: &str| uses[file].iter().map(String::as_str).collect::<Vec<_>>();
    assert_eq!(used("lib"), [""; 0], "a re-export is no use");
    assert_eq!(used("a"), ["b/deep", "b/mod"], "a re-export is followed, tests are left out");
    assert_eq!(used("b/deep"), ["b/other"]);
    assert_eq!(used("b/other"), ["b/mod", "c"], "`super::` and paths in macros are uses");
    assert_eq!(used("c"), ["d"]);
    assert_eq!(used("d"), ["a"]);
    assert_eq!(used("e"), ["f"], "a method of the same type in another file is a use");
    assert_eq!(used("g"), ["e", "f"]);
    let of_methods = vec!["e", "f"];
    assert_eq!(circles(&uses), [vec!["a", "b/deep", "b/other", "c", "d"], of_methods.clone()]);
    assert_eq!(circles(&by_folder(&uses, 1)), [vec!["a", "b", "c", "d"], of_methods]);
    let floors = [vec!["d".to_owned()], vec!["c".into(), "lib".into()], vec!["b".into()]];
    let folders =
        by_folder(&uses, 1).into_iter().filter(|(name, _)| !["e", "f", "g"].contains(&&name[..]));
    let against = uses_against_the_order(&folders.collect(), &floors);
    assert_eq!(against, ["a is on no floor", "d uses a"]);
}

/// Functions with a tuple pattern in their signature. Each tuple is a unit, such as a number paired with its file
/// offset.
const TAKES_A_TUPLE_APART: [&str; 1] = ["mesh-io/src/visit/z_values.rs: push"];

/// A tuple of unrelated values hides the meaning of each value from callers; a struct names them.
#[test]
fn no_function_takes_a_tuple_apart_in_its_signature() {
    struct Functions(Vec<String>);

    impl Functions {
        fn check(&mut self, signature: &syn::Signature) {
            let is_tuple = |input: &syn::FnArg| match input {
                syn::FnArg::Typed(typed) => matches!(*typed.pat, syn::Pat::Tuple(_)),
                syn::FnArg::Receiver(_) => false,
            };
            if signature.inputs.iter().any(is_tuple) {
                self.0.push(signature.ident.to_string());
            }
        }
    }

    impl<'ast> syn::visit::Visit<'ast> for Functions {
        fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
            if item.ident != "tests" {
                syn::visit::visit_item_mod(self, item);
            }
        }

        fn visit_signature(&mut self, signature: &'ast syn::Signature) {
            self.check(signature);
            syn::visit::visit_signature(self, signature);
        }
    }

    let mut found = Vec::new();
    let mut count = 0;
    for source in CRATES {
        let mut files = Vec::new();
        rust_files(&root().join(source), &mut files);
        files.sort();
        for path in files {
            let name = path.strip_prefix(root()).unwrap().display();
            if name.to_string().contains("tests") {
                continue;
            }
            count += 1;
            let parsed = syn::parse_file(&fs::read_to_string(&path).unwrap()).unwrap();
            let mut functions = Functions(Vec::new());
            syn::visit::Visit::visit_file(&mut functions, &parsed);
            found.extend(functions.0.into_iter().map(|function| format!("{name}: {function}")));
        }
    }
    assert!(count > 300, "only {count} files: the test looks in the wrong place");
    assert_eq!(found, TAKES_A_TUPLE_APART);
}

/// Files with a line search for the step of a vertex, each with its rule.
const SEARCHES: [(&str, &str); 5] = [
    ("cpu/newton.rs", "SWEEP"),
    ("gpu/kernels/source.rs", "SWEEP"),
    ("slide/newton.rs", "CURVE"),
    ("untangle/patches.rs", "UNTANGLE"),
    ("worst/region.rs", "WORST"),
];

/// All search rules must be defined side by side in `src/patch/search_rule.rs`.
#[test]
fn every_search_for_the_step_of_a_vertex_takes_the_constants_of_its_rule() {
    let source = root().join("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    files.sort();
    let mut found = Vec::new();
    for file in files {
        let inside = file.strip_prefix(&source).unwrap().to_string_lossy().into_owned();
        // The searches along a correction and along a Newton step of the whole mesh move all vertices at once.
        let of_all = ["run/multilevel/search.rs", "run/truncated/search.rs", "untangle/newton.rs"];
        if inside.starts_with("patch/") || of_all.contains(&inside.as_str()) {
            continue;
        }
        let text = fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        for name in ["TRIALS", "SHORTEN", "SUFFICIENT_DECREASE", "SLACK"] {
            assert!(!code.contains(&format!("const {name}:")), "{inside} has its own {name}");
        }
        let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        let rules = lines.flat_map(|line| line.split("SearchRule::").skip(1));
        let name = |text: &str| {
            let end = text.find(|c: char| !c.is_ascii_uppercase()).unwrap_or(text.len());
            text[..end].to_owned()
        };
        let rules: BTreeSet<String> = rules.map(name).collect();
        found.extend(rules.into_iter().map(|rule| (inside.clone(), rule)));
    }
    let found: Vec<_> = found.iter().map(|(file, rule)| (&file[..], &rule[..])).collect();
    assert_eq!(found, SEARCHES);
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

/// The command line and Python add advice in their own words: a program in Rust has no options such as `--engine`.
#[test]
fn no_message_of_the_library_names_an_option_of_the_command_line() {
    let mut files = Vec::new();
    ["src", "job/src"].iter().for_each(|source| rust_files(&root().join(source), &mut files));
    assert!(files.len() > 100, "only {} files: the test looks in the wrong place", files.len());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        for line in code.lines().filter(|line| !line.trim_start().starts_with("//")) {
            let mut ends = line.split("--").skip(1);
            let is_option = ends.any(|end| end.starts_with(|c: char| c.is_ascii_lowercase()));
            assert!(!is_option, "{}: {line}", file.display());
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
    for source in ["src", "mesh-io/src"] {
        let mut files = Vec::new();
        rust_files(&root().join(source), &mut files);
        // The age of a file is read only for files, which browsers do not have.
        files.retain(|file| !file.ends_with("disk/stamp.rs"));
        for file in files {
            let text = fs::read_to_string(&file).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap();
            assert_eq!(
                clocks(code),
                0,
                "{} asks the clock of the standard library",
                file.display()
            );
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

/// A list of metrics in a comment lacks each new metric. A property of `Metric` holds for all metrics.
#[test]
fn the_documentation_of_a_mesh_on_a_device_lists_no_metrics() {
    let text = text_of("src/gpu/embed/mesh.rs");
    let before = text.split("pub struct DeviceMesh").next().unwrap();
    let comment = before.rsplit("\n\n").next().unwrap();
    assert!(comment.contains("Metric::is_scale_invariant"), "{comment}");
    let words: Vec<&str> = comment.split(|c: char| !c.is_alphanumeric() && c != '-').collect();
    for metric in Metric::ALL {
        let name = metric.name().to_uppercase();
        assert!(!words.contains(&name.as_str()), "{name} is in: {comment}");
    }
}

/// Returns the dependencies in a manifest, as pairs of name and requirement.
fn dependencies_in(manifest: &str) -> BTreeMap<String, String> {
    let text = text_of(manifest);
    let lines = text.lines().skip_while(|line| *line != "[dependencies]").skip(1);
    let lines = lines.take_while(|line| !line.starts_with('['));
    let pairs = lines.filter_map(|line| line.split_once(" = "));
    pairs.map(|(name, requirement)| (name.to_owned(), requirement.to_owned())).collect()
}

/// The fuzz target `arguments` is built from the sources of the command line, in a workspace that no other check builds.
#[test]
fn the_fuzz_targets_have_the_dependencies_of_the_command_line() {
    let of_targets = dependencies_in("fuzz/Cargo.toml");
    let of_program = dependencies_in("cli/Cargo.toml");
    assert!(of_program.len() > 15, "{of_program:?}");
    for (name, requirement) in of_program {
        let found = of_targets.get(&name);
        let is_equal = requirement.contains("path = ") || found == Some(&requirement);
        assert!(found.is_some() && is_equal, "fuzz/Cargo.toml needs {name} = {requirement}");
    }
}

#[test]
fn the_number_of_sweeps_of_most_meshes_is_the_same_in_the_readme_and_in_the_guide() {
    let guide = text_of("docs/guide.md");
    let row = guide.lines().find(|line| line.starts_with("| most meshes, of any size |")).unwrap();
    let count = row.split('|').nth(2).unwrap().trim();
    let sentence = format!("within 1e-6 of its limit after {count} sweeps");
    assert!(one_line("README.md").contains(&sentence), "README.md lacks: {sentence}");
    // Comments refer to the guide instead.
    let comments = one_line("src/options/method.rs");
    let words: Vec<&str> = comments.split(' ').collect();
    let counts = words.windows(2).filter(|pair| pair[0].parse::<u32>().is_ok());
    let counts: Vec<_> = counts.filter(|pair| pair[1].starts_with("sweeps")).collect();
    assert!(counts.is_empty(), "src/options/method.rs counts sweeps: {counts:?}");
}

#[test]
fn the_document_on_browsers_says_whether_the_module_reads_files() {
    let has_readers = dependencies_in("examples/browser/Cargo.toml").contains_key("mesh-io");
    let text = one_line("docs/embedding.md");
    assert_eq!(text.contains("The module contains no readers of files"), !has_readers);
    assert_eq!(text.contains("readers of files included"), has_readers);
}

/// Elsewhere, executors look at timers and sockets between polls. In a browser, microtasks run before the page draws.
#[test]
fn the_document_on_embedding_says_that_the_pauses_of_runs_do_not_free_a_page() {
    let text = one_line("docs/embedding.md");
    for part in [
        "`Backend::Cpu` has the same pauses, which do not help in a [browser]",
        "block the page. The pauses of an awaited run do not free the page:",
    ] {
        assert!(text.contains(part), "docs/embedding.md lacks: {part}");
    }
}

#[test]
fn documents_name_the_files_that_write_several_formats() {
    let folder = root().join("mesh-io/src/formats");
    let names = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut shared: Vec<String> = names.map(|name| name.into_string().unwrap()).collect();
    shared.retain(|name| name.starts_with("write"));
    assert!(!shared.is_empty(), "the test looks in the wrong place");
    let of_medit = fs::read_to_string(folder.join("medit/write.rs")).unwrap();
    if of_medit.contains("fn write_freefem(") {
        shared.push("medit/write.rs".to_owned());
    }
    for document in ["CONTRIBUTING.md", "docs/design.md"] {
        let text = text_of(document);
        for name in &shared {
            assert!(text.contains(&format!("`{name}`")), "{document} must name {name}");
        }
    }
}

/// A run ends at a local optimum. Descriptions must not promise the best shapes.
#[test]
fn every_description_of_the_smoother_promises_better_shapes() {
    for path in [
        "README.md",
        "Cargo.toml",
        "src/lib.rs",
        "python/pyproject.toml",
        "python/README.md",
        "python/gpu_smooth/__init__.py",
        "python/gpu_smooth/_smooth.py",
    ] {
        let text = one_line(path);
        let promise = text.split_once("the interior vertices of").map(|(_, rest)| rest);
        let promise = promise.and_then(|rest| rest.split('.').next());
        let is_better = promise.is_some_and(|words| words.contains("get better shapes"));
        assert!(is_better, "{path}: {promise:?}");
    }
}

/// `MeshFile::constraints` lacks the vertices between regions, which a `Job` keeps.
#[test]
fn examples_smooth_files_by_a_job() {
    let mut files = Vec::new();
    rust_files(&root().join("examples"), &mut files);
    let reads_files = |text: &String| text.contains("MeshFile::read");
    let texts = files.iter().map(|file| fs::read_to_string(file).unwrap());
    let texts: Vec<String> = texts.filter(reads_files).collect();
    assert!(!texts.is_empty(), "no example reads a file");
    for text in texts {
        assert!(text.contains("Job::of_file") && !text.contains(".constraints()"), "{text}");
    }
}
