//! Drawing of meshes and their legend on a canvas.

use std::collections::HashSet;

use crate::color_scale::ColorScale;
use crate::render::picture::arrows;
use crate::render::picture::canvas::{Anchor, Canvas, Point};
use crate::render::picture::color::{self, BAD, BLACK, NEUTRAL, UNJUDGED, WHITE};
use crate::render::picture::faces::FixedFaces;
use crate::render::picture::layout::{Extent, Frame, Layout, Place};
use crate::render::picture::outlines::{Outlines, inner_edges};
use crate::terminal::numbers::{fit8, short};

/// A mesh at one set of positions, with the goodness shown by colors.
pub(crate) struct Panel<'a> {
    /// Two lines of text above the mesh.
    pub(crate) title: [String; 2],
    pub(crate) points: &'a [[f64; 2]],
    /// Goodness of each triangle from 0 to 1, negative if inverted or flat.
    pub(crate) goodness: Vec<f32>,
    /// The worst triangles with their values, worst first.
    pub(crate) worst: Vec<(usize, f64)>,
}

/// The content of a picture: panels of one mesh, with outlines and legend.
pub(crate) struct Scene<'a> {
    pub(crate) colors: ColorScale,
    pub(crate) triangles: &'a [[u32; 3]],
    /// The drawn part of the plane; `None` for the whole mesh.
    pub(crate) part: Option<Extent>,
    /// Whether panels show, by arrows, how far vertices have moved since the first panel.
    pub(crate) with_arrows: bool,
    pub(crate) faces: FixedFaces,
    pub(crate) outlines: Outlines,
    pub(crate) panels: Vec<Panel<'a>>,
}

/// Smallest altitude, in pixels, of triangles whose edges are drawn. Edges are darker from twice and from four times
/// this altitude.
const LEAST_HEIGHT: f32 = 3.0;

/// Number of worst triangles that are marked and enlarged.
const MARKED: usize = 3;

