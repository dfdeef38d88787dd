//! The part of a line within a rectangle.

use crate::render::picture::canvas::Point;

/// Returns the part of a segment within a rectangle, by the method of Liang and Barsky (ACM Transactions on Graphics 3, 1984).
/// `None` if no part lies within, or if a coordinate is not finite.
pub(crate) fn clipped([from, to]: [Point; 2], [least, most]: [Point; 2]) -> Option<[Point; 2]> {
    let wide = |point: Point| point.map(f64::from);
    let (start, end) = (wide(from), wide(to));
    let way = [end[0] - start[0], end[1] - start[1]];
    let [mut first, mut last] = [0.0, 1.0];
    for axis in 0..2 {
        let [low, high] = [least, most].map(|corner| f64::from(corner[axis]) - start[axis]);
        let inside = low <= 0.0 && 0.0 <= high;
        if way[axis] == 0.0 && inside {
            continue;
        }
        let shares = [low / way[axis], high / way[axis]];
        first = f64::max(first, shares[0].min(shares[1]));
        last = f64::min(last, shares[0].max(shares[1]));
    }
    let is_finite = from.iter().chain(&to).all(|x| x.is_finite());
    let at = |share: f64, exact: Point| match share {
        0.0 | 1.0 => exact,
        _ => [0, 1].map(|axis| (start[axis] + share * way[axis]) as f32),
    };
    (is_finite && first <= last).then(|| [at(first, from), at(last, to)])
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: [Point; 2] = [[0.0, 0.0], [10.0, 20.0]];

    #[test]
    fn segments_end_at_the_rectangle() {
        let clip = |from: Point, to: Point| clipped([from, to], BOX);
        let inside = [[1.0, 2.0], [9.0, 19.5]];
        assert_eq!(clip(inside[0], inside[1]), Some(inside));
        assert_eq!(clip([-5.0, 5.0], [5.0, 5.0]), Some([[0.0, 5.0], [5.0, 5.0]]));
        assert_eq!(clip([5.0, 30.0], [5.0, -10.0]), Some([[5.0, 20.0], [5.0, 0.0]]));
        assert_eq!(clip([-10.0, 0.0], [10.0, 20.0]), Some([[0.0, 10.0], [10.0, 20.0]]));
        let far = clip([-4e9, 5.0], [4e9, 5.0]).unwrap();
        assert!(far[0][0].abs() < 1e-5 && (far[1][0] - 10.0).abs() < 1e-5, "{far:?}");
        assert_eq!(clip([1.0, 1.0], [1.0, 1.0]), Some([[1.0, 1.0]; 2]));
    }

    #[test]
    fn segments_outside_of_the_rectangle_vanish() {
        let clip = |from: Point, to: Point| clipped([from, to], BOX);
        assert_eq!(clip([-5.0, 5.0], [-1.0, 5.0]), None);
        assert_eq!(clip([-1.0, 19.0], [3.0, 25.0]), None);
        assert_eq!(clip([11.0, -5.0], [11.0, 30.0]), None);
        assert_eq!(clip([12.0, 12.0], [12.0, 12.0]), None);
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(clip([bad, 5.0], [5.0, 5.0]), None);
            assert_eq!(clip([5.0, 5.0], [5.0, bad]), None);
        }
    }
}
