//! Text as outlines. The font is the Latin part of DejaVu Sans; its license is in the same folder.

use crate::error::CliError;
use tiny_skia::{Path, PathBuilder, Transform};
use ttf_parser::{Face, OutlineBuilder};

pub(crate) struct Font(Face<'static>);

impl Font {
    pub(crate) fn new() -> Result<Self, CliError> {
        let face = Face::parse(include_bytes!("DejaVuSans-subset.ttf"), 0);
        face.map(Self)
            .map_err(|error| CliError::run(format!("the font of pictures cannot be read: {error}")))
    }

    /// Returns the width of a text, in pixels, at a size in pixels.
    pub(crate) fn width(&self, size: f32, text: &str) -> f32 {
        let advance = |c| self.0.glyph_index(c).and_then(|glyph| self.0.glyph_hor_advance(glyph));
        let units: f32 = text.chars().map(|c| f32::from(advance(c).unwrap_or(1200))).sum();
        units * self.scale(size)
    }

    /// Returns the outlines of a text that starts at a point on its base line.
    pub(crate) fn outlines(&self, [x, y]: [f32; 2], size: f32, text: &str) -> Option<Path> {
        let mut builder = Outlines(PathBuilder::new(), 0.0);
        for c in text.chars() {
            // A character that the font lacks leaves a gap.
            if let Some(glyph) = self.0.glyph_index(c) {
                self.0.outline_glyph(glyph, &mut builder);
                builder.1 += f32::from(self.0.glyph_hor_advance(glyph).unwrap_or(0));
            } else {
                builder.1 += 1200.0;
            }
        }
        let scale = self.scale(size);
        builder.0.finish()?.transform(Transform::from_row(scale, 0.0, 0.0, -scale, x, y))
    }

    fn scale(&self, size: f32) -> f32 {
        size / f32::from(self.0.units_per_em())
    }
}

/// Outlines of glyphs in units of the font, and where the next glyph starts.
struct Outlines(PathBuilder, f32);

impl OutlineBuilder for Outlines {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x + self.1, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x + self.1, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1 + self.1, y1, x + self.1, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1 + self.1, y1, x2 + self.1, y2, x + self.1, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}
