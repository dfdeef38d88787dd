//! Drawing of meshes on a canvas, with headings and enlarged triangles.

use std::collections::HashSet;

use crate::color_scale::ColorScale;
use crate::render::picture::arrows;
use crate::render::picture::canvas::{Anchor, Canvas, Point};
use crate::render::picture::color::{BETWEEN_EDGES, BLACK, UNJUDGED, WHITE, of_goodness};
use crate::render::picture::faces::FixedFaces;
use crate::render::picture::font::Font;
use crate::render::picture::heading::{end_within, wrapped};
use crate::render::picture::layout::{Extent, Frame, LINE, Layout, Place, Room, SMALL};
use crate::render::picture::legend::{Legend, Symbol};
use crate::render::picture::marks::{
    around, between_regions, boundary_width, held, ring_number, scale_bar, slid, worst,
};
use crate::render::picture::outlines::{Outlines, inner_edges};
use crate::terminal::numbers::fit8;

/// A mesh at one set of positions, with the goodness shown by colors.
pub(crate) struct Panel<'a> {
    /// Two texts above the mesh. The second one is broken into lines if the panel is narrow.
    pub(crate) title: [String; 2],
    pub(crate) points: &'a [[f64; 2]],
    /// Goodness of each triangle from 0 to 1, negative if inverted or flat.
    pub(crate) goodness: Vec<f32>,
    /// The edges between elements that colors show; empty if colors show elements.
    pub(crate) edges: Vec<ColoredEdge>,
    /// The worst triangles or edges, worst first.
    pub(crate) worst: Vec<Spot>,
}

/// An edge between two elements, with the goodness shown by its color.
pub(crate) struct ColoredEdge {
    pub(crate) ends: [u32; 2],
    /// The numbers of the two elements, triangles first.
    pub(crate) elements: [u32; 2],
    /// Goodness from 0 to 1.
    pub(crate) goodness: f32,
}

/// One of the worst triangles or edges.
#[derive(Clone)]
pub(crate) struct Spot {
    /// The corners of a triangle, or the ends of an edge.
    pub(crate) corners: Vec<u32>,
    pub(crate) value: f64,
}

impl Spot {
    /// Returns the edges of the triangle, or the edge.
    fn sides(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let count = if self.corners.len() == 2 { 1 } else { self.corners.len() };
        (0..count).map(|i| [self.corners[i], self.corners[(i + 1) % self.corners.len()]])
    }

    /// Returns the length of the longest edge.
    fn size(&self, points: &[[f64; 2]]) -> f64 {
        let ends = self.sides().map(|side| side.map(|v| points[v as usize]));
        ends.map(|[p, q]| (q[0] - p[0]).hypot(q[1] - p[1])).fold(0.0, f64::max)
    }
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

/// Returns the mean of some vertices, given the points of all vertices.
pub(crate) fn middle(corners: &[u32], points: &[[f64; 2]]) -> [f64; 2] {
    let count = corners.len() as f64;
    [0, 1].map(|axis| corners.iter().map(|&v| points[v as usize][axis] / count).sum())
}

/// Smallest altitude, in pixels, of triangles whose edges are drawn. Edges are darker from twice and from four times
/// this altitude.
const LEAST_HEIGHT: f32 = 3.0;

/// Number of worst triangles or edges that are marked and enlarged.
const MARKED: usize = 3;

/// Number of steps to which the goodness of edges is rounded for their colors.
const EDGE_COLORS: u8 = 64;

impl Scene<'_> {
    /// Lays out the panels, with insets if a marked triangle is too small to be visible without. `font` measures texts.
    pub(crate) fn layout(&self, width: u32, font: &Font) -> Layout {
        let all: Vec<&[[f64; 2]]> = self.panels.iter().map(|panel| panel.points).collect();
        let extent =
            self.part.unwrap_or_else(|| Extent::of([self.triangles, &self.faces.pieces], &all));
        let symbols = self.symbols();
        let new = |insets, lines| {
            let legend = |width, text| {
                Legend::new(symbols.clone(), width, text, &|size, name| font.width(size, name))
            };
            Layout::new(extent, self.panels.len(), Room { insets, lines, legend: &legend }, width)
        };
        let plain = new(0, 1);
        let (text, places) = (plain.text, &plain.panels);
        let lines = |(panel, place): (&Panel<'_>, &Place)| {
            let measure = |line: &str| font.width(SMALL * text, line);
            wrapped(&panel.title[1], place.width, &measure).len()
        };
        let lines = self.panels.iter().zip(places).map(lines).max().unwrap_or(1);
        let is_small = |(panel, place): (&Panel<'_>, &Place)| {
            let spots = spots(panel, &place.frame, text);
            let length = |spot: &Spot| spot.size(panel.points) * place.frame.scale;
            spots.iter().any(|spot| length(spot) < 2.0 * f64::from(text))
        };
        let insets = match self.panels.iter().zip(places).any(is_small) {
            true => MARKED,
            false => 0,
        };
        new(insets, lines)
    }

