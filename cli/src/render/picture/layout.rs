//! Positions of the parts of a picture.

use crate::render::picture::canvas::Point;
use crate::render::picture::legend::Legend;

/// Bounding box of a mesh in the plane.
#[derive(Clone, Copy)]
pub(crate) struct Extent {
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
}

impl Extent {
    /// Returns the bounding box of the vertices of all lists of triangles at all given sets of positions. Points that
    /// are not finite are ignored.
    pub(crate) fn of(triangles: [&[[u32; 3]]; 2], all: &[&[[f64; 2]]]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for points in all {
            let vertices = triangles.into_iter().flat_map(<[_]>::as_flattened);
            for &[x, y] in vertices.map(|&v| &points[v as usize]) {
                if x.is_finite() && y.is_finite() {
                    low = [low[0].min(x), low[1].min(y)];
                    high = [high[0].max(x), high[1].max(y)];
                }
            }
        }
        Self { low, high }
    }

    /// Returns the rectangle between two opposite corners.
    pub(crate) fn between([p, q]: [[f64; 2]; 2]) -> Self {
        let of = |choose: fn(f64, f64) -> f64| [0, 1].map(|axis| choose(p[axis], q[axis]));
        Self { low: of(f64::min), high: of(f64::max) }
    }

    /// Returns whether a point lies in the rectangle.
    pub(crate) fn has(&self, point: [f64; 2]) -> bool {
        [0, 1].into_iter().all(|axis| (self.low[axis]..=self.high[axis]).contains(&point[axis]))
    }

    /// Returns whether all points are at one place, or no point is finite.
    pub(crate) fn is_point(&self) -> bool {
        // Smaller extents have no scale in double precision.
        [0, 1].into_iter().all(|axis| self.high[axis] - self.low[axis] < 1e-290)
    }

    /// Returns width and height. A smaller side than a thousandth of the larger side is enlarged to a thousandth. An extent
    /// that [is a point](Self::is_point) has the size 1.
    pub(crate) fn size(&self) -> [f64; 2] {
        if self.is_point() {
            return [1.0; 2];
        }
        let size = [0, 1].map(|axis| self.high[axis] - self.low[axis]);
        let least = 1e-3 * size[0].max(size[1]);
        size.map(|x| x.max(least))
    }
}

/// Map from the plane to a rectangle of the picture, with y upward and equal axes.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    /// Upper left and lower right corners of the rectangle, in pixels.
    pub(crate) corners: [Point; 2],
    middle: [f64; 2],
    /// Pixel coordinates of `middle`.
    center: [f64; 2],
    /// Pixels per unit of the plane, equal for both axes.
    pub(crate) scale: f64,
}

impl Frame {
    /// Makes a frame that centers the extent in a rectangle, as large as possible.
    pub(crate) fn new(extent: Extent, [[left, top], [right, bottom]]: [[f64; 2]; 2]) -> Self {
        let [width, height] = extent.size();
        let scale = ((right - left) / width).min((bottom - top) / height);
        let center = [(left + right) / 2.0, (top + bottom) / 2.0];
        let half = [width * scale / 2.0, height * scale / 2.0];
        let corner = |sign: f64| [0, 1].map(|axis| (center[axis] + sign * half[axis]) as f32);
        let middle = [0, 1].map(|axis| extent.low[axis] / 2.0 + extent.high[axis] / 2.0);
        Self { corners: [corner(-1.0), corner(1.0)], middle, center, scale }
    }

    /// Makes a frame for a rectangle of the picture, centered at a point of the plane.
    pub(crate) fn around(middle: [f64; 2], scale: f64, corners: [Point; 2]) -> Self {
        let center = [0, 1].map(|axis| f64::from(corners[0][axis] + corners[1][axis]) / 2.0);
        Self { corners, middle, center, scale }
    }

    #[inline]
    pub(crate) fn place(&self, [x, y]: [f64; 2]) -> Point {
        let x = self.center[0] + (x - self.middle[0]) * self.scale;
        let y = self.center[1] - (y - self.middle[1]) * self.scale;
        [x as f32, y as f32]
    }
}

/// Positions of a mesh, its title and its insets.
pub(crate) struct Place {
    pub(crate) frame: Frame,
    /// Start of the title's first line, on the base line.
    pub(crate) title: Point,
    /// Width for the title, in pixels.
    pub(crate) width: f32,
    /// Rectangles for enlarged parts of the mesh; empty without insets.
    pub(crate) insets: Vec<[Point; 2]>,
}

/// Positions of a picture's parts, in pixels.
pub(crate) struct Layout {
    pub(crate) size: [u32; 2],
    /// Height of text in pixels.
    pub(crate) text: f32,
    pub(crate) panels: Vec<Place>,
    /// Upper left corner of the legend, and its parts.
    pub(crate) legend: (Point, Legend),
}

/// The parts around the meshes of a picture.
#[derive(Clone, Copy)]
pub(crate) struct Room<'a> {
    /// Most insets below each mesh. A narrow panel has fewer.
    pub(crate) insets: usize,
    /// Number of lines below the first line of each heading.
    pub(crate) lines: usize,
    /// Arranges the legend for a width and a height of text in pixels.
    pub(crate) legend: &'a dyn Fn(f32, f32) -> Legend,
}

