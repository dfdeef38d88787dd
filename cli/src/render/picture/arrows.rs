//! Arrows from the old to the new positions of vertices.

use std::collections::HashSet;

use crate::render::picture::canvas::{Canvas, Point};
use crate::render::picture::color::{BLACK, WHITE};

/// Length in pixels of the shortest move that gets an arrow.
const SHORTEST: f32 = 2.0;

/// Draws arrows for the moves of vertices, each given by start and end. In each small square, only the first arrow is
/// drawn, so that the mesh below remains visible.
pub(super) fn draw(ways: impl Iterator<Item = [Point; 2]>, text: f32, canvas: &mut dyn Canvas) {
    let mut taken = HashSet::new();
    let square = |at: Point| at.map(|x| (x / (0.6 * text)) as i32);
    let is_long = |[from, to]: &[Point; 2]| (to[0] - from[0]).hypot(to[1] - from[1]) >= SHORTEST;
    let ways = ways.filter(is_long).filter(|way| taken.insert(square(way[0])));
    let segments: Vec<[Point; 2]> = ways.flat_map(|way| arrow(way, text)).collect();
    canvas.lines(&segments, (text / 5.0).max(3.0), WHITE, 0.8);
    canvas.lines(&segments, (text / 14.0).max(1.2), BLACK, 1.0);
}

/// Returns the segments of an arrow: the shaft and two strokes of the head.
fn arrow([from, to]: [Point; 2], text: f32) -> [[Point; 2]; 3] {
    let way = [to[0] - from[0], to[1] - from[1]];
    let length = way[0].hypot(way[1]);
    let head = (0.35 * length).min(0.4 * text);
    let [x, y] = way.map(|along| along / length * head);
    // Each stroke goes back along the shaft, and half that distance sideways.
    let stroke = |side: f32| [to, [to[0] - x - side * y, to[1] - y + side * x]];
    [[from, to], stroke(0.5), stroke(-0.5)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_head_is_at_the_end_and_opens_backward() {
        let [shaft, left, right] = arrow([[0.0, 0.0], [10.0, 0.0]], 100.0);
        assert_eq!(shaft, [[0.0, 0.0], [10.0, 0.0]]);
        assert_eq!([left, right], [[[10.0, 0.0], [6.5, 1.75]], [[10.0, 0.0], [6.5, -1.75]]]);
    }
}
