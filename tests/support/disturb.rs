//! Deterioration of meshes without inverted triangles.

use super::Mesh;
use super::check::{held, imr, is_ccw, orient, squared_distance};
use super::generate::lattice;
use super::rng::SplitMix64;
use super::trig::sin_turns;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Largest inverse mean ratio caused by a move of [`perturb_random`]. The probability of a triangle flatter than some
/// bound falls only as the inverse of the bound. Without a limit, the flattest triangle and f_imr would depend on luck
/// and on the number of vertices.
const WORST: f64 = 1000.0;

/// Fraction of the way to the random target that a vertex moves at strength 1. A fraction of 1 would leave a flat
/// triangle at nearly every vertex.
const FARTHEST: f64 = 0.7;

/// Moves each free vertex in turn toward a random point of its star. If a move inverts a triangle, half of the move is
/// tried, then a quarter, and so on. Strength 0.5 raises f_imr to approximately 1.3. Strength 1 raises it to well over
/// 100, mostly by a few nearly flat triangles. The mesh must be wound counterclockwise.
pub fn perturb_random(mesh: &Mesh, strength: f64, seed: u64) -> Mesh {
    let mut rng = SplitMix64::new(seed);
    let (held, stars) = (held(mesh), Stars::new(mesh));
    let mut moved = mesh.clone();
    for v in (0..mesh.points.len()).filter(|&v| !held[v]) {
        let (star, from) = (stars.of(v), moved.points[v]);
        let [a, b, c] =
            moved.triangles[star[rng.below(star.len())] as usize].map(|w| moved.points[w as usize]);
        let (mut s, mut t) = (rng.unit(), rng.unit());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        let goal = [0, 1].map(|x| a[x] + s * (b[x] - a[x]) + t * (c[x] - a[x]));
        let mut step = FARTHEST * strength * strength;
        for _ in 0..20 {
            moved.points[v] = [0, 1].map(|x| from[x] + step * (goal[x] - from[x]));
            let fits = |&t: &u32| {
                let corners = moved.triangles[t as usize].map(|w| moved.points[w as usize]);
                imr(corners) <= WORST
            };
            if star.iter().all(fits) {
                break;
            }
            moved.points[v] = from;
            step /= 2.0;
        }
    }
    moved
}

/// Triangles by vertex.
struct Stars {
    start: Vec<usize>,
    triangles: Vec<u32>,
}

impl Stars {
    fn new(mesh: &Mesh) -> Self {
        let mut start = vec![0; mesh.points.len() + 1];
        mesh.triangles.iter().flatten().for_each(|&v| start[v as usize + 1] += 1);
        for v in 1..start.len() {
            start[v] += start[v - 1];
        }
        let mut next = start.clone();
        let mut triangles = vec![0; 3 * mesh.triangles.len()];
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            for &v in triangle {
                triangles[next[v as usize]] = i as u32;
                next[v as usize] += 1;
            }
        }
        Self { start, triangles }
    }

    fn of(&self, v: usize) -> &[u32] {
        &self.triangles[self.start[v]..self.start[v + 1]]
    }
}

/// Displaces interior vertices by a few long waves that fade toward held vertices. An `amplitude` of 1 would flatten
/// the first triangle. The mesh must be wound counterclockwise.
pub fn distort_smooth(mesh: &Mesh, amplitude: f64) -> Mesh {
    let [[left, width], [bottom, height]] = [0, 1].map(|x| {
        let low = mesh.points.iter().map(|p| p[x]).fold(f64::INFINITY, f64::min);
        let high = mesh.points.iter().map(|p| p[x]).fold(f64::NEG_INFINITY, f64::max);
        [low, high - low]
    });
    let distance = distance_to_held(mesh);
    let farthest = distance.iter().fold(f64::MIN_POSITIVE, |a, &b| a.max(b));
    let waves = mesh.points.iter().zip(distance).map(|(&[x, y], distance)| {
        let (u, v) = ((x - left) / width, (y - bottom) / height);
        // The weight is 0 with slope 0 at held vertices, and 1 with slope 0 in the middle.
        let near = distance / farthest;
        let weight = near * near * (3.0 - 2.0 * near);
        let across = sin_turns(1.3 * v + 0.1) + 0.6 * sin_turns(2.1 * u + 0.9 * v);
        let along = sin_turns(1.1 * u + 0.4) - 0.6 * sin_turns(1.7 * v - 1.2 * u);
        [weight * width * across, weight * height * along]
    });
    let waves: Vec<_> = waves.collect();
    let flattens = mesh
        .triangles
        .iter()
        .map(|&t| flattens_at(t.map(|v| mesh.points[v as usize]), t.map(|v| waves[v as usize])));
    let mut step = amplitude * flattens.fold(f64::INFINITY, f64::min);
    assert!(step.is_finite(), "no vertex may move");
    loop {
        let mut moved = mesh.clone();
        for (point, wave) in moved.points.iter_mut().zip(&waves) {
            *point = [point[0] + step * wave[0], point[1] + step * wave[1]];
        }
        // At amplitudes close to 1, rounding may have flattened a triangle.
        if moved.triangles.iter().all(|t| orient(t.map(|v| moved.points[v as usize])) > 0.0) {
            return moved;
        }
        step *= 0.99;
    }
}

