//! The surface that a picture is drawn on.

use crate::error::CliError;
use crate::render::picture::color::Color;

/// A point in pixels, from the upper left corner.
pub(crate) type Point = [f32; 2];

/// Which part of a text is at the point where it is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Draws a picture for one kind of file.
pub(crate) trait Canvas {
    /// Draws triangles, colored by their goodness, in the rectangle between two corners.
    fn faces(
        &mut self,
        corners: [Point; 2],
        triangles: &mut dyn Iterator<Item = ([Point; 3], f32)>,
        count: usize,
    );
    fn lines(&mut self, segments: &[[Point; 2]], width: f32, color: Color, opacity: f32);
    fn rectangle(&mut self, corners: [Point; 2], color: Color);
    /// Draws a filled disc.
    fn disc(&mut self, center: Point, radius: f32, fill: Color);
    fn ring(&mut self, center: Point, radius: f32, width: f32, color: Color);
    /// Draws a text. `at` is on its base line.
    fn text(&mut self, at: Point, size: f32, anchor: Anchor, text: &str);
    /// Limits drawing to a rectangle, until it is called with `None`.
    fn clip(&mut self, corners: Option<[Point; 2]>);
    /// Returns the width of a text, in pixels.
    fn width(&self, size: f32, text: &str) -> f32;
    /// Returns the bytes of the file.
    fn finish(self: Box<Self>) -> Result<Vec<u8>, CliError>;
}
