//! Lines, dots, rings and bars that pictures share.

use crate::render::picture::arrows;
use crate::render::picture::canvas::{Anchor, Canvas, Point};
use crate::render::picture::color::{BLACK, WHITE};
use crate::terminal::numbers::short;

/// Returns the width of lines of the boundary, in pixels.
pub(crate) fn boundary_width(text: f32) -> f32 {
    (text / 14.0).max(1.0)
}

/// Draws edges between regions: a white line on a black one.
pub(crate) fn between_regions(segments: &[[Point; 2]], text: f32, canvas: &mut dyn Canvas) {
    canvas.lines(segments, (text / 5.0).max(3.5), BLACK, 1.0);
    canvas.lines(segments, (text / 12.0).max(1.5), WHITE, 1.0);
}

/// Draws a frame around an inset, or around the drawn part of a mesh.
pub(crate) fn around(
    [[left, top], [right, bottom]]: [Point; 2],
    text: f32,
    canvas: &mut dyn Canvas,
) {
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
    let sides = [0, 1, 2, 3].map(|i: usize| [corners[i], corners[(i + 1) % 4]]);
    canvas.lines(&sides, text / 16.0, BLACK, 1.0);
}

/// Draws a bar of a round length, with the length in units of the mesh, at the lower left of an inset. `scale` is the
/// number of pixels per unit.
pub(crate) fn scale_bar(
    [[left, top], [right, bottom]]: [Point; 2],
    scale: f64,
    text: f32,
    canvas: &mut dyn Canvas,
) {
    let Some(length) = round_length(f64::from(right - left) / (3.0 * scale)) else { return };
    let (width, y) = ((length * scale) as f32, bottom - 0.6 * text);
    if bottom - top < 4.0 * text {
        return;
    }
    let from = left + 0.6 * text;
    let bar = [[[from, y], [from + width, y]]];
    canvas.lines(&bar, 0.35 * text, WHITE, 1.0);
    canvas.lines(&bar, 0.15 * text, BLACK, 1.0);
    canvas.text([from, y - 0.5 * text], 0.7 * text, Anchor::Start, &length_text(length));
}

/// Returns the largest of 1, 2 and 5 times a power of ten up to `most`; `None` if `most` is not a positive number.
fn round_length(most: f64) -> Option<f64> {
    if !(most > 0.0 && most.is_finite()) {
        return None;
    }
    let power = 10_f64.powi(most.log10().floor() as i32);
    [5.0, 2.0, 1.0].map(|factor| factor * power).into_iter().find(|&length| length <= most)
}

fn length_text(length: f64) -> String {
    match (1e-3..1e5).contains(&length) {
        true => short(length),
        false => format!("{:e}", length as f32),
    }
}

/// Draws an example of a displacement arrow for the legend.
pub(crate) fn moved([x, y]: Point, text: f32, canvas: &mut dyn Canvas) {
    arrows::draw(std::iter::once([[x - 0.7 * text, y], [x + 0.7 * text, y]]), text, canvas);
}

/// Draws a vertex that must not move.
pub(crate) fn held(at: Point, text: f32, canvas: &mut dyn Canvas) {
    canvas.disc(at, text / 6.5, BLACK);
    canvas.disc(at, text / 12.0, WHITE);
}

/// Draws a vertex that slid along its line.
pub(crate) fn slid(at: Point, text: f32, canvas: &mut dyn Canvas) {
    canvas.disc(at, text / 6.5, WHITE);
    canvas.disc(at, text / 9.0, BLACK);
}

/// Draws a mark around a bad triangle.
pub(crate) fn worst(at: Point, text: f32, canvas: &mut dyn Canvas) {
    canvas.ring(at, 0.6 * text, text / 4.0, WHITE);
    canvas.ring(at, 0.6 * text, text / 10.0, BLACK);
}

/// Draws the number of a ring beside the ring: at its upper right, or where a side of `bounds` is near, left of the ring or
/// lower, so that the number is inside.
pub(crate) fn ring_number(
    number: usize,
    [x, y]: Point,
    [[left, top], [right, bottom]]: [Point; 2],
    text: f32,
    canvas: &mut dyn Canvas,
) {
    let (size, number) = (0.8 * text, number.to_string());
    let (aside, margin, width) = (0.85 * text, 0.2 * text, canvas.width(size, &number));
    let start = match x + aside + width + margin <= right {
        true => x + aside,
        false => (x - aside - width).max(left + margin),
    };
    let base = (y - 0.5 * text).min(bottom - margin).max(top + size);
    canvas.text([start, base], size, Anchor::Start, &number);
}
