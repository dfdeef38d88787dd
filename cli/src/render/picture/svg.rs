//! Pictures in SVG, drawn as shapes. Triangles of large meshes are embedded as a raster image.

use std::collections::BTreeMap;
use std::fmt::Write;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use crate::error::CliError;
use crate::render::picture::canvas::{Anchor, Canvas, Point};
use crate::render::picture::color::{Color, of_goodness};
use crate::render::picture::font::Font;
use crate::render::picture::png;
use crate::render::picture::raster::Raster;
use crate::request::SVG_MARK;

/// Largest number of triangles drawn as shapes, which take some megabytes of text.
const MOST_TRIANGLES: usize = 50_000;

/// Number of steps to which the colors of triangles are rounded.
const COLORS: f32 = 128.0;

pub(crate) struct Svg {
    text: String,
    font: Font,
    problem: Option<CliError>,
}

impl Svg {
    pub(crate) fn new(width: u32, height: u32) -> Result<Self, CliError> {
        let mut text = String::new();
        let _ = writeln!(
            text,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             {SVG_MARK}\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>"
        );
        Ok(Self { text, font: Font::new()?, problem: None })
    }

    fn add(&mut self, line: std::fmt::Arguments<'_>) {
        let _ = writeln!(self.text, "{line}");
    }
}

fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Formats a coordinate with at most two decimals: finer positions are invisible.
fn short(x: f32) -> String {
    let text = format!("{x:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn place(at: Point) -> String {
    let [x, y] = at.map(short);
    format!("{x} {y}")
}

/// Escapes a text for SVG, without the characters that XML excludes.
fn escaped(text: &str) -> String {
    let is_excluded = |c: &char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    let plain: String = text.chars().filter(|c| !is_excluded(c)).collect();
    plain.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

impl Canvas for Svg {
    fn faces(
        &mut self,
        corners: [Point; 2],
        triangles: &mut dyn Iterator<Item = ([Point; 3], f32)>,
        count: usize,
    ) {
        if count > MOST_TRIANGLES {
            let mut raster = Raster::new(corners);
            triangles.for_each(|(corners, goodness)| raster.fill(corners, goodness));
            match png::encode(&raster) {
                Ok(bytes) => {
                    let Raster { left, top, width, height, .. } = raster;
                    let data = BASE64_STANDARD.encode(bytes);
                    self.add(format_args!(
                        "<image x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{data}\"/>"
                    ));
                }
                Err(problem) => self.problem = Some(problem),
            }
            return;
        }
        let mut paths: BTreeMap<i32, String> = BTreeMap::new();
        for (corners, goodness) in
            triangles.filter(|t| t.0.as_flattened().iter().all(|x| x.is_finite()))
        {
            let path = paths.entry((goodness * COLORS).round() as i32).or_default();
            let [p, q, r] = corners.map(place);
            let _ = write!(path, "M{p}L{q} {r}Z");
        }
        for (color, path) in paths {
            let color = hex(of_goodness(color as f32 / COLORS));
            // The stroke covers the seam between antialiased edges of adjacent triangles.
            self.add(format_args!(
                "<path fill=\"{color}\" stroke=\"{color}\" stroke-width=\"0.5\" d=\"{path}\"/>"
            ));
        }
    }

    fn lines(&mut self, segments: &[[Point; 2]], width: f32, color: Color, opacity: f32) {
        if segments.is_empty() {
            return;
        }
        let path: String =
            segments.iter().map(|[from, to]| format!("M{}L{}", place(*from), place(*to))).collect();
        let (color, width, opacity) = (hex(color), short(width), short(opacity));
        self.add(format_args!(
            "<path fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\" stroke-linecap=\"round\" d=\"{path}\"/>"
        ));
    }

    fn rectangle(&mut self, [[left, top], [right, bottom]]: [Point; 2], color: Color) {
        let [x, y, width, height] = [left, top, right - left, bottom - top].map(short);
        let color = hex(color);
        self.add(format_args!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{color}\"/>"
        ));
    }

    fn disc(&mut self, [x, y]: Point, radius: f32, fill: Color) {
        let ([x, y, radius], fill) = ([x, y, radius].map(short), hex(fill));
        self.add(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{fill}\"/>"));
    }

    fn ring(&mut self, [x, y]: Point, radius: f32, width: f32, color: Color) {
        let ([x, y, radius, width], color) = ([x, y, radius, width].map(short), hex(color));
        self.add(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"/>"
        ));
    }

    fn text(&mut self, [x, y]: Point, size: f32, anchor: Anchor, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let [x, y, margin, size] = [x, y, size / 5.0, size].map(short);
        let text = escaped(text);
        self.add(format_args!(
            "<text x=\"{x}\" y=\"{y}\" font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"{size}\" text-anchor=\"{anchor}\" stroke=\"#fff\" stroke-width=\"{margin}\" paint-order=\"stroke\">{text}</text>"
        ));
    }

    fn clip(&mut self, corners: Option<[Point; 2]>) {
        match corners {
            Some([[left, top], [right, bottom]]) => {
                let [x, y, width, height] = [left, top, right - left, bottom - top].map(short);
                self.add(format_args!(
                    "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" viewBox=\"{x} {y} {width} {height}\">"
                ));
            }
            None => self.add(format_args!("</svg>")),
        }
    }

    fn width(&self, size: f32, text: &str) -> f32 {
        self.font.width(size, text)
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, CliError> {
        match self.problem {
            Some(problem) => Err(problem),
            None => Ok((self.text + "</svg>\n").into_bytes()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(count: usize) -> String {
        let mut canvas = Svg::new(40, 30).unwrap();
        let triangle = [[1.0, 2.0], [9.0, 2.0], [9.0, 12.0]];
        canvas.faces([[0.0, 0.0], [20.0, 20.0]], &mut [(triangle, 0.5)].into_iter(), count);
        canvas.text([1.0, 1.0], 9.0, Anchor::End, "a<b>\u{7}&");
        String::from_utf8(Box::new(canvas).finish().unwrap()).unwrap()
    }

    #[test]
    fn few_triangles_are_paths() {
        let text = drawn(MOST_TRIANGLES);
        assert!(text.contains("d=\"M1 2L9 2 9 12Z\"") && !text.contains("<image"), "{text}");
        assert!(text.contains(">a&lt;b&gt;&amp;</text>"), "{text}");
    }

    #[test]
    fn many_triangles_are_a_picture() {
        let text = drawn(MOST_TRIANGLES + 1);
        assert!(text.contains("<image x=\"0\" y=\"0\" width=\"20\" height=\"20\""), "{text}");
        let (_, data) = text.split_once("base64,").unwrap();
        let bytes = BASE64_STANDARD.decode(&data[..data.find('"').unwrap()]).unwrap();
        let picture = tiny_skia::Pixmap::decode_png(&bytes).unwrap();
        assert_eq!((picture.width(), picture.height()), (20, 20));
        // A pixel inside the triangle and one beside it.
        assert_eq!(
            [picture.pixel(8, 5), picture.pixel(2, 11)].map(|p| p.unwrap().alpha()),
            [255, 0]
        );
        assert!(!text.contains("<path"), "{text}");
    }
}
