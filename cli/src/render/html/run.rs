//! The section on the run: command, versions, engine, and the checks of the result.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::time::SystemTime;

use crate::error::CliError;
use crate::render::html::page::escape;
use crate::render::picture::slid;
use crate::report::{Done, SmoothJob};
use crate::terminal::numbers::sig6;
use crate::terminal::{process, shell_words};

/// Writes the command, the versions, the engine, and the certificate as HTML.
pub(crate) fn run(task: &SmoothJob<'_>, done: &Done<'_>) -> Result<String, CliError> {
    let command: Vec<String> =
        process::command_line().iter().map(|word| shell_words::quoted(word)).collect();
    let engine = &done.report.engine;
    let on = match (&engine.adapter, &engine.driver) {
        (Some(adapter), Some(driver)) => format!("{adapter} ({driver})"),
        _ => format!("CPU, {} threads", rayon::current_num_threads()),
    };
    let reason = engine.reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
    let mut text = format!("<pre>{}</pre><dl>", escape(&command.join(" ")));
    let mut item = |name: &str, value: &str| {
        let _ = write!(text, "<dt>{name}</dt><dd>{}</dd>", escape(value));
    };
    let format = &done.report.mesh.format;
    item("from", &format!("{} ({format})", task.input.display()));
    item("to", &task.out.display().to_string());
    if let Ok(now) = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH) {
        item("written", &date(now.as_secs()));
    }
    item("program", concat!("gpu-smooth ", env!("CARGO_PKG_VERSION")));
    item("system", &format!("{}, {}", std::env::consts::OS, std::env::consts::ARCH));
    item("scheme", &done.report.scheme);
    item("engine", &format!("{on}{reason}"));
    for choice in &done.report.choices {
        item("choice", choice);
    }
    text += "</dl>";
    text += &certificate(done)?;
    Ok(text)
}

/// Writes the checks of the final coordinates as HTML.
fn certificate(done: &Done<'_>) -> Result<String, CliError> {
    let topology = done.smoother.topology();
    let (old, new) = (&done.file.mesh().points, &done.outcome.points);
    let concave: BTreeSet<usize> =
        topology.bad_quadrilaterals(new)?.iter().map(|bad| bad.quadrilateral).collect();
    let kinds = [
        (
            topology.bad_triangles(new)?.len(),
            topology.triangles().len(),
            "triangles are inverted or flat",
        ),
        (concave.len(), topology.quadrilaterals().len(), "quadrilaterals are not convex"),
    ];
    let bad: Vec<String> = kinds
        .iter()
        .filter(|(_, count, _)| *count > 0)
        .map(|(bad, count, problem)| format!("{bad} of {count} {problem}"))
        .collect();
    let bits = |point: &[f64; 2]| point.map(f64::to_bits);
    let moved: Vec<usize> = (0..old.len()).filter(|&v| bits(&old[v]) != bits(&new[v])).collect();
    let held = topology.free().iter().filter(|free| !**free).count();
    // Vertices that slid have a sentence of their own, so the counts of held vertices exclude them.
    let off = slid(topology, old, new).len();
    let held = if done.report.slid.is_some() { held - off } else { held };
    let kept = if done.report.slid.is_some() { held } else { held - off };
    let distance = |&v: &usize| (new[v][0] - old[v][0]).hypot(new[v][1] - old[v][1]);
    let farthest = moved.iter().map(distance).fold(0.0, f64::max);
    Ok(format!(
        "<h3>Certificate</h3><ul><li>{}, by exact predicates on the coordinates as they were written.</li><li>{kept} of \
         {held} vertices that must stay have the same bits.</li><li>{} of {} vertices have moved, the farthest by {}.</li>\
         <li>{} vertices were put back because rounding had inverted an element.</li></ul>\
         <p><code>gpu-smooth compare</code> of both files proves this again.</p>",
        bad.join(" and "),
        moved.len(),
        old.len(),
        sig6(farthest),
        done.outcome.returned
    ))
}

/// Formats date and time in UTC, given in seconds since 1970.
fn date(seconds: u64) -> String {
    let (mut days, minutes) = (seconds / 86_400, seconds % 86_400 / 60);
    let is_leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let mut year = 1970;
    while days >= 365 + u64::from(is_leap(year)) {
        days -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let february = 28 + u64::from(is_leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02} {:02}:{:02} UTC", days + 1, minutes / 60, minutes % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        let cases = [
            (0, "1970-01-01 00:00 UTC"),
            (951_782_399, "2000-02-28 23:59 UTC"),
            (951_782_400, "2000-02-29 00:00 UTC"),
            (1_735_689_599, "2024-12-31 23:59 UTC"),
            (1_772_323_200, "2026-03-01 00:00 UTC"),
        ];
        for (seconds, text) in cases {
            assert_eq!(date(seconds), text);
        }
    }
}
