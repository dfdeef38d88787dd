//! The command `gpu-smooth quality MESH...`, which measures meshes.

use std::path::Path;

use crate::args::QualityArgs;
use crate::commands::quality::bars::Style;
use crate::commands::quality::mesh_quality::MeshQuality;
use crate::commands::quality::{json, text};
use crate::error::CliError;
use crate::profiles::ProfileSource;
use crate::render::html::{self, MeshNumbers, PageEntry};
use crate::report::{Finding, Verdict};
use crate::request::Outputs;
use crate::terminal::progress::Display;
use crate::terminal::{Verbosity, interrupt, tell};

/// Prints the quality of meshes. Shows progress on standard error if a picture or a page is drawn. Returns an error if a mesh cannot be read, or if its triangles, edges
/// or vertices violate a threshold.
pub(crate) fn run(args: &QualityArgs, verbosity: Verbosity) -> Result<(), CliError> {
    let outputs = Outputs::of_drawings(&args.picture, args.html.as_ref())?;
    outputs.check(&args.meshes, &[])?;
    let is_drawn = outputs.picture.is_some() || outputs.page.is_some();
    let quiet = verbosity.quiet;
    let verbosity = Verbosity { quiet: quiet || !is_drawn, ..verbosity };
    if is_drawn {
        interrupt::watch(verbosity.quiet);
    }
    let display = Display::new(verbosity, None, 0);
    let profile = args.profile.as_ref().map(ProfileSource::read).transpose()?;
    let style = Style::of_terminal(args.ascii);
    let (mut qualities, mut errors) = (Vec::new(), Vec::new());
    for path in &args.meshes {
        match MeshQuality::of(path, args, profile.as_ref(), &outputs, &display) {
            Ok(quality) => qualities.push(quality),
            // A mesh that cannot be read must not hide the others.
            Err(error) => errors.push(error),
        }
    }
    display.clear();
    if !qualities.is_empty() {
        print(&qualities, args, quiet, &style)?;
        write_page(&qualities, outputs.page.as_deref())?;
    }
    let mut violations = qualities.iter().flat_map(|quality| violations(quality, &style));
    let violated =
        violations.next().map(|first| CliError::run(first).with_details(violations.collect()));
    // The exit code is that of a mesh that cannot be read, as its triangles are not checked.
    let mut errors: Vec<CliError> = violated.into_iter().chain(errors).collect();
    let last = errors.pop();
    errors.iter().for_each(tell::error);
    last.map_or(Ok(()), Err)
}

/// Prints the quality of at least one mesh. Prints no text if `quiet` is true and thresholds or a profile are given, which
/// the exit code answers.
fn print(
    qualities: &[MeshQuality],
    args: &QualityArgs,
    quiet: bool,
    style: &Style,
) -> Result<(), CliError> {
    if args.json {
        tell::say_data(&format!("{:#}", json::json(qualities)?));
    } else if args.csv {
        tell::say_data(&json::csv(qualities));
    } else if args.summary {
        tell::say(&summary(qualities, style));
    } else if !quiet || args.threshold.is_empty() && args.profile.is_none() {
        let is_usual = args.measure.is_empty();
        let mut text = text::text(qualities, is_usual, style);
        for quality in qualities {
            let Some(profile) = &quality.profile else { continue };
            let path = quality.path.display();
            let name = if qualities.len() > 1 { format!("== {path}\n") } else { String::new() };
            text += &format!("\n\n{name}{}", profile.table());
        }
        if !args.threshold.is_empty() {
            text += &format!("\n\n{}", of_thresholds(qualities, style).join("\n"));
        }
        tell::say(&text);
    }
    Ok(())
}

/// Writes the page of the measured meshes if requested.
fn write_page(qualities: &[MeshQuality], path: Option<&Path>) -> Result<(), CliError> {
    let Some(path) = path else { return Ok(()) };
    let is_alone = qualities.len() == 1;
    let entries: Vec<PageEntry<'_>> =
        qualities.iter().filter_map(|quality| entry(quality, is_alone)).collect();
    html::write_meshes(path, &entries)
}

/// Returns the entry of a mesh in the page, with the name of its file, or with its path if the page has several meshes.
fn entry(quality: &MeshQuality, is_alone: bool) -> Option<PageEntry<'_>> {
    let path = &quality.path;
    let name = match is_alone {
        true => path.file_name().unwrap_or_default().display().to_string(),
        false => path.display().to_string(),
    };
    let numbers = MeshNumbers {
        name,
        elements: quality.triangles + quality.quadrilaterals,
        has_quadrilaterals: quality.quadrilaterals > 0,
        bad: quality.report.inverted,
        statistics: &quality.statistics,
    };
    Some(PageEntry { numbers, part: quality.page.as_ref()? })
}

/// Returns a line for each threshold of each mesh.
fn of_thresholds(qualities: &[MeshQuality], style: &Style) -> Vec<String> {
    let of_mesh = |quality: &MeshQuality| -> Vec<String> {
        let path = quality.path.display();
        let line = |finding: &Finding| {
            let result = if finding.count == 0 { "passed" } else { "failed" };
            format!("{path}: {result}: {}", finding.sentence(style.plain))
        };
        quality.findings.iter().map(line).collect()
    };
    qualities.iter().flat_map(of_mesh).collect()
}

/// Returns a line for each threshold and each limit of the profile of each mesh; without both, a line for each mesh.
fn summary(qualities: &[MeshQuality], style: &Style) -> String {
    let mut lines = of_thresholds(qualities, style);
    for quality in qualities {
        let path = quality.path.display();
        for limit in quality.profile.iter().flat_map(|profile| &profile.limits) {
            let verdict = limit.judged();
            lines.push(format!("{path}: {verdict}: {}", limit.sentence(style.plain)));
        }
        if quality.findings.is_empty() && quality.profile.is_none() {
            lines.push(format!("{path}: {}", text::in_short(quality, style)));
        }
    }
    lines.join("\n")
}

/// Returns a sentence for each threshold that parts of a mesh violate, and for each limit that fails.
fn violations(quality: &MeshQuality, style: &Style) -> Vec<String> {
    let violated = quality.findings.iter().filter(|finding| finding.count > 0);
    let limits = quality.profile.iter().flat_map(|profile| &profile.limits);
    let failed = limits.filter(|limit| limit.verdict() == Verdict::Fail);
    violated
        .map(|finding| finding.sentence(style.plain))
        .chain(failed.map(|limit| limit.sentence(style.plain)))
        .map(|sentence| format!("{}: {sentence}", quality.path.display()))
        .collect()
}
