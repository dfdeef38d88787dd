//! Wrong command lines: exit code 2, and no file touched.

use super::{Folder, assert_holds, small};

#[track_caller]
fn assert_usage(folder: &Folder, line: &str, parts: &[&str]) {
    let before = folder.content();
    let run = folder.line(line);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{line}\n{}", run.err);
    assert!(run.err.starts_with("error: ") && run.err.contains("--help"), "{}", run.err);
    assert_holds(&run.err, parts);
    assert!(folder.content() == before, "{line} has changed files");
}

#[test]
fn missing_and_surplus_arguments_are_errors() {
    let folder = small();
    assert_usage(&folder, "in", &["<OUT>"]);
    assert_usage(&folder, "in out extra", &["unexpected argument 'extra'", "one mesh per run"]);
    assert_usage(&folder, "quality", &["<MESH>"]);
    assert_usage(&folder, "metrics in", &["unexpected argument 'in'"]);
    assert_usage(&folder, "in out --nonsense", &["unexpected argument '--nonsense'"]);
}

#[test]
fn the_short_help_lists_usual_options_and_is_printed_without_arguments() {
    let folder = small();
    let [short, long] = ["-h", "--help"].map(|option| folder.line(option).clean().out);
    assert!(short.lines().count() < 80 && long.lines().count() > 150, "{short}");
    assert_holds(&short, &["gpu-smooth [OPTIONS] <IN> <OUT>", "--slide", "--picture", "--help"]);
    assert!(!short.contains("--levels") && !short.contains("Exit codes"), "{short}");
    assert_holds(&long, &["--checkpoint <FILE>", "Exit codes:", "--slide --fix airfoil"]);
    let none = folder.line("");
    assert_eq!((none.code, none.out.as_str()), (Some(2), ""));
    assert!(none.err.trim_end() == short.trim_end(), "{}", none.err);
}

/// A scheme of 61 metrics.
const SIXTY_ONE: &str = "--scheme imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr\
    +imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr\
    +imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr+imr";

#[test]
fn values_out_of_range_name_the_range() {
    let folder = small();
    let cases: [(&str, &[&str]); 31] = [
        ("--scheme foo", &["no metric is called 'foo'; there are edge, area, rms, imr, ar"]),
        ("--scheme edge+", &["no metric is called ''"]),
        (SIXTY_ONE, &["a scheme can have 60 metrics at most"]),
        ("--engine opencl", &["auto, gpu, cpu"]),
        ("--max-sweeps -1", &["'-1' for '--max-sweeps", "a whole number from 0 to 4294967295"]),
        ("--max-sweeps many", &["'many' for '--max-sweeps"]),
        ("--tolerance -1", &["'-1' for '--tolerance", "0 or above"]),
        ("--tolerance inf", &["0 or above"]),
        ("--tolerance little", &["not a number; it must be a finite number, 0 or above"]),
        ("--fraction 0", &["above 0 and at most 1"]),
        ("--fraction 95", &["above 0 and at most 1"]),
        ("--fraction nan", &["above 0 and at most 1"]),
        ("--fraction 95%", &["not a number; it must be above 0 and at most 1"]),
        ("--desired best", &["a finite number, or auto"]),
        ("--desired nan", &["a finite number, or auto"]),
        ("--omega 0", &["above 0 and below 2"]),
        ("--omega 2", &["above 0 and below 2"]),
        ("--omega -0.5", &["'-0.5' for '--omega", "above 0 and below 2"]),
        ("--inner 0", &["a whole number from 1 to 1000"]),
        ("--inner 1001", &["a whole number from 1 to 1000"]),
        ("--method other", &["relaxed, paper"]),
        ("--derivatives exact", &["analytic, finite-difference"]),
        ("--edge-norm 8", &["fixed, continued"]),
        ("--fix --engine", &["'--engine' for '--fix", "the name or the tag of a group is needed"]),
        ("--only -q", &["the name or the tag of a group is needed"]),
        ("--fix-box 0,0,1", &["'0,0,1' for '--fix-box", "four numbers with commas"]),
        ("--fix-box -1,0,1,inf", &["four numbers with commas"]),
        ("--only-bad 0.5", &["a number of at least 1"]),
        ("--only-bad -2", &["'-2' for '--only-bad", "a number of at least 1"]),
        ("--only-bad 2 --rings -1", &["'-1' for '--rings"]),
        ("--rings 1", &["--only-bad <Q>"]),
    ];
    for (option, parts) in cases {
        assert_usage(&folder, &format!("in out {option}"), parts);
    }
}

#[test]
fn contradictions_are_refused() {
    let folder = small();
    let cases = [
        ("--omega 1.5 --method paper", ["--omega", "--method paper"]),
        ("--quiet --verbose", ["--quiet", "--verbose"]),
        ("--engine cpu --adapter nvidia", ["--engine cpu", "--adapter"]),
        ("--tolerance 1e-3 --fraction 0.9", ["--tolerance", "--fraction"]),
        ("--tolerance 1e-3 --desired auto", ["--tolerance", "--desired"]),
    ];
    for (options, parts) in cases {
        assert_usage(&folder, &format!("in out {options}"), &parts);
    }
    assert_usage(&folder, "in out --history all", &["--report <FILE>"]);
}

