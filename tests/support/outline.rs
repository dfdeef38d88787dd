//! Outlines of domains, and their text format (`meshes/*.outline`).
//!
//! One entry a row; `#` starts a comment.
//!
//! ```text
//! loop                  starts a closed loop: the edge of the domain or, inside another, of a hole
//! line                  starts an open line of edges inside the domain, whose vertices are fixed
//! X Y                   the next point of the loop or line
//! curve N               from the next point on: a smooth curve through the points, N chords between two.
//!                       Another `curve` starts anew, so that the curve has a corner there
//! straight              from the next point on: straight again
//! arc X Y R FROM TO N   within a loop or line: N chords of a circle, both ends included, angles in degrees
//! circle X Y R N        a loop of its own, of N chords
//! vertex X Y            a lone fixed vertex inside the domain
//! ```

use super::trig::on_circle;

type Point = [f64; 2];

/// A domain: all points enclosed by an odd number of loops.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// Closed polygons in either winding. An implicit segment joins the last point to the first.
    pub loops: Vec<Vec<Point>>,
    /// Open lines inside the domain, whose segments become edges.
    pub lines: Vec<Vec<Point>>,
    /// Isolated vertices inside the domain.
    pub vertices: Vec<Point>,
}

impl Outline {
    /// Parses the text format. The error names the first invalid line and the problem.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut outline = Self::default();
        let mut open: Option<Path> = None;
        for (i, row) in text.lines().enumerate() {
            let row = row.split('#').next().unwrap_or_default();
            let mut words = row.split_whitespace();
            let Some(first) = words.next() else { continue };
            let at = |problem: String| format!("line {}: {problem}", i + 1);
            let (keyword, numbers) = match first.parse::<f64>() {
                Ok(_) => ("", row.split_whitespace()),
                Err(_) => (first, words),
            };
            let numbers = numbers
                .map(|word| match word.parse::<f64>() {
                    Ok(number) if number.is_finite() => Ok(number),
                    _ => Err(at(format!("'{word}' is not a number"))),
                })
                .collect::<Result<Vec<_>, _>>()?;
            match (keyword, &numbers[..]) {
                ("loop" | "line", []) => {
                    outline.close(open.replace(Path::new(keyword == "loop"))).map_err(at)?;
                }
                ("circle", &[x, y, r, n]) => {
                    outline.close(open.take()).map_err(at)?;
                    let n = chords(n).map_err(at)?;
                    outline
                        .loops
                        .push((0..n).map(|i| around([x, y], r, i as f64 / n as f64)).collect());
                }
                ("vertex", &[x, y]) => outline.vertices.push([x, y]),
                ("" | "curve" | "straight" | "arc", numbers) => {
                    let path =
                        open.as_mut().ok_or_else(|| at("no 'loop' or 'line' is open".into()))?;
                    path.row(keyword, numbers).map_err(at)?;
                }
                _ => return Err(at(format!("cannot make sense of '{}'", row.trim()))),
            }
        }
        outline.close(open).map_err(|problem| format!("last line: {problem}"))?;
        if outline.loops.is_empty() { Err("it has no loop".into()) } else { Ok(outline) }
    }

    fn close(&mut self, path: Option<Path>) -> Result<(), String> {
        let Some(path) = path else { return Ok(()) };
        let (least, list) = if path.closed { (3, &mut self.loops) } else { (2, &mut self.lines) };
        if path.points.len() < least {
            return Err(format!("the loop or line before has fewer than {least} points"));
        }
        list.push(path.sampled());
        Ok(())
    }

    /// Returns the area of the domain, provided that no loops cross.
    pub fn area(&self) -> f64 {
        let areas = self.loops.iter().enumerate().map(|(i, ring)| {
            // A loop inside an odd number of other loops is a hole, so its area is subtracted.
            let others = self.loops.iter().enumerate().filter(|(j, _)| *j != i);
            let depth = others.filter(|(_, other)| encloses(other, ring[0])).count();
            let area = edges(ring).map(|[p, q]| p[0] * q[1] - p[1] * q[0]).sum::<f64>().abs() / 2.0;
            if depth % 2 == 0 { area } else { -area }
        });
        areas.sum()
    }

    /// Returns whether a point lies in the domain. For points on a loop, the result is arbitrary.
    pub fn contains(&self, point: Point) -> bool {
        self.loops.iter().filter(|ring| encloses(ring, point)).count() % 2 == 1
    }
}

