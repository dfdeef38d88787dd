//! The report on the spacing at walls.

use gpu_smooth::layers::Spacing;
use serde::Serialize;

use crate::terminal::numbers::sig6;

/// Number of walls that the summary names.
const NAMED: usize = 4;

/// The spacing at a wall: distances of the vertices next to the wall, before and after.
#[derive(Serialize)]
pub(crate) struct SpacingReport {
    /// Name or tag of the group of lines, or `the boundary`.
    pub(crate) wall: String,
    /// Number of distances.
    pub(crate) count: usize,
    /// Median distances before and after, in the unit of the mesh.
    pub(crate) medians: [f64; 2],
    /// Least, median and greatest ratio of a distance after to that before.
    pub(crate) ratios: [f64; 3],
    /// Share of the distances that change by more than 10 %.
    pub(crate) changed: f64,
    /// Whether triangles at half of the vertices of the wall are flat, as in a boundary layer.
    pub(crate) flat: bool,
    /// Largest factor by which a distance grows or shrinks.
    #[serde(skip)]
    pub(crate) largest_change: f64,
}

impl SpacingReport {
    /// Returns the report on a wall.
    pub(crate) fn new(wall: String, spacing: &Spacing) -> Self {
        let Spacing { count, medians, ratios, changed, .. } = *spacing;
        let (flat, largest_change) = (spacing.is_flat(), spacing.largest_change());
        Self { wall, count, medians, ratios, changed, flat, largest_change }
    }

    /// Describes the spacing in one sentence.
    fn sentence(&self) -> String {
        let Self { wall, count, medians: [before, after], ratios, changed, .. } = self;
        let [least, median, most] = ratios;
        let vertices = if *count == 1 { "1 vertex" } else { &format!("{count} vertices") };
        format!(
            "spacing at {wall}: {} before, {} after (median of {vertices}); after/before {least:.3} (least), {median:.3} \
             (median), {most:.3} (most); {:.0} % by more than 10 %",
            sig6(*before),
            sig6(*after),
            100.0 * changed,
        )
    }
}

/// Describes the spacing at walls with flat triangles, one sentence for each of the first walls.
pub(crate) fn spacing_sentences(walls: &[SpacingReport]) -> Vec<String> {
    let flat: Vec<&SpacingReport> = walls.iter().filter(|wall| wall.flat).collect();
    let mut sentences: Vec<String> = flat.iter().take(NAMED).map(|wall| wall.sentence()).collect();
    match flat.len().saturating_sub(NAMED) {
        0 => {}
        1 => sentences.push("spacing at 1 more wall: see --report".to_owned()),
        more => sentences.push(format!("spacing at {more} more walls: see --report")),
    }
    sentences
}

/// Returns the largest factor by which the spacing at a wall with flat triangles grows or shrinks; `None` without such
/// walls.
pub(crate) fn spacing_change(walls: &[SpacingReport]) -> Option<f64> {
    let flat = walls.iter().filter(|wall| wall.flat);
    flat.map(|wall| wall.largest_change).max_by(f64::total_cmp)
}