/// Without this check, the library would refuse the options after reading and preparing a mesh, or ignore them.
#[test]
fn options_that_a_run_cannot_combine_are_refused_before_a_file_is_read() {
    let folder = Folder::new(&[]);
    for (options, told) in [
        (
            "--target keep-shape --target-of place --slide",
            "--target-of place does not go with --slide: targets of places change",
        ),
        (
            "--target keep-shape --target-of place --max-move 1",
            "--target-of place does not go with --max-move",
        ),
        (
            "--target keep-shape --target-of place --keep-altitude",
            "--target-of place does not go with --keep-altitude",
        ),
        (
            "--target keep-shape --target-of place --fraction 0.9",
            "--target-of place does not go with --fraction",
        ),
        (
            "--target keep-shape --target-of place --desired 1.1",
            "--target-of place does not go with --desired",
        ),
        (
            "--target keep-shape --target-of place --scheme edge",
            "--target-of place does not go with --scheme edge: targets of places need",
        ),
        ("--slide --derivatives finite-difference", "it needs analytic derivatives"),
        (
            "--keep-altitude --untangle",
            "--keep-altitude does not go with --untangle: inverted triangles",
        ),
        ("--max-move 1 --untangle", "--max-move does not go with --untangle: untangling moves"),
        ("--method multilevel --scheme area", "--method multilevel does not go with --scheme area"),
        (
            "--target keep-size --derivatives finite-difference",
            "--target does not go with --derivatives",
        ),
        ("--surface sphere --derivatives finite-difference", "--surface sphere does not go with"),
        ("--method multilevel --inner 2", "it is a setting of --method paper; drop"),
        ("--method relaxed --derivatives finite-difference", "it is a setting of --method paper"),
        ("--omega 1.2 --inner 2", "--inner does not go with --omega: each selects another method"),
    ] {
        // The mesh does not exist, so reading it would cause a different error.
        assert_usage(&folder, &format!("none out {options}"), &[told]);
    }
    let bench = "bench --engine cpu --adapter nvidia";
    assert_usage(
        &folder,
        bench,
        &["--adapter has no effect with --engine cpu", "gpu-smooth bench"],
    );
    assert_usage(&folder, "quality a b --picture p.png", &["p.png: --picture draws a single mesh"]);
    let arrows = "quality none --picture p.png --picture-arrows";
    assert_usage(&folder, arrows, &["--picture-arrows needs a run"]);
    assert_usage(&folder, "convert none - --to triangle", &["has several files", "name OUT"]);
}

#[test]
fn options_without_effect_are_refused() {
    let folder = small();
    let cases = [
        ("--checkpoint-every 10", "<--checkpoint <FILE>|--continue <FILE>>"),
        (
            "--target-rings 3",
            "--target-rings has no effect without --target keep-size or keep-shape",
        ),
        (
            "--target size=s.sol --target-rings 3",
            "--target-rings has no effect without --target keep-size or keep-shape",
        ),
        ("--target-of place", "--target-of has no effect without another --target"),
        ("--edge-norm fixed", "--edge-norm has no effect without edge in --scheme"),
        ("--scheme imr --target size=s.sol", "--target has no effect on imr"),
    ];
    for (options, told) in cases {
        assert_usage(&folder, &format!("in out {options}"), &[told]);
    }
    let told = "--surface sphere has no effect without a MESH";
    assert_usage(&folder, "bench --surface sphere", &[told]);
    assert_usage(&folder, "bench --z data", &["--z data has no effect without a MESH"]);
    let line = "in out --engine cpu --target keep-shape --target-rings 1 --report r.json";
    assert_eq!(folder.line(line).code, Some(0));
    assert_eq!(folder.json("r.json")["target"]["rings"], 1);
    folder.line("in out --engine cpu --target keep-size --report r.json").clean();
    assert_eq!(folder.json("r.json")["target"]["rings"], 0);
    folder.line("in out --engine cpu --surface sphere --report r.json").clean();
    assert!(folder.json("r.json")["target"].get("rings").is_none(), "none are averaged over");
}

#[test]
fn quiet_and_verbose_before_a_command_do_not_make_it_a_file() {
    let folder = small();
    let quality = folder.line("quality in").clean().out;
    for line in ["-q quality in", "quality -q in", "--verbose quality in", "quality in --quiet"] {
        assert_eq!(folder.line(line).clean().out, quality, "{line}");
    }
    let bench = "bench in --engine cpu --seconds 0";
    for line in [format!("--quiet {bench}"), format!("{bench} -v"), "-v adapters".into()] {
        assert_ne!(folder.line(&line).clean().out, "", "{line}");
    }
    assert_eq!(folder.line("-q metrics").clean().out, folder.line("metrics").clean().out);
    assert_usage(&folder, "-q quality", &["<MESH>"]);
}