/// Height of the lines below the first line of a heading, relative to the height of text, and their distance.
pub(crate) const SMALL: f32 = 0.85;
pub(crate) const LINE: f32 = 1.1;

/// Least width of an inset, relative to the height of text.
const LEAST_INSET: f64 = 7.0;

/// Largest height of a mesh in a panel, relative to the width of the picture.
const HIGHEST: f64 = 1.2;

/// Aspect ratio (height by width) below which panels are stacked vertically instead of placed in a row.
const WIDE: f64 = 0.4;

/// Height of an inset, relative to its width.
const INSET: f64 = 0.65;

impl Layout {
    /// Lays out `count` panels with a common extent, each with a row of insets. `width` is the width of the picture in
    /// pixels.
    pub(crate) fn new(extent: Extent, count: usize, room: Room<'_>, width: u32) -> Self {
        let full = f64::from(width);
        let text = (full / 62.0).max(11.0);
        let further = f64::from(LINE) * room.lines.saturating_sub(1) as f64;
        let (margin, title) = (text, (3.4 + further) * text);
        let legend = (room.legend)((full - 2.0 * margin) as f32, text as f32);
        let [mesh_width, mesh_height] = extent.size();
        let aspect = mesh_height / mesh_width;
        let columns = if aspect < WIDE { 1 } else { count.max(1) };
        let panel_width = (full - margin * (columns as f64 + 1.0)) / columns as f64;
        let mesh_height = (panel_width * aspect).clamp(4.0 * text, HIGHEST * full);
        let most = ((panel_width + margin) / (LEAST_INSET * text + margin)) as usize;
        let insets = room.insets.min(most.max(1));
        let inset_width =
            (panel_width - margin * (insets.max(1) as f64 - 1.0)) / insets.max(1) as f64;
        let inset_height = if insets > 0 { INSET * inset_width } else { 0.0 };
        let inset_row = if insets > 0 { inset_height + margin } else { 0.0 };
        let panel_height = title + mesh_height + inset_row + margin;
        let place = |i: usize| {
            let (row, column) = ((i / columns) as f64, (i % columns) as f64);
            let left = margin + column * (panel_width + margin);
            let top = margin + row * panel_height;
            let bottom = top + title + mesh_height;
            let frame = Frame::new(extent, [[left, top + title], [left + panel_width, bottom]]);
            let inset = |k: usize| {
                let left = left + k as f64 * (inset_width + margin);
                let top = bottom + margin;
                [[left, top], [left + inset_width, top + inset_height]].map(|p| p.map(|x| x as f32))
            };
            let title = [left as f32, (top + text) as f32];
            let width = panel_width as f32;
            Place { frame, title, width, insets: (0..insets).map(inset).collect() }
        };
        let below = count.div_ceil(columns) as f64 * panel_height + 1.5 * margin;
        Self {
            size: [width, (below + f64::from(legend.height)).ceil() as u32],
            text: text as f32,
            panels: (0..count).map(place).collect(),
            legend: ([margin as f32, below as f32], legend),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lays out panels with up to `insets` insets and the simplest legend.
    fn layout(extent: Extent, count: usize, insets: usize, width: u32) -> Layout {
        let legend = |width, text| Legend::new(Vec::new(), width, text, &|_, _| 0.0);
        Layout::new(extent, count, Room { insets, lines: 1, legend: &legend }, width)
    }

    #[test]
    fn a_mesh_is_upright_with_equal_axes_and_fits() {
        for (width, height) in [(3.0, 1.0), (1.0, 4.0), (1e-9, 2e-9), (5e90, 0.0)] {
            for count in [1, 2] {
                for size in [800, 4000] {
                    let extent = Extent { low: [7.0 * width, -height], high: [8.0 * width, 0.0] };
                    let layout = layout(extent, count, 3, size);
                    assert_eq!(layout.panels.len(), count);
                    for panel in &layout.panels {
                        let frame = panel.frame;
                        let lowest = panel.insets[2][1];
                        assert!(lowest[0] <= size as f32 && lowest[1] <= layout.legend.0[1]);
                        let [[left, top], [right, bottom]] = frame.corners;
                        assert!(left >= 0.0 && top >= 0.0 && right <= size as f32);
                        assert!(bottom <= panel.insets[0][0][1]);
                        let low = frame.place(extent.low);
                        let high = frame.place(extent.high);
                        assert!(low[0] < high[0] && (height == 0.0 || low[1] > high[1]));
                        let [across, along] = [high[0] - low[0], low[1] - high[1]].map(f64::from);
                        assert!(
                            (along * width - across * height).abs()
                                <= 1e-3 * across * width.max(height)
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn wide_panels_are_stacked() {
        let layout =
            |height: f64| layout(Extent { low: [0.0; 2], high: [1.0, height] }, 2, 0, 1000);
        let titles = |height| layout(height).panels.iter().map(|p| p.title).collect::<Vec<_>>();
        let [first, second] = titles(0.2)[..] else { panic!() };
        assert!(first[0] == second[0] && first[1] < second[1]);
        let [first, second] = titles(1.5)[..] else { panic!() };
        assert!(first[0] < second[0] && first[1] == second[1]);
    }
}
