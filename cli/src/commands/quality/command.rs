//! The command `gpu-smooth quality MESH...`, which measures meshes.

use std::path::Path;

use crate::args::QualityArgs;
use crate::commands::quality::bars::Style;
use crate::commands::quality::mesh_quality::MeshQuality;
use crate::commands::quality::{json, text};
use crate::error::CliError;
use crate::render::html::{self, PageEntry};
use crate::request::Outputs;
use crate::terminal::progress::Display;
use crate::terminal::{Verbosity, interrupt, tell};

/// Prints the quality of meshes. Shows progress on standard error if a picture or a page is drawn. Returns an error if a mesh cannot be read, or if triangles violate a
/// threshold.
pub(crate) fn run(args: &QualityArgs, verbosity: Verbosity) -> Result<(), CliError> {
    let outputs = Outputs::of_drawings(&args.picture, args.html.as_ref())?;
    outputs.check(&args.meshes, &[])?;
    let is_drawn = outputs.picture.is_some() || outputs.page.is_some();
    let verbosity = Verbosity { quiet: verbosity.quiet || !is_drawn, ..verbosity };
    if is_drawn {
        interrupt::watch(verbosity.quiet);
    }
    let display = Display::new(verbosity, None, 0);
    let style = Style::of_terminal(args.ascii);
    let (mut qualities, mut errors) = (Vec::new(), Vec::new());
    for path in &args.meshes {
        match MeshQuality::of(path, args, &outputs, &display) {
            Ok(quality) => qualities.push(quality),
            // A mesh that cannot be read must not hide the others.
            Err(error) => errors.push(error),
        }
    }
    display.clear();
    if !qualities.is_empty() {
        print(&qualities, args, &style)?;
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

/// Prints the quality of at least one mesh.
fn print(qualities: &[MeshQuality], args: &QualityArgs, style: &Style) -> Result<(), CliError> {
    if args.json {
        tell::say_data(&format!("{:#}", json::json(qualities)?));
    } else if args.csv {
        tell::say_data(&json::csv(qualities));
    } else {
        tell::say(&text::text(qualities, style));
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
    Some(PageEntry {
        name,
        triangles: quality.triangles,
        bad: quality.report.inverted,
        part: quality.page.as_ref()?,
        statistics: &quality.statistics,
    })
}

/// Returns a sentence for each threshold that triangles of a mesh violate.
fn violations(quality: &MeshQuality, style: &Style) -> impl Iterator<Item = String> {
    quality.violations.iter().filter_map(move |violation| {
        let (place, value) = violation.worst.as_ref()?;
        let (path, threshold) = (quality.path.display(), &violation.threshold);
        let worst = text::valued(threshold.measure, *value, style);
        Some(format!(
            "{path}: {} of {} triangles have {threshold}; the worst is triangle {} ({place}), {worst}",
            violation.count, quality.triangles, place.id
        ))
    })
}