impl Scene<'_> {
    /// Lays out the panels, with insets if a marked triangle is too small to be visible without.
    pub(crate) fn layout(&self, width: u32) -> Layout {
        let all: Vec<&[[f64; 2]]> = self.panels.iter().map(|panel| panel.points).collect();
        let extent =
            self.part.unwrap_or_else(|| Extent::of([self.triangles, &self.faces.pieces], &all));
        let plain = Layout::new(extent, self.panels.len(), 0, width);
        let is_small = |(panel, place): (&Panel<'_>, &Place)| {
            let spots = self.spots(panel, &place.frame, plain.text);
            let length = |t: usize| self.longest_edge(panel, t) * place.frame.scale;
            spots.iter().any(|&(t, _)| length(t) < 2.0 * f64::from(plain.text))
        };
        match self.panels.iter().zip(&plain.panels).any(is_small) {
            true => Layout::new(extent, self.panels.len(), MARKED, width),
            false => plain,
        }
    }

    pub(crate) fn draw(&self, layout: &Layout, canvas: &mut dyn Canvas) {
        let text = layout.text;
        for (panel, place) in self.panels.iter().zip(&layout.panels) {
            match self.part {
                None => self.draw_mesh(panel, &place.frame, text, canvas),
                Some(_) => {
                    canvas.clip(Some(place.frame.corners));
                    self.draw_mesh(panel, &place.frame, text, canvas);
                    canvas.clip(None);
                    around(place.frame.corners, text, canvas);
                }
            }
            let spots = self.spots(panel, &place.frame, text);
            let marks: Vec<Point> =
                spots.iter().map(|&(t, _)| place.frame.place(self.middle(panel, t))).collect();
            marks.iter().for_each(|&at| worst(at, text, canvas));
            // Numbers are drawn after all rings, so that no ring hides a number.
            for (number, at) in (1..).zip(marks) {
                // Near the right end of the picture or of the drawn part, the number is placed left of the mark.
                let end = match self.part {
                    Some(_) => place.frame.corners[1][0],
                    None => layout.size[0] as f32,
                };
                let is_last = at[0] + 2.0 * text > end;
                let (aside, anchor) = match is_last {
                    true => (-0.85 * text, Anchor::End),
                    false => (0.85 * text, Anchor::Start),
                };
                let beside = [at[0] + aside, at[1] - 0.5 * text];
                canvas.text(beside, 0.8 * text, anchor, &number.to_string());
            }
            for (i, (&corners, &(t, value))) in place.insets.iter().zip(&spots).enumerate() {
                let [[left, top], [right, _]] = corners;
                // An inset shows some seven triangles across, and is larger in scale than the whole mesh.
                let scale = f64::from(right - left) / (7.0 * self.longest_edge(panel, t));
                let scale = if scale.is_finite() { scale } else { place.frame.scale };
                let scale = scale.max(2.5 * place.frame.scale);
                let frame = Frame::around(self.middle(panel, t), scale, corners);
                canvas.clip(Some(corners));
                self.draw_mesh(panel, &frame, text, canvas);
                self.outline(panel, t, &frame, text, canvas);
                canvas.clip(None);
                around(corners, text, canvas);
                scale_bar(&frame, text, canvas);
                let measure = self.colors.measure();
                let unit = measure.definition().unit;
                let name = format!("{}: {measure} {}{unit}", i + 1, fit8(value));
                canvas.text(
                    [left + 0.5 * text, top + 1.2 * text],
                    0.8 * text,
                    Anchor::Start,
                    &name,
                );
            }
            let [x, y] = place.title;
            let name = end_within(&panel.title[0], place.width, text, canvas);
            canvas.text([x, y], text, Anchor::Start, &name);
            canvas.text([x, y + 1.25 * text], 0.85 * text, Anchor::Start, &panel.title[1]);
        }
        self.draw_legend(layout, canvas);
    }

    /// Returns the worst triangles whose marks do not overlap.
    fn spots(&self, panel: &Panel<'_>, frame: &Frame, text: f32) -> Vec<(usize, f64)> {
        let mut spots: Vec<(usize, f64, Point)> = Vec::new();
        for &(t, value) in &panel.worst {
            let at = frame.place(self.middle(panel, t));
            let apart = |other: &Point| (other[0] - at[0]).hypot(other[1] - at[1]) > 2.0 * text;
            if spots.len() < MARKED && spots.iter().all(|spot| apart(&spot.2)) {
                spots.push((t, value, at));
            }
        }
        spots.into_iter().map(|(t, value, _)| (t, value)).collect()
    }

    fn middle(&self, panel: &Panel<'_>, t: usize) -> [f64; 2] {
        let corners = self.triangles[t].map(|v| panel.points[v as usize]);
        [0, 1].map(|axis| corners.iter().map(|corner| corner[axis] / 3.0).sum())
    }

    /// Returns the length of a triangle's longest edge, in units of the mesh.
    fn longest_edge(&self, panel: &Panel<'_>, t: usize) -> f64 {
        let [p, q, r] = self.triangles[t].map(|v| panel.points[v as usize]);
        let length = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
        length(p, q).max(length(q, r)).max(length(r, p))
    }

    /// Outlines a triangle: a black line on a white one.
    fn outline(
        &self,
        panel: &Panel<'_>,
        t: usize,
        frame: &Frame,
        text: f32,
        canvas: &mut dyn Canvas,
    ) {
        let corners = self.triangles[t].map(|v| frame.place(panel.points[v as usize]));
        let sides = [0, 1, 2].map(|i: usize| [corners[i], corners[(i + 1) % 3]]);
        canvas.lines(&sides, text / 5.0, WHITE, 1.0);
        canvas.lines(&sides, text / 10.0, BLACK, 1.0);
    }

    fn draw_mesh(&self, panel: &Panel<'_>, frame: &Frame, text: f32, canvas: &mut dyn Canvas) {
        let place = |v: u32| frame.place(panel.points[v as usize]);
        let shown = |points: &[Point]| is_shown(points, frame.corners, text);
        let placed =
            self.triangles.iter().map(|t| t.map(place)).zip(panel.goodness.iter().copied());
        let pieces = self.faces.pieces.iter().map(|piece| (piece.map(place), UNJUDGED));
        let mut faces = placed.chain(pieces).filter(|face| shown(&face.0));
        canvas.faces(frame.corners, &mut faces, self.triangles.len() + self.faces.pieces.len());

        let mut edges: [Vec<[Point; 2]>; 3] = Default::default();
        let of_triangles = inner_edges(self.triangles).map(|(t, edge)| (self.triangles[t], edge));
        let of_faces =
            self.faces.edges.iter().map(|edge| (self.faces.pieces[edge.piece], edge.ends));
        for (triangle, edge) in of_triangles.chain(of_faces) {
            let height = least_height(triangle.map(place));
            let edge = edge.map(place);
            if height >= LEAST_HEIGHT && shown(&edge) {
                let class = ((height / LEAST_HEIGHT).log2() as usize).min(2);
                edges[class].push(edge);
            }
        }
        let thin = (text / 30.0).max(0.5);
        for (segments, opacity) in edges.iter().zip([0.15, 0.3, 0.5]) {
            canvas.lines(segments, thin, BLACK, opacity);
        }
        let placed = |edges: &[[u32; 2]]| {
            let placed = edges.iter().map(|edge| edge.map(place));
            placed.filter(|edge| shown(edge)).collect::<Vec<_>>()
        };
        between_regions(&placed(&self.outlines.between_regions), text, canvas);
        canvas.lines(&placed(&self.outlines.boundary), boundary_width(text), BLACK, 1.0);
        // At most one mark per small square, so that dense marks do not hide the mesh below.
        let mut taken = HashSet::new();
        if self.with_arrows {
            let before = self.panels[0].points.iter().map(|&point| frame.place(point));
            let after = panel.points.iter().map(|&point| frame.place(point));
            let ways = before.zip(after).map(|(from, to)| [from, to]);
            arrows::draw(ways.filter(|way| shown(way)), text, canvas);
        }
        let square = |at: Point| at.map(|x| (x / (0.45 * text)) as i32);
        let places = self.outlines.held.iter().map(|&v| place(v)).filter(|at| shown(&[*at]));
        places.filter(|&at| taken.insert(square(at))).for_each(|at| held(at, text, canvas));
        let places = self.outlines.slid.iter().map(|&v| place(v)).filter(|at| shown(&[*at]));
        places.filter(|&at| taken.insert(square(at))).for_each(|at| slid(at, text, canvas));
    }

    fn draw_legend(&self, layout: &Layout, canvas: &mut dyn Canvas) {
        let (([left, top], width), text) = (layout.legend, layout.text);
        let definition = self.colors.measure().definition();
        let bar = (0.45 * width).max(20.0 * text).min(width);
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
        for (value, name) in self.colors.ticks() {
            let x = left + bar * self.colors.goodness(value);
            let mark = [[x, upper + high], [x, upper + high + 0.25 * text]];
            canvas.lines(&[mark], (text / 16.0).max(0.8), BLACK, 1.0);
            let anchor = match x {
                x if x <= left => Anchor::Start,
                x if x >= left + bar => Anchor::End,
                _ => Anchor::Middle,
            };
            canvas.text([x, upper + high + 1.15 * text], small, anchor, &name);
        }
        self.draw_signs(layout, [left + bar + 2.0 * text, upper], canvas);
    }

    /// Draws the legend of lines and marks that occur, in two columns beside the scale.
    fn draw_signs(&self, layout: &Layout, [left, top]: Point, canvas: &mut dyn Canvas) {
        let (text, small) = (layout.text, 0.8 * layout.text);
        type Sign = fn(Point, f32, &mut dyn Canvas);
        let boundary: Sign = |[x, y], text, canvas| {
            let line = [[x - 0.7 * text, y], [x + 0.7 * text, y]];
            canvas.lines(&[line], boundary_width(text), BLACK, 1.0);
        };
        let between: Sign = |[x, y], text, canvas| {
            between_regions(&[[[x - 0.7 * text, y], [x + 0.7 * text, y]]], text, canvas);
        };
        let bad: Sign = |[x, y], text, canvas| {
            let half = 0.4 * text;
            canvas.rectangle([[x - half, y - half], [x + half, y + half]], BAD);
        };
        let face: Sign = |[x, y], text, canvas| {
            let half = 0.4 * text;
            canvas.rectangle([[x - half, y - half], [x + half, y + half]], NEUTRAL);
        };
        let is_bad = |panel: &Panel<'_>| panel.goodness.iter().any(|&goodness| goodness < 0.0);
        let signs = [
            (true, boundary, "boundary"),
            (!self.outlines.between_regions.is_empty(), between, "between regions"),
            (!self.outlines.held.is_empty(), held as Sign, "fixed vertex inside"),
            (!self.outlines.slid.is_empty(), slid as Sign, "vertex that slid"),
            (!self.faces.is_empty(), face, self.faces.name().unwrap_or_default()),
            (self.panels.iter().any(is_bad), bad, "inverted or flat"),
            (
                self.panels.iter().any(|panel| !panel.worst.is_empty()),
                worst as Sign,
                "worst triangles",
            ),
            (self.with_arrows, moved as Sign, "displacement"),
        ];
        let signs: Vec<_> = signs.into_iter().filter(|sign| sign.0).collect();
        let rows = signs.len().div_ceil(2).max(3);
        let [mut x, mut y] = [left, top + 0.3 * text];
        let mut widest: f32 = 0.0;
        for (i, (_, sign, name)) in signs.into_iter().enumerate() {
            if i == rows {
                x += widest + 4.0 * text;
                y = top + 0.3 * text;
            }
            sign([x, y], text, canvas);
            canvas.text([x + 1.3 * text, y + 0.3 * text], small, Anchor::Start, name);
            widest = widest.max(canvas.width(small, name));
            y += 1.35 * text;
        }
    }
}

