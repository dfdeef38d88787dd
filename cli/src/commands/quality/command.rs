//! The command `gpu-smooth quality MESH...`, which measures meshes.

use crate::args::QualityArgs;
use crate::commands::quality::bars::Style;
use crate::commands::quality::sheet::MeshQuality;
use crate::commands::quality::{json, text};
use crate::error::CliError;

use crate::request::Outputs;
use crate::terminal::tell;

/// Prints the quality of meshes. Returns an error if a mesh cannot be read, or if triangles violate a
/// threshold.
pub(crate) fn run(args: &QualityArgs) -> Result<(), CliError> {
    let outputs = Outputs::of_picture(&args.picture)?;
    outputs.check(&args.meshes, &[])?;
    let style = Style::of_terminal(args.ascii);
    let sheets =
        args.meshes.iter().map(|path| MeshQuality::of(path, args, outputs.picture.as_ref()));
    let sheets = sheets.collect::<Result<Vec<_>, _>>()?;
    if args.json {
        tell::say_data(&format!("{:#}", json::json(&sheets)?));
    } else if args.csv {
        tell::say_data(&json::csv(&sheets));
    } else {
        tell::say(&text::text(&sheets, &style));
    }
    let mut violations = sheets.iter().flat_map(|sheet| violations(sheet, &style));
    match violations.next() {
        None => Ok(()),
        Some(first) => Err(CliError::run(first).with_details(violations.collect())),
    }
}

/// Returns a sentence for each threshold that triangles of a mesh violate.
fn violations(sheet: &MeshQuality, style: &Style) -> impl Iterator<Item = String> {
    sheet.violations.iter().filter_map(move |violation| {
        let (place, value) = violation.worst.as_ref()?;
        let (path, threshold) = (sheet.path.display(), &violation.threshold);
        let worst = text::valued(threshold.measure, *value, style);
        Some(format!(
            "{path}: {} of {} triangles have {threshold}; the worst is triangle {} ({place}), {worst}",
            violation.count, sheet.triangles, place.id
        ))
    })
}
