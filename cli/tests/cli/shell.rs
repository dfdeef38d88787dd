//! Completions, manual pages, and colors.

use super::{Folder, assert_holds, finish};
use gpu_smooth::{Metric, measure::Measure};
use std::fs;

/// Returns the names of all options that a help text mentions, sorted.
fn named(help: &str) -> Vec<String> {
    let words = help.split(|c: char| !(c.is_alphanumeric() || c == '-'));
    let mut names: Vec<String> =
        words.filter(|word| word.starts_with("--") && word.len() > 3).map(str::to_owned).collect();
    names.sort();
    names.dedup();
    names
}

/// Returns the completions of the last word, as the scripts of the shells ask for them.
fn offered(folder: &Folder, words: &[&str]) -> Vec<String> {
    let mut command = folder.command();
    command.arg("--").args(words);
    command.env("GPU_SMOOTH_COMPLETE", "bash").env("_CLAP_IFS", "\n");
    command.env("_CLAP_COMPLETE_INDEX", (words.len() - 1).to_string());
    command.env("_CLAP_COMPLETE_COMP_TYPE", "9").env("_CLAP_COMPLETE_SPACE", "true");
    let output = command.output().unwrap();
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn completions_and_manual_have_every_option() {
    let folder = Folder::new(&[("part.msh", ""), ("other.msh", "")]);
    let help = folder.line("--help").clean().out;
    let options = named(&help);
    assert!(options.len() > 35, "{options:?}");
    let words = offered(&folder, &["gpu-smooth", "part.msh", "out.msh", "--"]);
    // The help also mentions options of other commands, but never at the start of a line.
    let begins_line = |line: &str| {
        let mut words = line.split_whitespace().take(2).map(|word| word.trim_matches([',', ']']));
        let option = words.find(|word| word.starts_with("--"))?;
        option.split(['[', '=']).next().map(str::to_owned)
    };
    let of_lines: Vec<_> = help
        .lines()
        .filter(|line| line.trim_start().starts_with('-'))
        .filter_map(begins_line)
        .collect();
    assert!(of_lines.len() > 35, "{of_lines:?}");
    for option in &of_lines {
        assert!(words.contains(option), "{option} is not completed: {words:?}");
    }
    for command in ["quality", "groups", "compare", "convert", "bench"] {
        let options = named(&folder.line(&format!("{command} --help")).clean().out);
        let words = offered(&folder, &["gpu-smooth", command, "part.msh", "--"]);
        let own = options.iter().filter(|option| words.contains(option)).count();
        assert!(own >= 3, "{command}: {words:?}");
        assert!(offered(&folder, &["gpu-smooth", &command[..4]]).contains(&command.to_owned()));
        assert_eq!(offered(&folder, &["gpu-smooth", command, "oth"]), ["other.msh"], "{command}");
    }
    let metrics: Vec<_> = Metric::ALL.iter().map(|metric| metric.name()).collect();
    assert_eq!(offered(&folder, &["gpu-smooth", "part.msh", "out.msh", "--scheme", ""]), metrics);
    let measures = Measure::ALL.iter().map(|measure| measure.name());
    let words = offered(&folder, &["gpu-smooth", "quality", "--measure", ""]);
    assert!(measures.into_iter().all(|name| words.iter().any(|word| word == name)), "{words:?}");
    let engines = offered(&folder, &["gpu-smooth", "part.msh", "out.msh", "--engine", ""]);
    assert_eq!(engines, ["auto", "gpu", "cpu"]);
    assert_eq!(offered(&folder, &["gpu-smooth", "par"]), ["part.msh"]);
    // Commands precede meshes, so none is offered after a mesh.
    let before = offered(&folder, &["gpu-smooth", "--log", "json", ""]);
    assert!(["quality", "part.msh"].iter().all(|word| before.contains(&(*word).to_owned())));
    for words in [&["gpu-smooth", "part.msh", ""][..], &["gpu-smooth", "part.msh", "-q", ""]] {
        let after = offered(&folder, words);
        let place = |word: &str| after.iter().position(|other| other == word).unwrap();
        assert!(place("part.msh") < place("--scheme"), "{words:?}: {after:?}");
        assert!(!after.contains(&"quality".to_owned()), "{words:?}: {after:?}");
    }
    assert!(offered(&folder, &["gpu-smooth", "part.msh", "qua"]).is_empty());
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = folder.line(&format!("completions {shell}")).clean().out;
        assert_holds(&text, &["GPU_SMOOTH_COMPLETE", "gpu-smooth"]);
    }
    let page = folder.line("man").clean().out;
    // Manual pages escape hyphens, so that they are not minus signs.
    let plain = page.replace("\\-", "-");
    options.iter().for_each(|option| assert_holds(&plain, &[option]));
    assert_holds(&plain, &[".TH gpu-smooth 1", "Examples:", ".SH \"WHAT MAY MOVE\""]);
    let run = folder.line("completions tcsh");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["'tcsh'", "bash"]);
}

