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

#[test]
fn completions_and_manual_have_every_option() {
    let folder = Folder::new(&[]);
    let options = named(&folder.line("--help").clean().out);
    assert!(options.len() > 35, "{options:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = folder.line(&format!("completions {shell}")).clean().out;
        for option in &options {
            let name = option.trim_start_matches('-');
            assert!(text.contains(name), "{shell}: {option}");
        }
        assert_holds(&text, &["quality", "compare"]);
        if ["bash", "zsh", "fish"].contains(&shell) {
            assert_holds(&text, &["multilevel"]);
            let metrics = Metric::ALL.iter().map(|metric| metric.name());
            let names: Vec<_> = metrics.chain(Measure::ALL.iter().map(|m| m.name())).collect();
            assert_holds(&text, &names);
        }
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
    for command in ["quality", "groups", "compare", "bench", "completions", "man"] {
        let help = folder.line(&format!("{command} --help")).clean().out;
        assert!(help.contains("Example"), "{command}");
        assert_holds(&help, &[&format!("  gpu-smooth {command} ")]);
    }
    let help = folder.line("--help").clean().out;
    for heading in ["Metric and engine", "Stopping", "What may move", "Untangling", "Many meshes"] {
        assert_eq!(help.matches(&format!("\n{heading}:\n")).count(), 1, "{heading}");
    }
    // Each option in the examples of a command's help must exist.
    let examples = help.split("Examples:\n").nth(1).unwrap();
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