fn edges(ring: &[Point]) -> impl Iterator<Item = [Point; 2]> + '_ {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(&p, &q)| [p, q])
}

/// Returns whether a horizontal ray to the right of the point crosses the ring an odd number of times.
fn encloses(ring: &[Point], [x, y]: Point) -> bool {
    let crosses = |[p, q]: &[Point; 2]| {
        (p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
    };
    edges(ring).filter(crosses).count() % 2 == 1
}

fn around([x, y]: Point, r: f64, turns: f64) -> Point {
    let [cos, sin] = on_circle(turns);
    [x + r * cos, y + r * sin]
}

fn chords(n: f64) -> Result<usize, String> {
    if n.fract() == 0.0 && (1.0..=1e6).contains(&n) {
        Ok(n as usize)
    } else {
        Err(format!("{n} is no number of chords"))
    }
}

/// A loop or line during parsing. Each piece, from a point to the next, belongs to a section. A section is either
/// straight, or a smooth curve.
struct Path {
    closed: bool,
    points: Vec<Point>,
    section_of: Vec<usize>,
    /// Number of chords per piece, for each section.
    chords: Vec<usize>,
}

impl Path {
    fn new(closed: bool) -> Self {
        Self { closed, points: Vec::new(), section_of: Vec::new(), chords: vec![1] }
    }

    fn push(&mut self, point: Point) {
        self.points.push(point);
        self.section_of.push(self.chords.len() - 1);
    }

    fn row(&mut self, keyword: &str, numbers: &[f64]) -> Result<(), String> {
        match (keyword, numbers) {
            ("", &[x, y]) => self.push([x, y]),
            ("straight", []) => self.chords.push(1),
            ("curve", &[n]) => self.chords.push(chords(n)?),
            ("arc", &[x, y, r, from, to, n]) => {
                let (n, before) = (chords(n)?, self.chords.len() - 1);
                self.chords.push(1);
                for i in 0..=n {
                    if i == n {
                        self.chords.push(self.chords[before]);
                    }
                    self.push(around(
                        [x, y],
                        r,
                        (from + (to - from) * i as f64 / n as f64) / 360.0,
                    ));
                }
            }
            ("", _) => return Err("a point is two numbers".into()),
            _ => return Err(format!("'{keyword}' has the wrong number of numbers")),
        }
        Ok(())
    }

    /// Returns the points of the polygon: given points, and sampled points of curves.
    fn sampled(&self) -> Vec<Point> {
        let n = self.points.len();
        let pieces = if self.closed { n } else { n - 1 };
        let mut sampled = Vec::new();
        for i in 0..pieces {
            let (next, section) = ((i + 1) % n, self.section_of[i]);
            let (p, q) = (self.points[i], self.points[next]);
            let mirrored =
                |about: Point, point: Point| [2.0 * about[0] - point[0], 2.0 * about[1] - point[1]];
            // Beyond the end of a section, a mirrored point continues the curve.
            let smooth_with = |piece: usize| piece < pieces && self.section_of[piece] == section;
            let last = (i + n - 1) % n;
            let before = if smooth_with(last) { self.points[last] } else { mirrored(p, q) };
            let after =
                if smooth_with(next) { self.points[(next + 1) % n] } else { mirrored(q, p) };
            let chords = self.chords[section];
            sampled.push(p);
            sampled.extend(
                (1..chords).map(|k| catmull_rom([before, p, q, after], k as f64 / chords as f64)),
            );
        }
        if !self.closed {
            sampled.extend(self.points.last());
        }
        sampled
    }
}

/// Returns the point at `t` in 0...1 on the Catmull-Rom curve from the second to the third of four points.
fn catmull_rom([a, b, c, d]: [Point; 4], t: f64) -> Point {
    [0, 1].map(|x| {
        let (first, second) = (c[x] - a[x], 2.0 * a[x] - 5.0 * b[x] + 4.0 * c[x] - d[x]);
        let third = 3.0 * (b[x] - c[x]) + d[x] - a[x];
        b[x] + t * (first + t * (second + t * third)) / 2.0
    })
}