/// Completes a command line in a real shell by the script of the program. The last word is completed.
#[cfg(unix)]
fn completed(folder: &Folder, shell: &str, words: &[&str]) -> Vec<String> {
    let line = words.join(" ");
    let script = match shell {
        "bash" => format!(
            "source <(gpu-smooth completions bash); COMP_WORDS=({line}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); COMP_TYPE=9; \
             _clap_complete_gpu_smooth gpu-smooth \"${{COMP_WORDS[COMP_CWORD]#=}}\"; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        ),
        // The functions of zsh's interactive completion are replaced, so that the script runs without a terminal.
        "zsh" => format!(
            "compdef() {{ }}; source <(gpu-smooth completions zsh); \
             _describe() {{ print -rl -- ${{${{(P)3}}%%:*}} }}; \
             words=({line}); CURRENT=$#words; _clap_dynamic_completer_gpu_smooth"
        ),
        _ => format!("gpu-smooth completions fish | source; complete -C '{line}'"),
    };
    let options: &[&str] = match shell {
        "bash" => &["--norc"],
        "zsh" => &["-f"],
        _ => &["--no-config"],
    };
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_gpu-smooth")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut command = std::process::Command::new(shell);
    command.args(options).args(["-c", &script]).current_dir(folder.path(""));
    let output = command.env("PATH", path).env("HOME", folder.path("")).output();
    let output = output.unwrap_or_else(|error| panic!("{shell}: {error}; tests/run installs it"));
    let errors = String::from_utf8_lossy(&output.stderr);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(errors.is_empty(), "{shell} {line}: {errors}");
    text.lines().map(|line| line.split('\t').next().unwrap_or_default().to_owned()).collect()
}

#[cfg(unix)]
#[test]
fn bash_zsh_and_fish_complete_commands_options_values_and_files() {
    let folder = Folder::new(&[("part.msh", ""), ("other.txt", "")]);
    for shell in ["bash", "zsh", "fish"] {
        for (words, expected) in [
            (&["gpu-smooth", "qual"][..], "quality"),
            (&["gpu-smooth", "quality", "--me"], "--measure"),
            (&["gpu-smooth", "quality", "part.msh", "--measure", "scaled"], "scaled-jacobian"),
            (&["gpu-smooth", "part.msh", "out.msh", "--max-s"], "--max-sweeps"),
            (&["gpu-smooth", "part.msh", "out.msh", "--scheme", "tmop-8"], "tmop-80"),
            (&["gpu-smooth", "part.msh", "out.msh", "--scheme", "imr+tmop-8"], "imr+tmop-80"),
            (&["gpu-smooth", "part.msh", "out.msh", "--target", "keep-sh"], "keep-shape"),
            (&["gpu-smooth", "part.msh", "out.msh", "--target", "si"], "size="),
            (&["gpu-smooth", "part.msh", "out.msh", "--target", "me"], "metric="),
            (&["gpu-smooth", "part.msh", "out.msh", "--engine", "g"], "gpu"),
            (&["gpu-smooth", "convert", "par"], "part.msh"),
            (&["gpu-smooth", "par"], "part.msh"),
        ] {
            assert_eq!(completed(&folder, shell, words), [expected], "{shell}: {words:?}");
        }
    }
}

/// bash splits a word at `=`, and replaces only the last part of the word.
#[cfg(unix)]
#[test]
fn bash_completes_values_behind_an_equals_sign() {
    let folder = Folder::new(&[("part.msh", "")]);
    for (words, expected) in [
        (&["--scheme", "=", "imr+tmop-8"][..], &["imr+tmop-80"][..]),
        (&["--improve-worst", "="], &["imr", "min-angle", "altitude"]),
        (&["--target", "=", "keep-si"], &["keep-size"]),
    ] {
        let line = [&["gpu-smooth", "part.msh", "out.msh"][..], words].concat();
        assert_eq!(completed(&folder, "bash", &line), expected, "{words:?}");
    }
}

#[test]
fn every_command_has_a_page() {
    let folder = Folder::new(&[]);
    folder.line("man pages/man1").clean();
    let mut names: Vec<String> = fs::read_dir(folder.path("pages/man1"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let help = folder.line("--help").clean().out;
    let commands = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let name = |line: &str| Some(line.strip_prefix("  ")?.split(' ').next()?.to_owned());
    let mut expected: Vec<String> = commands
        .lines()
        .filter_map(name)
        .filter(|name| !name.is_empty() && name != "help")
        .map(|name| format!("gpu-smooth-{name}.1"))
        .collect();
    expected.push("gpu-smooth.1".into());
    expected.sort();
    assert_eq!(names, expected);
    let quality = folder.text("pages/man1/gpu-smooth-quality.1").replace("\\-", "-");
    assert_holds(&quality, &[".TH gpu-smooth-quality 1", "--threshold", "Examples:"]);
}

#[test]
fn help_has_examples_for_each_command_with_options() {
    let folder = Folder::new(&[]);
    for command in ["quality", "try", "groups", "compare", "convert", "bench", "completions", "man"]
    {
        let help = folder.line(&format!("{command} --help")).clean().out;
        assert!(help.contains("Example"), "{command}");
        assert_holds(&help, &[&format!("  gpu-smooth {command} ")]);
    }
    let help = folder.line("--help").clean().out;
    for heading in ["Metric and engine", "Stopping", "What may move", "Untangling", "Many meshes"] {
        assert_eq!(help.matches(&format!("\n{heading}:\n")).count(), 1, "{heading}");
    }
    // Each option in the examples of a command's help must exist.
    let examples = help.split("Examples:\n").nth(1).unwrap().split("Exit codes:").next().unwrap();
    let options = named(help.split("Examples:\n").next().unwrap());
    assert!(named(examples).iter().all(|option| options.contains(option)), "{examples}");
}

#[test]
fn colors_follow_the_environment() {
    let folder = Folder::new(&[]);
    for (variables, is_colored) in [
        (&[][..], false),
        (&[("CLICOLOR_FORCE", "1")], true),
        (&[("CLICOLOR_FORCE", "")], false),
        (&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")], false),
    ] {
        for line in ["none out", "--help", "--nonsense"] {
            let mut command = folder.command();
            command.args(line.split(' ')).env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
            let run = finish(command.envs(variables.iter().copied()));
            let is_found = (run.out + &run.err).contains('\u{1b}');
            assert_eq!(is_found, is_colored, "{line} with {variables:?}");
        }
    }
}
