//! Rasterization of triangles, for meshes of any size.

use crate::render::picture::canvas::Point;
use crate::render::picture::color::of_goodness;

/// The goodness of each pixel in a rectangle. A pixel covered by several triangles keeps the lowest value.
pub(crate) struct Raster {
    pub(crate) left: i32,
    pub(crate) top: i32,
    pub(crate) width: usize,
    pub(crate) height: usize,
    goodness: Vec<f32>,
}

impl Raster {
    /// Makes a raster of all pixels that the rectangle touches.
    pub(crate) fn new([[left, top], [right, bottom]]: [Point; 2]) -> Self {
        let (left, top) = (left.floor() as i32, top.floor() as i32);
        let size = |from: i32, to: f32| (to.ceil() as i32 - from).max(1) as usize;
        let (width, height) = (size(left, right), size(top, bottom));
        Self { left, top, width, height, goodness: vec![f32::INFINITY; width * height] }
    }

    /// Fills the pixels whose centers lie in a triangle. If the triangle contains no center, the pixel at its centroid
    /// is filled.
    pub(crate) fn fill(&mut self, corners: [Point; 3], goodness: f32) {
        let [p, q, r] = corners.map(|[x, y]| [x - self.left as f32, y - self.top as f32]);
        let least = |axis: usize| p[axis].min(q[axis]).min(r[axis]);
        let most = |axis: usize| p[axis].max(q[axis]).max(r[axis]);
        // Rows whose center lines lie between the lowest and the highest corner.
        let first = (least(1) - 0.5).ceil().max(0.0) as usize;
        let end = ((most(1) - 0.5).floor() + 1.0).clamp(0.0, self.height as f32) as usize;
        let mut met = false;
        for row in first..end {
            let y = row as f32 + 0.5;
            let (mut from, mut to) = (f32::INFINITY, f32::NEG_INFINITY);
            for [a, b] in [[p, q], [q, r], [r, p]] {
                if (a[1] <= y) != (b[1] <= y) {
                    let x = a[0] + (b[0] - a[0]) * ((y - a[1]) / (b[1] - a[1]));
                    (from, to) = (from.min(x), to.max(x));
                }
            }
            let start = (from - 0.5).ceil().max(0.0) as usize;
            let stop = ((to - 0.5).floor() + 1.0).clamp(0.0, self.width as f32) as usize;
            for column in start..stop {
                self.put(column, row, goodness);
                met = true;
            }
        }
        if !met {
            let [x, y] = [0, 1].map(|axis| (p[axis] + q[axis] + r[axis]) / 3.0);
            if x >= 0.0 && y >= 0.0 {
                self.put(x as usize, y as usize, goodness);
            }
        }
    }

    fn put(&mut self, column: usize, row: usize, goodness: f32) {
        if column < self.width && row < self.height {
            let pixel = &mut self.goodness[row * self.width + column];
            *pixel = pixel.min(goodness);
        }
    }

    /// Returns the goodness of each pixel row by row; infinite at pixels without a triangle.
    pub(crate) fn goodness(&self) -> impl Iterator<Item = f32> + '_ {
        self.goodness.iter().copied()
    }

    /// Returns the pixels row by row, each as red, green, blue and opacity.
    pub(crate) fn pixels(&self) -> impl Iterator<Item = [u8; 4]> + '_ {
        self.goodness.iter().map(|&goodness| match goodness.is_finite() {
            true => {
                let [r, g, b] = of_goodness(goodness);
                [r, g, b, 255]
            }
            false => [0; 4],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_side_by_side_leave_no_gap() {
        let mut raster = Raster::new([[3.0, 5.0], [13.0, 15.0]]);
        let (a, b, c, d) = ([3.0, 5.0], [13.0, 5.0], [13.0, 15.0], [3.0, 15.0]);
        let middle = [7.3, 11.9];
        for (edge, goodness) in [([a, b], 0.1), ([b, c], 0.2), ([c, d], 0.3), ([d, a], 0.4)] {
            raster.fill([edge[0], edge[1], middle], goodness);
        }
        assert!(raster.pixels().all(|pixel| pixel[3] == 255));
        let at = |x: usize, y: usize| raster.goodness[(y - 5) * 10 + x - 3];
        assert_eq!([at(8, 5), at(12, 10), at(8, 14), at(3, 10)], [0.1, 0.2, 0.3, 0.4]);
    }

    #[test]
    fn the_worst_of_small_triangles_shows() {
        let mut raster = Raster::new([[0.0, 0.0], [4.0, 4.0]]);
        let small = |x: f32| [[x, 1.1], [x + 0.2, 1.1], [x, 1.2]];
        for (x, goodness) in [(1.1, 0.9), (1.3, 0.2), (1.6, 0.8)] {
            raster.fill(small(x), goodness);
        }
        assert_eq!(raster.goodness[5], 0.2);
        assert_eq!(raster.pixels().filter(|pixel| pixel[3] > 0).count(), 1);
        // Triangles outside, or with corners that are not finite, draw nothing.
        for x in [-5.0, 99.0, f32::NAN, f32::INFINITY] {
            raster.fill([[x, -9.0], [x, 99.0], [x, 1.0]], 0.0);
        }
        assert_eq!(raster.pixels().filter(|pixel| pixel[3] > 0).count(), 1);
    }
}