    pub(crate) fn draw(&self, layout: &Layout, canvas: &mut dyn Canvas) {
        for (panel, place) in self.panels.iter().zip(&layout.panels) {
            self.draw_panel(panel, place, layout, canvas);
        }
        let (corner, legend) = &layout.legend;
        legend.draw(self.colors, *corner, layout.text, canvas);
    }

    fn draw_panel(
        &self,
        panel: &Panel<'_>,
        place: &Place,
        layout: &Layout,
        canvas: &mut dyn Canvas,
    ) {
        let (frame, text) = (&place.frame, layout.text);
        let spots = spots(panel, frame, text);
        let marks: Vec<Point> =
            spots.iter().map(|spot| frame.place(middle(&spot.corners, panel.points))).collect();
        if self.part.is_some() {
            canvas.clip(Some(frame.corners));
        }
        self.draw_mesh(panel, frame, text, canvas);
        marks.iter().for_each(|&at| worst(at, text, canvas));
        let mut bounds = [[0.0; 2], layout.size.map(|x| x as f32)];
        if self.part.is_some() {
            canvas.clip(None);
            around(frame.corners, text, canvas);
            bounds = frame.corners;
        }
        // Numbers are drawn after all rings, so that no ring hides a number.
        for (number, at) in (1..).zip(marks) {
            ring_number(number, at, bounds, text, canvas);
        }
        for (i, (&corners, spot)) in place.insets.iter().zip(&spots).enumerate() {
            let [[left, _], [right, _]] = corners;
            // An inset shows some seven triangles across, and is larger in scale than the whole mesh.
            let scale = f64::from(right - left) / (7.0 * spot.size(panel.points));
            let scale = if scale.is_finite() { scale } else { frame.scale };
            let scale = scale.max(2.5 * frame.scale);
            let frame = Frame::around(middle(&spot.corners, panel.points), scale, corners);
            canvas.clip(Some(corners));
            self.draw_mesh(panel, &frame, text, canvas);
            match spot.corners.len() {
                // An outline would hide the color of the edge.
                2 => worst(frame.place(middle(&spot.corners, panel.points)), text, canvas),
                _ => outline(spot, panel, &frame, text, canvas),
            }
            canvas.clip(None);
            around(corners, text, canvas);
            scale_bar(corners, scale, text, canvas);
            draw_name(&self.inset_name(i + 1, spot.value), corners, text, canvas);
        }
        draw_heading(&panel.title, place, text, canvas);
    }

