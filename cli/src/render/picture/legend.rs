//! The legend of a picture: the scale of colors, and the lines and marks that occur.

use crate::color_scale::ColorScale;
use crate::render::picture::canvas::{Anchor, Canvas, Point};
use crate::render::picture::color::{self, BAD, BLACK, Color, NEUTRAL};
use crate::render::picture::marks::{between_regions, boundary_width, held, moved, slid, worst};
use crate::terminal::numbers::short;

/// A line or mark of a legend, drawn around a point by the height of text in pixels.
type Sign = fn(Point, f32, &mut dyn Canvas);

/// The lines and marks that a legend can name.
#[derive(Clone, Copy)]
pub(crate) enum Symbol {
    Boundary,
    BetweenRegions,
    Held,
    Slid,
    /// A quadrilateral or polygon, by its name.
    Face(&'static str),
    Bad,
    /// The worst triangles or edges, by their name.
    Worst(&'static str),
    Displacement,
}

impl Symbol {
    fn sign(self) -> Sign {
        match self {
            Self::Boundary => |[x, y], text, canvas| {
                let line = [[x - 0.7 * text, y], [x + 0.7 * text, y]];
                canvas.lines(&[line], boundary_width(text), BLACK, 1.0);
            },
            Self::BetweenRegions => |[x, y], text, canvas| {
                between_regions(&[[[x - 0.7 * text, y], [x + 0.7 * text, y]]], text, canvas);
            },
            Self::Held => held,
            Self::Slid => slid,
            Self::Face(_) => |at, text, canvas| square(at, text, NEUTRAL, canvas),
            Self::Bad => |at, text, canvas| square(at, text, BAD, canvas),
            Self::Worst(_) => worst,
            Self::Displacement => moved,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Boundary => "boundary",
            Self::BetweenRegions => "between regions",
            Self::Held => "fixed vertex inside",
            Self::Slid => "vertex that slid",
            Self::Face(name) | Self::Worst(name) => name,
            Self::Bad => "inverted or flat",
            Self::Displacement => "displacement",
        }
    }
}

fn square([x, y]: Point, text: f32, color: Color, canvas: &mut dyn Canvas) {
    let half = 0.4 * text;
    canvas.rectangle([[x - half, y - half], [x + half, y + half]], color);
}

/// A legend arranged for the width of a picture.
pub(crate) struct Legend {
    symbols: Vec<Symbol>,
    /// Width of the scale, in pixels.
    bar: f32,
    /// Center of the first symbol, relative to the upper left corner of the legend.
    first: Point,
    /// Number of symbols in a column.
    rows: usize,
    /// Distance of each column of symbols from the first.
    columns: Vec<f32>,
    /// Height in pixels.
    pub(crate) height: f32,
}

/// Distance of the symbols of a column, relative to the height of text.
const ROW: f32 = 1.35;

impl Legend {
    /// Arranges symbols beside the scale of colors, in at most two columns, or below the scale if the width has no room for the
    /// columns. `text` is the height of text, and `measure` returns the width of a text by its height, all in pixels.
    pub(crate) fn new(
        symbols: Vec<Symbol>,
        width: f32,
        text: f32,
        measure: &dyn Fn(f32, &str) -> f32,
    ) -> Self {
        let bar = (0.45 * width).max(20.0 * text).min(width);
        let name = |symbol: &Symbol| measure(0.8 * text, symbol.name());
        // The distance of each column from the first, and the width of all.
        let spread = |rows: usize| {
            let (mut columns, mut x, mut end) = (Vec::new(), 0.0, 0.0);
            for column in symbols.chunks(rows) {
                let widest = column.iter().map(name).fold(0.0, f32::max);
                columns.push(x);
                end = x + 1.3 * text + widest;
                x = end + 2.7 * text;
            }
            (columns, end)
        };
        let rows = symbols.len().div_ceil(2).max(3);
        let first = [bar + 2.0 * text, 0.7 * text];
        let (columns, end) = spread(rows);
        if first[0] + end <= width {
            return Self { symbols, bar, first, rows, columns, height: 5.2 * text };
        }
        let first = [0.7 * text, 4.0 * text];
        let fits = |rows: &usize| first[0] + spread(*rows).1 <= width;
        let most = symbols.len().max(1);
        let rows = (1..=most).find(fits).unwrap_or(most);
        let (columns, _) = spread(rows);
        let height = first[1] + ROW * text * rows as f32;
        Self { symbols, bar, first, rows, columns, height }
    }

    /// Draws the legend with its upper left corner at `corner`.
    pub(crate) fn draw(
        &self,
        colors: ColorScale,
        corner: Point,
        text: f32,
        canvas: &mut dyn Canvas,
    ) {
        self.draw_scale(colors, corner, text, canvas);
        for (i, symbol) in self.symbols.iter().enumerate() {
            let x = corner[0] + self.first[0] + self.columns[i / self.rows];
            let y = corner[1] + self.first[1] + ROW * text * (i % self.rows) as f32;
            symbol.sign()([x, y], text, canvas);
            let at = [x + 1.3 * text, y + 0.3 * text];
            canvas.text(at, 0.8 * text, Anchor::Start, symbol.name());
        }
    }

    /// Draws the name of the measure, the colors, and their values.
    fn draw_scale(
        &self,
        colors: ColorScale,
        [left, top]: Point,
        text: f32,
        canvas: &mut dyn Canvas,
    ) {
        let (definition, bar) = (colors.measure().definition(), self.bar);
        let (high, small) = (text, 0.8 * text);
        let ideal = format!("{}{}", short(definition.ideal), definition.unit);
        let name = format!("{}, {ideal} is best", definition.name);
        canvas.text([left, top], small, Anchor::Start, &name);
        let upper = top + 0.4 * text;
        let steps = 128;
        for step in 0..steps {
            let [from, to] = [step, step + 1].map(|i| left + bar * i as f32 / steps as f32);
            let color = color::of_goodness((step as f32 + 0.5) / steps as f32);
            // Steps overlap by a pixel to leave no seams.
            let to = if step + 1 < steps { to + 1.0 } else { to };
            canvas.rectangle([[from, upper], [to, upper + high]], color);
        }
        let ticks = colors.ticks();
        let (mut free, last) = (left, ticks.len().saturating_sub(1));
        let end = left + bar - ticks.last().map_or(0.0, |tick| canvas.width(small, &tick.1));
        for (i, (value, name)) in ticks.iter().enumerate() {
            let x = left + bar * colors.goodness(*value);
            let mark = [[x, upper + high], [x, upper + high + 0.25 * text]];
            canvas.lines(&[mark], (text / 16.0).max(0.8), BLACK, 1.0);
            let width = canvas.width(small, name);
            let (start, anchor) = match i {
                0 => (x, Anchor::Start),
                i if i == last => (end, Anchor::End),
                _ => (x - width / 2.0, Anchor::Middle),
            };
            // A label without room between its neighbors is left out, but not those of the ends.
            let gap = 0.3 * text;
            if i == 0 || i == last || (start >= free + gap && start + width + gap <= end) {
                canvas.text([x, upper + high + 1.15 * text], small, anchor, name);
                free = start + width;
            }
        }
    }
}