#[test]
fn a_file_called_like_a_command_is_given_by_its_path() {
    let folder = small();
    for ending in ["node", "ele"] {
        let [from, to] = ["in", "quality"].map(|name| folder.path(&format!("{name}.{ending}")));
        std::fs::copy(from, to).unwrap();
    }
    folder.line("./quality ./bench -q --engine cpu").clean();
    folder.line("quality ./bench").clean();
    folder.line("quality quality").clean();
}

#[test]
fn arguments_of_a_run_before_a_command_are_refused() {
    let folder = small();
    assert_usage(&folder, "--engine cpu bench", &["'--engine' stands before the command 'bench'"]);
    assert_usage(&folder, "--report r.json quality in", &["'--report'", "'quality'", "after it"]);
    assert_usage(&folder, "in metrics", &["'metrics' is a command", "./metrics"]);
    assert_usage(&folder, "in quality", &["<MESH>", "gpu-smooth quality"]);
    assert_usage(&folder, "in quality out", &["'quality' is a command", "./quality"]);
}

#[test]
fn help_and_version_go_to_standard_output() {
    let folder = Folder::new(&[]);
    for (line, parts) in [
        ("--help", ["Usage: gpu-smooth", "--scheme"]),
        ("-h", ["edge+imr", "quality"]),
        ("quality --help", ["Usage: gpu-smooth quality", "--json"]),
        ("--version", ["gpu-smooth ", env!("CARGO_PKG_VERSION")]),
    ] {
        assert_holds(&folder.line(line).clean().out, &parts);
    }
}

/// Runs the program with random words. The program must end with a documented exit code, must not panic, and must
/// leave no unexpected file. The environment variable FUZZ_ROUNDS multiplies the number of runs.
#[test]
fn command_lines_of_any_words_neither_panic_nor_damage_files() {
    const WORDS: [&str; 62] = [
        "in",
        "in.node",
        "in.ele",
        "out",
        "out.node",
        "out.msh",
        "out.vtk.gz",
        "none",
        "-",
        "",
        ".",
        "/",
        "é\u{301}\u{7f}",
        "quality",
        "groups",
        "compare",
        "convert",
        "metrics",
        "completions",
        "bash",
        "man",
        "--engine",
        "cpu",
        "gpu",
        "--scheme",
        "edge+imr",
        "imr+",
        "--max-sweeps",
        "3",
        "0",
        "-1",
        "1e400",
        "nan",
        "99999999999999999999",
        "--tolerance",
        "1e-3",
        "--fraction",
        "0.9",
        "--desired",
        "auto",
        "1.2",
        "--method",
        "paper",
        "--omega",
        "1.5",
        "--fix",
        "--fix-box",
        "0,0,1,1",
        "--only-bad",
        "2",
        "--report",
        "r.json",
        "--checkpoint",
        "c.ckpt",
        "--continue",
        "--time-limit",
        "-q",
        "-v",
        "--untangle",
        "--to",
        "su2",
        "--interpolate",
    ];
    let factor = std::env::var("FUZZ_ROUNDS").ok().and_then(|text| text.parse().ok());
    let mut random = support::SplitMix64::new(21);
    let folder = small();
    let kept = ["in.node", "in.ele"].map(|name| folder.text(name));
    let mut codes = std::collections::BTreeSet::new();
    for _ in 0..60 * factor.unwrap_or(1) {
        let mut words = Vec::new();
        // Half of the command lines begin with valid words.
        if random.below(2) == 0 {
            words.extend(["in", "out", "--engine", "cpu", "--max-sweeps", "3"]);
        }
        words.extend((0..random.below(6)).map(|_| WORDS[random.below(WORDS.len())]));
        let run = folder.run(&words);
        let code = run.code.unwrap_or(-1);
        assert!((0..=5).contains(&code), "{words:?}: {code}\n{}", run.err);
        assert!(!run.err.contains("panicked"), "{words:?}\n{}", run.err);
        assert!(code == 0 || !run.err.is_empty(), "{words:?}: nothing is told");
        codes.insert(code);
        for (path, _) in folder.content() {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            assert!(!name.ends_with(".tmp"), "{words:?} leaves {name}");
            if ["in.node", "in.ele"].contains(&&*name) {
                continue;
            }
            if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) }
                .unwrap();
        }
        // The input may change only if it is also named as OUT.
        if words.iter().filter(|word| word.starts_with("in")).count() < 2 {
            assert!(kept == ["in.node", "in.ele"].map(|name| folder.text(name)), "{words:?}");
        }
        for (name, text) in ["in.node", "in.ele"].iter().zip(&kept) {
            std::fs::write(folder.path(name), text).unwrap();
        }
    }
    assert_eq!(codes.len(), 3);
}

#[test]
fn usual_mistakes_in_a_command_line_have_their_remedies() {
    let folder = Folder::new(&[]);
    for (line, remedy) in [
        ("smooth a.node b.node", "'smooth' is no command: write gpu-smooth a.node b.node"),
        ("a.node b.node --improve-worst min-angle", "write --improve-worst=min-angle"),
        ("a.node b.node c.node", "give one mesh per run, or --out-dir DIR for several meshes"),
    ] {
        let run = folder.line(line);
        assert_eq!(run.code, Some(2), "{line}");
        assert_holds(&run.err, &[remedy]);
    }
}