    /// Returns the name of the faces without a color of the measure; `None` if there are none.
    fn unjudged_faces(&self) -> Option<&'static str> {
        let measure = self.colors.measure();
        let judges_all = !measure.is_of_edges() && measure.of_quadrilateral();
        if judges_all { self.faces.unjudged() } else { self.faces.name() }
    }

    /// Returns the lines and marks that occur, for the legend.
    fn symbols(&self) -> Vec<Symbol> {
        let Outlines { between_regions, held, slid, .. } = &self.outlines;
        let is_bad = |panel: &Panel<'_>| panel.goodness.iter().any(|&goodness| goodness < 0.0);
        let has_worst = self.panels.iter().any(|panel| !panel.worst.is_empty());
        let occurs = |occurs: bool, symbol: Symbol| occurs.then_some(symbol);
        let is_of_edges = self.colors.measure().is_of_edges();
        let name = match (is_of_edges, self.faces.unjudged() == self.faces.name()) {
            (true, _) => "worst edges",
            (false, true) => "worst triangles",
            (false, false) => "worst elements",
        };
        let symbols = [
            Some(Symbol::Boundary),
            occurs(!between_regions.is_empty(), Symbol::BetweenRegions),
            occurs(!held.is_empty(), Symbol::Held),
            occurs(!slid.is_empty(), Symbol::Slid),
            self.unjudged_faces().map(Symbol::Face),
            occurs(self.panels.iter().any(is_bad), Symbol::Bad),
            occurs(has_worst, Symbol::Worst(name)),
            occurs(self.with_arrows, Symbol::Displacement),
        ];
        symbols.into_iter().flatten().collect()
    }

    /// Returns the forms of the name of an enlarged triangle, longest first.
    fn inset_name(&self, number: usize, value: f64) -> [String; 2] {
        let measure = self.colors.measure();
        let value = format!("{}{}", fit8(value), measure.definition().unit);
        [format!("{number}: {measure} {value}"), format!("{number}: {value}")]
    }

    fn draw_mesh(&self, panel: &Panel<'_>, frame: &Frame, text: f32, canvas: &mut dyn Canvas) {
        let place = |v: u32| frame.place(panel.points[v as usize]);
        let shown = |points: &[Point]| is_shown(points, frame.corners, text);
        // Between colored edges, triangles are pale unless they are too small for edges to be drawn.
        let color = |(corners, goodness): ([Point; 3], f32)| {
            let is_pale =
                !panel.edges.is_empty() && goodness >= 0.0 && least_height(corners) >= LEAST_HEIGHT;
            (corners, if is_pale { BETWEEN_EDGES } else { goodness })
        };
        let placed = self.triangles.iter().map(|t| t.map(place));
        let placed = placed.zip(panel.goodness.iter().copied()).map(color);
        let triangles = self.triangles.len();
        let goodness = |piece: usize| match panel.edges.is_empty() {
            true => self.faces.goodness(piece, triangles, &panel.goodness),
            false => UNJUDGED,
        };
        let pieces = self.faces.pieces.iter().enumerate();
        let pieces = pieces.map(|(k, piece)| (piece.map(place), goodness(k)));
        let mut faces = placed.chain(pieces).filter(|face| shown(&face.0));
        canvas.faces(frame.corners, &mut faces, self.triangles.len() + self.faces.pieces.len());

        let mut edges: [Vec<[Point; 2]>; 3] = Default::default();
        let inner = inner_edges(self.triangles).filter(|_| panel.edges.is_empty());
        let of_triangles = inner.map(|(t, edge)| (self.triangles[t], edge));
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
        self.draw_colored_edges(panel, frame, text, canvas);
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

    /// Draws the colored edges of quadrilaterals and of triangles that are high enough, bad edges above good ones.
    fn draw_colored_edges(
        &self,
        panel: &Panel<'_>,
        frame: &Frame,
        text: f32,
        canvas: &mut dyn Canvas,
    ) {
        let place = |v: u32| frame.place(panel.points[v as usize]);
        let is_high = |element: u32| {
            let triangle = self.triangles.get(element as usize);
            triangle.is_none_or(|t| least_height(t.map(place)) >= LEAST_HEIGHT)
        };
        let mut classes = vec![Vec::new(); usize::from(EDGE_COLORS) + 1];
        for ColoredEdge { ends, elements, goodness } in &panel.edges {
            let edge = ends.map(place);
            if is_shown(&edge, frame.corners, text) && elements.iter().any(|&t| is_high(t)) {
                classes[(goodness * f32::from(EDGE_COLORS)).round() as usize].push(edge);
            }
        }
        for (class, segments) in (0..=EDGE_COLORS).zip(&classes).rev() {
            let color = of_goodness(f32::from(class) / f32::from(EDGE_COLORS));
            canvas.lines(segments, (text / 8.0).max(1.5), color, 1.0);
        }
    }
}