/// Returns the smallest factor of the waves at which the triangle becomes flat; infinite if there is none.
fn flattens_at([p, q, r]: [[f64; 2]; 3], [a, b, c]: [[f64; 2]; 3]) -> f64 {
    let minus = |u: [f64; 2], v: [f64; 2]| [u[0] - v[0], u[1] - v[1]];
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let (e, f, de, df) = (minus(q, p), minus(r, p), minus(b, a), minus(c, a));
    // Twice the area is `area + slope t + bend t^2`; the smallest positive root is sought.
    let (area, slope, bend) = (cross(e, f), cross(e, df) + cross(de, f), cross(de, df));
    let discriminant = slope * slope - 4.0 * bend * area;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    // Both roots, by the formula without cancellation.
    let half = -(slope + discriminant.sqrt().copysign(slope)) / 2.0;
    [half / bend, area / half].into_iter().filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min)
}

/// Returns the approximate distance from each vertex to the nearest held vertex. Only the held vertices nearest to a
/// vertex's neighbors are considered.
fn distance_to_held(mesh: &Mesh) -> Vec<f64> {
    let stars = Stars::new(mesh);
    let held = held(mesh);
    let mut squared = vec![f64::INFINITY; mesh.points.len()];
    // The queue is ordered by distance: the bits of positive floats are ordered like the floats.
    let mut queue: BinaryHeap<_> =
        (0..squared.len()).filter(|&v| held[v]).map(|v| Reverse((0u64, v, v))).collect();
    while let Some(Reverse((bits, v, source))) = queue.pop() {
        if f64::from_bits(bits) >= squared[v] {
            continue;
        }
        squared[v] = f64::from_bits(bits);
        for &w in stars.of(v).iter().flat_map(|&t| &mesh.triangles[t as usize]) {
            let candidate = squared_distance(mesh.points[w as usize], mesh.points[source]);
            if candidate < squared[w as usize] {
                queue.push(Reverse((candidate.to_bits(), w as usize, source)));
            }
        }
    }
    squared.into_iter().map(f64::sqrt).collect()
}

/// Makes a lattice in which a vertex lies extremely near to an opposite edge. By exact predicates the triangle of both
/// is counterclockwise, but its area computed in double precision is not positive.
pub fn beyond_double_precision() -> Mesh {
    let mut mesh = lattice(8, 8);
    // The free vertex in row 4, column 4, and the edge between two of its neighbors to the right.
    let [v, p, q] = [4 * 9 + 4, 4 * 9 + 5, 5 * 9 + 4];
    let middle = [0, 1].map(|i| (mesh.points[p][i] + mesh.points[q][i]) / 2.0);
    for point in &mut mesh.points {
        let [x, y] = [point[0] - middle[0], point[1] - middle[1]];
        *point = [0.96 * x - 0.28 * y, 0.28 * x + 0.96 * y];
    }
    // Near the origin, coordinates have a finer resolution than differences to the ends of the edge.
    for k in 1..100 {
        mesh.points[v] = [0, 1].map(|i| mesh.points[p][i] * 1e-3 * f64::from(k));
        while !is_ccw(&mesh) {
            mesh.points[v][0] = mesh.points[v][0].next_down();
        }
        let [p, q, v] = [p, q, v].map(|v| mesh.points[v]);
        let is_flat = |[p, q, r]: [[f64; 2]; 3]| {
            (q[0] - p[0]) * (r[1] - p[1]) <= (q[1] - p[1]) * (r[0] - p[0])
        };
        if [[v, p, q], [p, q, v], [q, v, p]].into_iter().all(is_flat) {
            return mesh;
        }
    }
    panic!("every triangle has a positive area")
}