fn boundary_width(text: f32) -> f32 {
    (text / 14.0).max(1.0)
}

/// Draws edges between regions: a white line on a black one.
fn between_regions(segments: &[[Point; 2]], text: f32, canvas: &mut dyn Canvas) {
    canvas.lines(segments, (text / 5.0).max(3.5), BLACK, 1.0);
    canvas.lines(segments, (text / 12.0).max(1.5), WHITE, 1.0);
}

/// Draws a frame around an inset, or around the drawn part of a mesh.
fn around([[left, top], [right, bottom]]: [Point; 2], text: f32, canvas: &mut dyn Canvas) {
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
    let sides = [0, 1, 2, 3].map(|i: usize| [corners[i], corners[(i + 1) % 4]]);
    canvas.lines(&sides, text / 16.0, BLACK, 1.0);
}

/// Draws a bar of a round length, with the length in units of the mesh, at the lower left of an inset.
fn scale_bar(frame: &Frame, text: f32, canvas: &mut dyn Canvas) {
    let [[left, top], [right, bottom]] = frame.corners;
    let Some(length) = round_length(f64::from(right - left) / (3.0 * frame.scale)) else { return };
    let (width, y) = ((length * frame.scale) as f32, bottom - 0.6 * text);
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

/// Returns the end of a text that is at most `width` pixels wide. Dots replace the beginning.
fn end_within(name: &str, width: f32, size: f32, canvas: &dyn Canvas) -> String {
    let mut shown = name.to_owned();
    let mut rest = name.chars();
    while canvas.width(size, &shown) > width && rest.next().is_some() {
        shown = format!("...{}", rest.as_str());
    }
    shown
}

/// Returns whether points, or segments between them, may be visible in a rectangle, with a margin of `text` pixels.
fn is_shown(points: &[Point], corners: [Point; 2], text: f32) -> bool {
    let beyond = |axis: usize| {
        points.iter().all(|point| point[axis] < corners[0][axis] - text)
            || points.iter().all(|point| point[axis] > corners[1][axis] + text)
    };
    !beyond(0) && !beyond(1)
}

/// Draws an example of a displacement arrow for the legend.
fn moved([x, y]: Point, text: f32, canvas: &mut dyn Canvas) {
    arrows::draw(std::iter::once([[x - 0.7 * text, y], [x + 0.7 * text, y]]), text, canvas);
}

/// Draws a vertex that must not move.
fn held(at: Point, text: f32, canvas: &mut dyn Canvas) {
    canvas.disc(at, text / 6.5, BLACK);
    canvas.disc(at, text / 12.0, WHITE);
}

/// Draws a vertex that slid along its line.
fn slid(at: Point, text: f32, canvas: &mut dyn Canvas) {
    canvas.disc(at, text / 6.5, WHITE);
    canvas.disc(at, text / 9.0, BLACK);
}

/// Draws a mark around a bad triangle.
fn worst(at: Point, text: f32, canvas: &mut dyn Canvas) {
    canvas.ring(at, 0.6 * text, text / 4.0, WHITE);
    canvas.ring(at, 0.6 * text, text / 10.0, BLACK);
}

/// Returns the smallest altitude of a triangle.
fn least_height([p, q, r]: [Point; 3]) -> f32 {
    let to = |p: Point, q: Point| [q[0] - p[0], q[1] - p[1]];
    let (a, b, c) = (to(p, q), to(p, r), to(q, r));
    let longest = [a, b, c].map(|[x, y]| x.hypot(y)).into_iter().fold(0.0, f32::max);
    (a[0] * b[1] - a[1] * b[0]).abs() / longest
}