/// Returns the worst triangles or edges whose marks do not overlap.
fn spots(panel: &Panel<'_>, frame: &Frame, text: f32) -> Vec<Spot> {
    let mut spots: Vec<(Spot, Point)> = Vec::new();
    for spot in &panel.worst {
        let at = frame.place(middle(&spot.corners, panel.points));
        let apart = |other: &Point| (other[0] - at[0]).hypot(other[1] - at[1]) > 2.0 * text;
        if spots.len() < MARKED && spots.iter().all(|spot| apart(&spot.1)) {
            spots.push((spot.clone(), at));
        }
    }
    spots.into_iter().map(|(spot, _)| spot).collect()
}

/// Outlines a triangle: a black line on a white one.
fn outline(spot: &Spot, panel: &Panel<'_>, frame: &Frame, text: f32, canvas: &mut dyn Canvas) {
    let place = |v: u32| frame.place(panel.points[v as usize]);
    let sides: Vec<[Point; 2]> = spot.sides().map(|side| side.map(place)).collect();
    canvas.lines(&sides, text / 5.0, WHITE, 1.0);
    canvas.lines(&sides, text / 10.0, BLACK, 1.0);
}

/// Writes the heading of a mesh: a line that is shortened to the width of the panel, and lines that are broken.
fn draw_heading(title: &[String; 2], place: &Place, text: f32, canvas: &mut dyn Canvas) {
    let [x, y] = place.title;
    let name = end_within(&title[0], place.width, &|name| canvas.width(text, name));
    canvas.text([x, y], text, Anchor::Start, &name);
    let small = SMALL * text;
    let lines = wrapped(&title[1], place.width, &|line| canvas.width(small, line));
    for (i, line) in (0u16..).zip(lines) {
        let y = y + 1.25 * text + LINE * text * f32::from(i);
        canvas.text([x, y], small, Anchor::Start, &line);
    }
}

/// Writes the first of some names that fits an inset, or the last one in smaller letters.
fn draw_name(
    names: &[String; 2],
    [[left, top], [right, _]]: [Point; 2],
    text: f32,
    canvas: &mut dyn Canvas,
) {
    let (size, width) = (0.8 * text, right - left - text);
    let [long, short] = names;
    let name = if canvas.width(size, long) <= width { long } else { short };
    let size = size * (width / canvas.width(size, name)).min(1.0);
    canvas.text([left + 0.5 * text, top + 1.2 * text], size, Anchor::Start, name);
}

/// Returns whether points, or segments between them, may be visible in a rectangle, with a margin of `text` pixels.
fn is_shown(points: &[Point], corners: [Point; 2], text: f32) -> bool {
    let beyond = |axis: usize| {
        points.iter().all(|point| point[axis] < corners[0][axis] - text)
            || points.iter().all(|point| point[axis] > corners[1][axis] + text)
    };
    !beyond(0) && !beyond(1)
}

/// Returns the smallest altitude of a triangle.
fn least_height([p, q, r]: [Point; 3]) -> f32 {
    let to = |p: Point, q: Point| [q[0] - p[0], q[1] - p[1]];
    let (a, b, c) = (to(p, q), to(p, r), to(q, r));
    let longest = [a, b, c].map(|[x, y]| x.hypot(y)).into_iter().fold(0.0, f32::max);
    (a[0] * b[1] - a[1] * b[0]).abs() / longest
}
