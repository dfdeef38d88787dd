//! What a picture is drawn on.

use crate::picture::color::Color;

/// A place in pixels, from the upper left corner.
pub(crate) type Point = [f32; 2];

/// Where a text stands from its place.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A kind of picture file.
pub(crate) trait Canvas {
    /// Triangles with their goodness, in the rectangle from one corner to the other.
    fn faces(
        &mut self,
        corners: [Point; 2],
        triangles: &mut dyn Iterator<Item = ([Point; 3], f32)>,
        count: usize,
    );
    fn lines(&mut self, segments: &[[Point; 2]], width: f32, color: Color, opacity: f32);
    fn rectangle(&mut self, corners: [Point; 2], color: Color);
    /// A disc with a margin.
    fn disc(&mut self, center: Point, radius: f32, fill: Color);
    fn ring(&mut self, center: Point, radius: f32, width: f32, color: Color);
    /// Text on a base line.
    fn text(&mut self, at: Point, size: f32, anchor: Anchor, text: &str);
    /// Draws only inside a rectangle until it is called with none.
    fn clip(&mut self, corners: Option<[Point; 2]>);
    /// The width of a text.
    fn width(&self, size: f32, text: &str) -> f32;
    /// The file.
    fn finish(self: Box<Self>) -> Result<Vec<u8>, String>;
}
