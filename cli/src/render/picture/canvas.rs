//! The drawing interface of pictures.

use crate::error::CliError;
use crate::render::picture::color::Color;

/// A point in pixels, from the upper left corner.
pub(crate) type Point = [f32; 2];

/// Horizontal alignment of a text relative to the point at which the text is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Drawing surface for one file format.
pub(crate) trait Canvas {
    /// Draws triangles, each with its goodness, in the rectangle between two corners. `count` is
    /// the number of all triangles.
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
    /// Draws a text. `at` lies on the base line.
    fn text(&mut self, at: Point, size: f32, anchor: Anchor, text: &str);
    /// Clips all drawing to a rectangle, until a call with `None`.
    fn clip(&mut self, corners: Option<[Point; 2]>);
    /// Returns the width of a text, in pixels.
    fn width(&self, size: f32, text: &str) -> f32;
    /// Returns the bytes of the picture file.
    fn finish(self: Box<Self>) -> Result<Vec<u8>, CliError>;
}
