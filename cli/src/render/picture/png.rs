//! Pictures as PNG.

use tiny_skia::{
    FillRule, Mask, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8, Rect, Stroke, Transform,
};

use crate::error::CliError;
use crate::render::picture::canvas::{Anchor, Canvas, Point};
use crate::render::picture::clip::clipped;
use crate::render::picture::color::{BAD, BLACK, Color, NEUTRAL, WHITE, of_goodness};
use crate::render::picture::font::Font;
use crate::render::picture::raster::Raster;
use crate::request::PNG_MARK;

/// Number of steps from bad to good in a palette, which also has three other colors.
const SCALE: u8 = 253;

pub(crate) struct Png {
    pixels: Pixmap,
    font: Font,
    clip: Option<Mask>,
}

impl Png {
    pub(crate) fn new(width: u32, height: u32) -> Result<Self, CliError> {
        let mut pixels = Pixmap::new(width, height).ok_or_else(too_large)?;
        pixels.fill(tiny_skia::Color::WHITE);
        Ok(Self { pixels, font: Font::new()?, clip: None })
    }

    /// Returns the corners of the picture, with a margin beyond which nothing shows. The renderer panics at coordinates of millions
    /// of pixels.
    fn bounds(&self, margin: f32) -> [Point; 2] {
        let size = [self.pixels.width() as f32, self.pixels.height() as f32];
        [[-margin; 2], size.map(|pixels| pixels + margin)]
    }

    /// Returns whether a mark of this radius around a point shows in the picture.
    fn shows(&self, at: Point, radius: f32) -> bool {
        clipped([at, at], self.bounds(radius)).is_some()
    }

    fn stroke(&mut self, path: Option<Path>, width: f32, color: Color, opacity: f32) {
        let Some(path) = path else { return };
        let stroke = Stroke { width, ..Stroke::default() };
        let paint = paint(color, opacity);
        self.pixels.stroke_path(&path, &paint, &stroke, Transform::identity(), self.clip.as_ref());
    }
}

fn paint(color: Color, opacity: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    let [r, g, b] = color;
    paint.set_color_rgba8(r, g, b, (255.0 * opacity).round() as u8);
    paint
}

/// Returns the error for a picture too large for memory.
pub(super) fn too_large() -> CliError {
    CliError::run("the picture is too large: give a smaller --picture-size")
}

/// Encodes the triangles of a raster as a PNG with transparent background. The PNG has a palette, which makes pages with
/// several pictures of a large mesh about half as large as full colors do.
pub(crate) fn encode(raster: &Raster) -> Result<Vec<u8>, CliError> {
    let size = |pixels: usize| u32::try_from(pixels).map_err(|_| too_large());
    let (width, height) = (size(raster.width)?, size(raster.height)?);
    // Transparent, inverted or flat, without judgment, and the scale from bad to good.
    let scale = (0..SCALE).map(|step| of_goodness(f32::from(step) / f32::from(SCALE - 1)));
    let palette: Vec<Color> = [WHITE, BAD, NEUTRAL].into_iter().chain(scale).collect();
    let index = |goodness: f32| match goodness {
        g if g.is_infinite() => 0,
        g if g < 0.0 => 1,
        g if g > 1.0 => 2,
        g => 3 + (g * f32::from(SCALE - 1)).round() as u8,
    };
    let pixels: Vec<u8> = raster.goodness().map(index).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(palette.concat());
    encoder.set_trns(&[0][..]);
    write(encoder, &pixels)?;
    Ok(bytes)
}

fn write(encoder: png::Encoder<'_, &mut Vec<u8>>, pixels: &[u8]) -> Result<(), CliError> {
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(pixels).map_err(failed)?;
    writer.finish().map_err(failed)
}

fn failed(error: png::EncodingError) -> CliError {
    CliError::run(error.to_string())
}

