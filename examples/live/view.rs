//! Map between the mesh's plane and the pixels of the window.

/// Margin around the mesh, in pixels.
const MARGIN: f64 = 24.0;

/// Position of the mesh in the window: as large as the area below the panel allows, with equal
/// scales in x and y.
#[derive(Clone, Copy)]
pub(crate) struct View {
    size: [f64; 2],
    /// The point of the plane shown at `middle`, which is in pixels from the upper left corner.
    center: [f64; 2],
    middle: [f64; 2],
    pixels_per_unit: f64,
}

impl View {
    pub(crate) fn new(points: &[[f64; 2]], size: [u32; 2], panel_height: u32) -> Self {
        let [[left, right], [bottom, top]] = [0, 1].map(|x| {
            let low = points.iter().map(|p| p[x]).fold(f64::INFINITY, f64::min);
            [low, points.iter().map(|p| p[x]).fold(f64::NEG_INFINITY, f64::max)]
        });
        let size = size.map(f64::from);
        // In a window not much higher than the panel, the mesh is shown behind the panel.
        let above = Some(f64::from(panel_height)).filter(|&h| h < size[1] / 2.0).unwrap_or(0.0);
        let room = [size[0], size[1] - above].map(|side| (side - 2.0 * MARGIN).max(1.0));
        Self {
            size,
            center: [(left + right) / 2.0, (bottom + top) / 2.0],
            middle: [size[0] / 2.0, (size[1] + above) / 2.0],
            pixels_per_unit: (room[0] / (right - left)).min(room[1] / (top - bottom)),
        }
    }

    pub(crate) fn to_pixels(self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = [0, 1].map(|i| (point[i] - self.center[i]) * self.pixels_per_unit);
        [self.middle[0] + x, self.middle[1] - y]
    }

    pub(crate) fn to_plane(self, pixel: [f64; 2]) -> [f64; 2] {
        let [x, y] = [0, 1].map(|i| (pixel[i] - self.middle[i]) / self.pixels_per_unit);
        [self.center[0] + x, self.center[1] - y]
    }

    /// Returns scale and offset from the plane to clip space, and the size of a pixel in clip
    /// space.
    pub(crate) fn uniform(self) -> [[f32; 2]; 3] {
        let pixel = self.size.map(|side| 2.0 / side);
        let scale = pixel.map(|p| p * self.pixels_per_unit);
        let origin = self.to_pixels([0.0, 0.0]);
        let offset = [origin[0] * pixel[0] - 1.0, 1.0 - origin[1] * pixel[1]];
        [scale, offset, pixel].map(|pair| pair.map(|x| x as f32))
    }
}
