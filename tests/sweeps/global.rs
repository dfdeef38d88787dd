//! Independent computation of optima: global methods on all free vertices at once, without code of the library.

use gpu_smooth::Mesh;
use support::check;

/// The coordinates of the free vertices as unknowns, alternately x and y.
struct Unknowns {
    /// Index of each vertex's x in the vector of unknowns; `None` for vertices that are not free.
    place: Vec<Option<usize>>,
    count: usize,
}

impl Unknowns {
    fn of(mesh: &Mesh) -> Self {
        let mut count = 0;
        let place = check::held(mesh).into_iter().map(|held| {
            (!held).then(|| {
                count += 2;
                count - 2
            })
        });
        let place = place.collect();
        Self { place, count }
    }

    fn take(&self, mesh: &Mesh) -> Vec<f64> {
        let mut x = vec![0.0; self.count];
        for (point, place) in mesh.points.iter().zip(&self.place) {
            if let &Some(i) = place {
                x[i..i + 2].copy_from_slice(point);
            }
        }
        x
    }

    fn put(&self, mesh: &Mesh, x: &[f64]) -> Mesh {
        let mut mesh = mesh.clone();
        for (point, place) in mesh.points.iter_mut().zip(&self.place) {
            if let &Some(i) = place {
                point.copy_from_slice(&x[i..i + 2]);
            }
        }
        mesh
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns y + t x.
fn plus(y: &[f64], t: f64, x: &[f64]) -> Vec<f64> {
    y.iter().zip(x).map(|(y, x)| y + t * x).collect()
}

/// Returns f by RMS: the mean squared RMS edge length, relative to that of the equilateral triangle of mean area.
pub(crate) fn f_rms(mesh: &Mesh) -> f64 {
    let count = mesh.triangles.len() as f64;
    let ideal = 4.0 * (check::area(mesh) / count) / 3f64.sqrt();
    let squares = mesh.triangles.iter().flat_map(|&t| check::edges(t)).map(|edge| {
        let [p, q] = edge.map(|v| mesh.points[v as usize]);
        check::squared_distance(p, q)
    });
    squares.sum::<f64>() / (3.0 * ideal * count)
}

/// Returns the mesh with the smallest f by RMS, in which each free vertex is the mean of its neighbors. Solves the
/// equations by conjugate gradients.
pub(crate) fn rms_optimum(mesh: &Mesh) -> Mesh {
    let unknowns = Unknowns::of(mesh);
    let edges: Vec<[u32; 2]> = check::edge_uses(mesh).into_keys().collect();
    // The gradient of half the sum of squared lengths with respect to the free coordinates `x`.
    let gradient = |x: &[f64]| {
        let at = unknowns.put(mesh, x);
        let mut g = vec![0.0; unknowns.count];
        for edge in &edges {
            let [p, q] = edge.map(|v| at.points[v as usize]);
            for (v, sign) in [(edge[0], 1.0), (edge[1], -1.0)] {
                if let Some(i) = unknowns.place[v as usize] {
                    g[i] += sign * (p[0] - q[0]);
                    g[i + 1] += sign * (p[1] - q[1]);
                }
            }
        }
        g
    };
    let constant = gradient(&vec![0.0; unknowns.count]);
    let mut x = unknowns.take(mesh);
    let mut r: Vec<f64> = gradient(&x).iter().map(|g| -g).collect();
    let first = dot(&r, &r);
    let mut p = r.clone();
    while dot(&r, &r) > 1e-26 * first {
        let ap = plus(&gradient(&p), -1.0, &constant);
        let (rr, step) = (dot(&r, &r), dot(&r, &r) / dot(&p, &ap));
        x = plus(&x, step, &p);
        r = plus(&r, -step, &ap);
        p = plus(&r, dot(&r, &r) / rr, &p);
    }
    unknowns.put(mesh, &x)
}

/// Returns f by IMR and its gradient; f is infinite if a triangle is not positive.
fn imr_and_gradient(mesh: &Mesh, unknowns: &Unknowns) -> (f64, Vec<f64>) {
    let count = mesh.triangles.len() as f64;
    let mut f = 0.0;
    let mut g = vec![0.0; unknowns.count];
    for &t in &mesh.triangles {
        let p = check::corners(mesh, t);
        let doubled =
            (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        if doubled <= 0.0 {
            return (f64::INFINITY, g);
        }
        let sides = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| check::squared_distance(p[i], p[j]));
        let q = sides.iter().sum::<f64>() / (2.0 * 3f64.sqrt() * doubled);
        f += q * q / count;
        for i in 0..3 {
            let Some(place) = unknowns.place[t[i] as usize] else { continue };
            let (next, last) = (p[(i + 1) % 3], p[(i + 2) % 3]);
            let of_area = [next[1] - last[1], last[0] - next[0]];
            for axis in 0..2 {
                let of_squares = 2.0 * (2.0 * p[i][axis] - next[axis] - last[axis]);
                let dq = (of_squares / (2.0 * 3f64.sqrt()) - q * of_area[axis]) / doubled;
                g[place + axis] += 2.0 * q * dq / count;
            }
        }
    }
    (f, g)
}

/// Returns the smallest f by IMR on a descent from `mesh`, and the mesh there. L-BFGS on all free vertices stops when
/// the largest entry of the gradient could not change f by 1e-12 over an edge.
pub(crate) fn imr_optimum(mesh: &Mesh) -> (f64, Mesh) {
    const MEMORY: usize = 30;
    let unknowns = Unknowns::of(mesh);
    let evaluate = |x: &[f64]| imr_and_gradient(&unknowns.put(mesh, x), &unknowns);
    let edge = (check::area(mesh) / mesh.triangles.len() as f64).sqrt();
    let mut x = unknowns.take(mesh);
    let (mut f, mut g) = evaluate(&x);
    let mut pairs: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for _ in 0..4000 {
        let steepest = g.iter().fold(0f64, |m, g| m.max(g.abs()));
        if steepest * edge < 1e-12 {
            break;
        }
        // The two-loop recursion of L-BFGS (Nocedal 1980).
        let mut d = g.clone();
        let mut weights = Vec::new();
        for (s, y) in pairs.iter().rev() {
            let weight = dot(s, &d) / dot(s, y);
            d = plus(&d, -weight, y);
            weights.push(weight);
        }
        let scale = match pairs.last() {
            Some((s, y)) => dot(s, y) / dot(y, y),
            None => 0.01 * edge / steepest,
        };
        d.iter_mut().for_each(|d| *d *= scale);
        for ((s, y), weight) in pairs.iter().zip(weights.into_iter().rev()) {
            d = plus(&d, weight - dot(y, &d) / dot(s, y), s);
        }
        let slope = -dot(&g, &d);
        let mut step = 1.0;
        let (mut to, mut there) = (plus(&x, -step, &d), (f64::INFINITY, Vec::new()));
        for _ in 0..40 {
            there = evaluate(&to);
            // Near the end, f falls by less than its rounding, so the gradient decides.
            if there.0 <= f + 1e-4 * step * slope + 1e-14 * f {
                break;
            }
            step *= 0.5;
            to = plus(&x, -step, &d);
        }
        let (s, y) = (plus(&to, -1.0, &x), plus(&there.1, -1.0, &g));
        if dot(&s, &y) > 0.0 {
            pairs.push((s, y));
            if pairs.len() > MEMORY {
                pairs.remove(0);
            }
        }
        (x, f, g) = (to, there.0, there.1);
    }
    (f, unknowns.put(mesh, &x))
}