impl Canvas for Png {
    fn faces(
        &mut self,
        corners: [Point; 2],
        triangles: &mut dyn Iterator<Item = ([Point; 3], f32)>,
        _count: usize,
    ) {
        let mut raster = Raster::new(corners);
        triangles.for_each(|(corners, goodness)| raster.fill(corners, goodness));
        let (columns, rows) = (self.pixels.width() as usize, self.pixels.height() as usize);
        let pixels = self.pixels.pixels_mut();
        for (i, [r, g, b, a]) in raster.pixels().enumerate().filter(|(_, pixel)| pixel[3] > 0) {
            let x = raster.left + (i % raster.width) as i32;
            let y = raster.top + (i / raster.width) as i32;
            if let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y))
                && x < columns
                && y < rows
                && let Some(color) = PremultipliedColorU8::from_rgba(r, g, b, a)
            {
                pixels[y * columns + x] = color;
            }
        }
    }

    fn lines(&mut self, segments: &[[Point; 2]], width: f32, color: Color, opacity: f32) {
        let bounds = self.bounds(width + 1.0);
        // Segments are drawn in pieces, because the time for a path grows faster than its length.
        for piece in segments.chunks(4096) {
            let mut path = PathBuilder::new();
            for [from, to] in piece.iter().filter_map(|segment| clipped(*segment, bounds)) {
                path.move_to(from[0], from[1]);
                path.line_to(to[0], to[1]);
            }
            self.stroke(path.finish(), width, color, opacity);
        }
    }

    fn rectangle(&mut self, [[left, top], [right, bottom]]: [Point; 2], color: Color) {
        let [least, most] = self.bounds(1.0);
        let [left, right] = [left, right].map(|x| x.clamp(least[0], most[0]));
        let [top, bottom] = [top, bottom].map(|y| y.clamp(least[1], most[1]));
        if let Some(rectangle) = Rect::from_ltrb(left, top, right, bottom) {
            self.pixels.fill_rect(
                rectangle,
                &paint(color, 1.0),
                Transform::identity(),
                self.clip.as_ref(),
            );
        }
    }

    fn disc(&mut self, [x, y]: Point, radius: f32, fill: Color) {
        if self.shows([x, y], radius + 1.0)
            && let Some(path) = PathBuilder::from_circle(x, y, radius)
        {
            let paint = paint(fill, 1.0);
            self.pixels.fill_path(
                &path,
                &paint,
                FillRule::Winding,
                Transform::identity(),
                self.clip.as_ref(),
            );
        }
    }

    fn ring(&mut self, [x, y]: Point, radius: f32, width: f32, color: Color) {
        if self.shows([x, y], radius + width) {
            self.stroke(PathBuilder::from_circle(x, y, radius), width, color, 1.0);
        }
    }

    fn text(&mut self, [x, y]: Point, size: f32, anchor: Anchor, text: &str) {
        let width = self.font.width(size, text);
        let start = match anchor {
            Anchor::Start => x,
            Anchor::Middle => x - width / 2.0,
            Anchor::End => x - width,
        };
        if self.shows([start, y], width + 2.0 * size)
            && let Some(path) = self.font.outlines([start, y], size, text)
        {
            // A white margin keeps the text legible on any background.
            self.stroke(Some(path.clone()), size / 5.0, WHITE, 1.0);
            let paint = paint(BLACK, 1.0);
            self.pixels.fill_path(
                &path,
                &paint,
                FillRule::Winding,
                Transform::identity(),
                self.clip.as_ref(),
            );
        }
    }

    fn clip(&mut self, corners: Option<[Point; 2]>) {
        self.clip = corners.and_then(|[[left, top], [right, bottom]]| {
            let path = PathBuilder::from_rect(Rect::from_ltrb(left, top, right, bottom)?);
            let mut mask = Mask::new(self.pixels.width(), self.pixels.height())?;
            mask.fill_path(&path, FillRule::Winding, true, Transform::identity());
            Some(mask)
        });
    }

    fn width(&self, size: f32, text: &str) -> f32 {
        self.font.width(size, text)
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, CliError> {
        let (width, height) = (self.pixels.width(), self.pixels.height());
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        let [keyword, text] = PNG_MARK.map(str::to_owned);
        encoder.add_text_chunk(keyword, text).map_err(failed)?;
        write(encoder, &self.pixels.take_demultiplied())?;
        Ok(bytes)
    }
}
