//! What ran, and what is certain of its result.

use std::ffi::OsStr;
use std::fmt::Write;

use crate::html::page::escape;
use crate::numbers::six;
use crate::task::{Done, Task};

/// The command, versions, the engine, and the certificate.
pub(crate) fn run(task: &Task<'_>, done: &Done<'_>) -> Result<String, String> {
    let command: Vec<String> = std::env::args_os().map(|word| quoted(&word)).collect();
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

/// What was checked on the coordinates as they were written.
fn certificate(done: &Done<'_>) -> Result<String, String> {
    let topology = done.smoother.topology();
    let (old, new) = (&done.file.mesh().points, &done.outcome.points);
    let bad = topology.bad_triangles(new).map_err(|error| error.to_string())?.len();
    let bits = |point: &[f64; 2]| point.map(f64::to_bits);
    let moved: Vec<usize> = (0..old.len()).filter(|&v| bits(&old[v]) != bits(&new[v])).collect();
    let held = topology.free().iter().filter(|free| !**free).count();
    let broken = moved.iter().filter(|&&v| !topology.free()[v]).count();
    let distance = |&v: &usize| (new[v][0] - old[v][0]).hypot(new[v][1] - old[v][1]);
    let farthest = moved.iter().map(distance).fold(0.0, f64::max);
    Ok(format!(
        "<h3>Certificate</h3><ul><li>{bad} of {} triangles are inverted or flat, by exact predicates on the coordinates as \
         they were written.</li><li>{} of {held} vertices that must stay have the same bits.</li><li>{} of {} vertices \
         have moved, the farthest by {}.</li><li>{} vertices were put back because rounding had inverted a triangle.</li></ul>\
         <p><code>gpu-smooth compare</code> of both files proves this again.</p>",
        topology.triangles().len(),
        held - broken,
        moved.len(),
        old.len(),
        six(farthest),
        done.outcome.returned
    ))
}

/// A word as a shell takes it.
fn quoted(word: &OsStr) -> String {
    let word = word.to_string_lossy();
    let is_plain = |c: char| c.is_alphanumeric() || "-_=+./,:@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.into_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_for_a_shell() {
        let cases =
            [("in.msh", "in.msh"), ("", "''"), ("a b", "'a b'"), ("it's<5", r"'it'\''s<5'")];
        for (word, expected) in cases {
            assert_eq!(quoted(OsStr::new(word)), expected);
        }
    }
}
