//! The panel, which shows the state of the smoother and the keys.

use embedded_graphics::mono_font::ascii::{FONT_9X18, FONT_9X18_BOLD};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::*;
use embedded_graphics::text::{Baseline, Text};
use std::convert::Infallible;

/// Colors by 1 / inverse mean ratio, in equal steps from 0 to 1. The last color marks inverted triangles.
pub(crate) const STOPS: [[u8; 3]; 7] = [
    [165, 0, 38],
    [244, 109, 67],
    [254, 224, 144],
    [224, 243, 248],
    [116, 173, 209],
    [69, 117, 180],
    [255, 0, 255],
];

const LINE: u32 = 20;
const PAD: u32 = 12;
/// Width of each of the two columns, in pixels.
const COLUMN: u32 = 440;
/// Width of the labels in a column, in pixels.
const LABELS: u32 = 100;
/// Number of lines in a column.
const LINES: u32 = 7;
const PAPER: [u8; 4] = [24, 28, 36, 255];
const TEXT: Rgb888 = Rgb888::new(235, 238, 242);
const LABEL: Rgb888 = Rgb888::new(150, 190, 235);

/// A label with its text.
pub(crate) type Line = (&'static str, String);

/// An image of text, drawn on the CPU after changes of the text.
pub(crate) struct Panel {
    size: [u32; 2],
    pixels: Vec<u8>,
    shown: Option<[Vec<Line>; 2]>,
}

impl Panel {
    pub(crate) fn new() -> Self {
        let size = [2 * COLUMN + 2 * PAD, LINES * LINE + 2 * PAD];
        Self { size, pixels: Vec::new(), shown: None }
    }

    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    pub(crate) fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// Shows two columns of lines, with the color scale below the second column. Returns whether the image
    /// changed.
    pub(crate) fn show(&mut self, columns: [Vec<Line>; 2]) -> bool {
        if self.shown.as_ref() == Some(&columns) {
            return false;
        }
        self.pixels = PAPER.repeat((self.size[0] * self.size[1]) as usize);
        for (left, lines) in [PAD, PAD + COLUMN].into_iter().zip(&columns) {
            for (row, (label, text)) in (0..).zip(lines) {
                let top = PAD + row * LINE;
                self.write([left, top], label, &FONT_9X18_BOLD, LABEL);
                self.write([left + LABELS, top], text, &FONT_9X18, TEXT);
            }
        }
        self.draw_colors([PAD + COLUMN, PAD + (LINES - 1) * LINE]);
        self.shown = Some(columns);
        true
    }

    fn write(&mut self, [x, y]: [u32; 2], text: &str, font: &MonoFont<'_>, color: Rgb888) {
        let style = MonoTextStyle::new(font, color);
        let at = Point::new(x as i32, y as i32);
        let Ok(_) = Text::with_baseline(text, at, style, Baseline::Top).draw(self);
    }

    /// Draws the color scale, labeled with inverse mean ratios.
    fn draw_colors(&mut self, [left, top]: [u32; 2]) {
        const WIDTH: u32 = COLUMN - LABELS - 2 * PAD;
        self.write([left, top], "color", &FONT_9X18_BOLD, LABEL);
        let left = left + LABELS;
        for x in 0..WIDTH {
            let [r, g, b] = color(1.0 - f64::from(x) / f64::from(WIDTH));
            let bar = (0..16).map(|y| Point::new((left + x) as i32, (top + y) as i32));
            let Ok(()) = self.draw_iter(bar.map(|p| Pixel(p, Rgb888::new(r, g, b))));
        }
        for imr in [1.0, 1.5, 2.0, 4.0] {
            let at = left + ((1.0 - 1.0 / imr) * f64::from(WIDTH)) as u32;
            let ink = if imr == 1.0 { TEXT } else { Rgb888::BLACK };
            self.write([at + 3, top], &imr.to_string(), &FONT_9X18, ink);
        }
        self.write([left + WIDTH - 30, top], "bad", &FONT_9X18, TEXT);
    }
}

/// Returns the color of a triangle by 1 / inverse mean ratio, as in draw.wgsl.
fn color(goodness: f64) -> [u8; 3] {
    let at = goodness * 5.0;
    let stop = (at as usize).min(4);
    let share = at - stop as f64;
    let mix = |i: usize| {
        let (from, to) = (f64::from(STOPS[stop][i]), f64::from(STOPS[stop + 1][i]));
        (from + share * (to - from)) as u8
    };
    [mix(0), mix(1), mix(2)]
}

impl OriginDimensions for Panel {
    fn size(&self) -> Size {
        Size::new(self.size[0], self.size[1])
    }
}

impl DrawTarget for Panel {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        let [width, height] = self.size;
        for Pixel(at, color) in pixels {
            let inside = |x: i32, side: u32| u32::try_from(x).ok().filter(|&x| x < side);
            let (Some(x), Some(y)) = (inside(at.x, width), inside(at.y, height)) else { continue };
            let first = 4 * (y * width + x) as usize;
            self.pixels[first..first + 3].copy_from_slice(&[color.r(), color.g(), color.b()]);
        }
        Ok(())
    }
}
