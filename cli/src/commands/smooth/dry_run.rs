//! `--dry-run`: the facts of a run that writes nothing.

use std::path::Path;

use crate::load::streams;
use crate::report::SmoothJob;
use crate::run::rehearsal::Rehearsal;
use crate::terminal::numbers::{counted, elements};

/// Prints the facts of a run before its first sweep.
pub(super) fn print(task: &SmoothJob<'_>, rehearsal: &Rehearsal) {
    streams::say_beside(task.out, &text(task, rehearsal));
}

fn text(task: &SmoothJob<'_>, rehearsal: &Rehearsal) -> String {
    let request = task.request;
    let Rehearsal { format, vertices, free, sliding, fixed, bad, .. } = rehearsal;
    let elements = elements(rehearsal.triangles, rehearsal.quadrilaterals);
    let input = task.input.display();
    let mut lines = vec![format!("{input}: {format}, {vertices} vertices, {elements}")];
    let slide = match sliding {
        Some(count) => format!(", and up to {count} would slide along lines"),
        None => String::new(),
    };
    match &rehearsal.nothing_to_do {
        Some(reason) => lines.push(format!("no vertex would move: {reason}")),
        None => lines.push(format!("up to {free} vertices would move{slide}")),
    }
    let [triangles, quadrilaterals] = *bad;
    let bad = [
        (triangles, counted(triangles, "inverted or flat triangle")),
        (quadrilaterals, counted(quadrilaterals, "inverted or concave quadrilateral")),
    ];
    let bad: Vec<String> =
        bad.into_iter().filter(|(count, _)| *count > 0).map(|(_, told)| told).collect();
    if !bad.is_empty() {
        let bad = bad.join(" and ");
        lines.push(format!(
            "{bad} would be untangled first; the run fails if untangling does not succeed"
        ));
    }
    let held: usize = fixed.iter().map(|(_, count)| count).sum();
    if held > 0 {
        let width = held.to_string().len();
        lines.push(format!("{held} vertices are not free:"));
        lines.extend(fixed.iter().map(|(reason, count)| {
            format!("  {count:>width$} {}", reason.words(request.slide.is_some()))
        }));
    }
    let engine = match &rehearsal.adapter {
        None => "the CPU".to_owned(),
        Some(name) => format!("the GPU ({name})"),
    };
    let reason = rehearsal.reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
    let (scheme, target) = (request.scheme(), request.target.name());
    lines.push(format!("scheme {scheme}, target {target}, on {engine}{reason}"));
    let files: Vec<String> = std::iter::once(task.out)
        .chain(request.outputs.files_beside_mesh())
        .map(|path: &Path| path.display().to_string())
        .collect();
    lines.push(format!("would write {}", files.join(", ")));
    lines.push("nothing was written (--dry-run)".to_owned());
    lines.join("\n")
}
