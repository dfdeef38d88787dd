//! Target areas of triangles for untangling, on either engine.
//!
//! A vertex among sound triangles keeps the size that these triangles have. A boundary vertex without sound triangles
//! takes the size from its boundary edges. All other sizes are interpolated: first outward from known sizes, neighbor
//! by neighbor, then by averages over neighbors.

use glam::DVec2;

use crate::layout::Problem;
use crate::metric::of_right_angle;

/// Inverse mean ratio below which a triangle is sound. Only sound triangles determine sizes.
const SOUND: f64 = 10.0;

/// Number of rounds in which each interpolated size is averaged over the neighbors of its vertex.
const ROUNDS: usize = 20;

/// Returns the target area at each vertex, in normalized units. The target area of a triangle is the mean over its
/// vertices. Target areas of all triangles add up to the area that the boundary encloses.
pub(crate) fn target_areas(problem: &Problem, positions: &[DVec2]) -> Vec<f64> {
    let corners = problem.corners();
    let mut size = known(problem, positions);
    let free = problem.free_count();
    let mut interpolated = spread(corners.all(), &mut size);
    interpolated.retain(|&v| (v as usize) < free);
    let mut size: Vec<f64> = size.into_iter().map(|size| size.unwrap_or(0.0)).collect();
    for _ in 0..ROUNDS {
        for &v in &interpolated {
            let (mut sum, mut count) = (0.0, 0);
            for k in problem.companions(v) {
                (sum, count) = (sum + size[k as usize], count + 1);
            }
            size[v as usize] = sum / f64::from(count);
        }
    }
    let mut areas: Vec<f64> = size.into_iter().map(f64::exp).collect();
    let target = |t: &[u32; 3]| t.map(|v| areas[v as usize]).iter().sum::<f64>() / 3.0;
    let mut wanted: f64 = corners.triangles().iter().map(target).sum();
    if problem.has_quadrilaterals() {
        // A square has 4/√3 times the area of the equilateral triangle of its side, and four corners.
        let of_quadrilaterals = corners.of_quadrilaterals().iter().map(target);
        wanted += of_quadrilaterals.sum::<f64>() / 3f64.sqrt();
    }
    let factor = problem.mean_area() * corners.equivalent_triangles() / wanted;
    areas.iter_mut().for_each(|area| *area *= factor);
    areas
}

/// Returns the natural logarithm of the element area at each vertex for which the mesh determines an area, else `None`.
fn known(problem: &Problem, positions: &[DVec2]) -> Vec<Option<f64>> {
    /// Logarithms of areas at a vertex, each as sum and count: areas of sound triangles, and areas estimated from the
    /// edges between fixed vertices. `is_unsound` is set if any triangle at the vertex is unsound.
    #[derive(Clone, Copy, Default)]
    struct Vertex {
        sound: (f64, u32),
        edges: (f64, u32),
        is_unsound: bool,
    }
    let free = problem.free_count();
    let mut all = vec![Vertex::default(); positions.len()];
    for (index, t) in (0..).zip(problem.corners().all()) {
        let is_triangle = problem.corners().is_triangle(index);
        let [p, q, mut r] = t.map(|v| positions[v as usize]);
        if !is_triangle {
            let [_, b] = of_right_angle([(q - p).to_array(), (r - p).to_array()]);
            r = p + DVec2::from(b);
        }
        let area = 0.5 * (q - p).perp_dot(r - p);
        let squares = p.distance_squared(q) + q.distance_squared(r) + r.distance_squared(p);
        let is_sound = squares < SOUND * 4.0 * 3f64.sqrt() * area;
        for v in t.map(|v| v as usize) {
            let vertex = &mut all[v];
            vertex.is_unsound |= !is_sound;
            if is_sound {
                vertex.sound = (vertex.sound.0 + area.ln(), vertex.sound.1 + 1);
            }
        }
        // An edge between two fixed vertices estimates the area of an equilateral triangle with this edge.
        let sides = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        let count = if is_triangle { 3 } else { 1 };
        for [k, l] in sides[..count].iter().map(|edge| edge.map(|v| v as usize)) {
            let square = positions[k].distance_squared(positions[l]);
            if k >= free && l >= free && square > 0.0 {
                let area = (3f64.sqrt() / 4.0 * square).ln();
                for v in [k, l] {
                    all[v].edges = (all[v].edges.0 + area, all[v].edges.1 + 1);
                }
            }
        }
    }
    // Where vertices are at random places, some vertices have only sound triangles by chance, mostly large ones. Most
    // neighbors of such a vertex have unsound triangles. So a size counts only if most neighbors have sound triangles
    // alone.
    let mut company = vec![0i32; all.len()];
    for t in problem.corners().all() {
        let of = |v: u32| if all[v as usize].is_unsound { -1 } else { 1 };
        let [a, b, c] = t.map(of);
        for (&v, others) in t.iter().zip([b + c, c + a, a + b]) {
            company[v as usize] += others;
        }
    }
    let mean = |(sum, count): (f64, u32)| (count > 0).then(|| sum / f64::from(count));
    let of = |(v, vertex): (usize, &Vertex)| {
        let is_believed = !vertex.is_unsound && company[v] > 0;
        let sound = mean(vertex.sound);
        match v < free {
            true => sound.filter(|_| is_believed),
            false => sound.filter(|_| is_believed).or(mean(vertex.edges)).or(sound),
        }
    };
    all.iter().enumerate().map(of).collect()
}

/// Gives every vertex without a size the mean size of its neighbors, layer by layer outward from the known sizes.
/// Returns the vertices that received a size; none if no size is known.
fn spread(triangles: &[[u32; 3]], size: &mut [Option<f64>]) -> Vec<u32> {
    let mut found: Vec<u32> = Vec::new();
    let is_open =
        |t: &[u32; 3], size: &[Option<f64>]| t.iter().any(|&v| size[v as usize].is_none());
    let mut open: Vec<[u32; 3]> = triangles.iter().copied().filter(|t| is_open(t, size)).collect();
    while !open.is_empty() {
        let mut sums: Vec<(u32, f64)> = Vec::new();
        for t in &open {
            let known: Vec<f64> = t.iter().filter_map(|&v| size[v as usize]).collect();
            if !known.is_empty() {
                let mean = known.iter().sum::<f64>() / known.len() as f64;
                sums.extend(t.iter().filter(|&&v| size[v as usize].is_none()).map(|&v| (v, mean)));
            }
        }
        if sums.is_empty() {
            break;
        }
        sums.sort_by_key(|&(v, _)| v);
        for same in sums.chunk_by(|a, b| a.0 == b.0) {
            let mean = same.iter().map(|&(_, mean)| mean).sum::<f64>() / same.len() as f64;
            size[same[0].0 as usize] = Some(mean);
            found.push(same[0].0);
        }
        open.retain(|t| is_open(t, size));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Coloring;
    use crate::mesh::Mesh;
    use crate::topology::Topology;

    /// Returns a square of `n` times `n` cells. `inside` moves the inner vertices, given their indices and positions.
    fn square(n: u32, inside: impl Fn(usize, [f64; 2]) -> [f64; 2]) -> Mesh {
        let mut mesh = Mesh::default();
        for k in 0..(n + 1) * (n + 1) {
            let (i, j) = (k % (n + 1), k / (n + 1));
            let at = [f64::from(i), f64::from(j)];
            let is_inside = (1..n).contains(&i) && (1..n).contains(&j);
            mesh.points.push(if is_inside { inside(k as usize, at) } else { at });
        }
        for k in (0..(n + 1) * n).filter(|k| k % (n + 1) < n) {
            mesh.triangles.extend([[k, k + 1, k + n + 2], [k, k + n + 2, k + n + 1]]);
        }
        mesh
    }

    fn targets(mesh: &Mesh) -> Vec<f64> {
        let topology = Topology::by_area(mesh).unwrap();
        let problem = Problem::new(mesh, &topology, &Coloring::new(&topology));
        let areas = target_areas(&problem, problem.positions());
        let mut by_mesh = vec![0.0; mesh.points.len()];
        for (&v, area) in problem.vertices().iter().zip(&areas) {
            by_mesh[v as usize] = area / problem.mean_area();
        }
        by_mesh
    }

    #[test]
    fn a_sound_mesh_keeps_its_sizes() {
        let mut mesh = square(8, |_, at| at);
        mesh.points.iter_mut().for_each(|p| *p = p.map(|x| (0.5 * x).exp()));
        let of = targets(&mesh);
        // Cells grow by the factor e over two cells, along both axes.
        let ratio = of[6 * 9 + 6] / of[2 * 9 + 2];
        assert!((ratio / 4f64.exp() - 1.0).abs() < 0.2, "{ratio}");
    }

    #[test]
    fn sizes_inside_a_collapsed_mesh_come_from_its_boundary() {
        for inside in [[4.0, 4.0], [100.0, -3.0]] {
            let of = targets(&square(8, |_, _| inside));
            // The two triangles that cut off a corner are sound, and larger or smaller than the others.
            assert!(of.iter().all(|area| (0.2..2.0).contains(area)), "{of:?}");
            assert!(of.iter().filter(|area| (0.9..1.1).contains(*area)).count() > 70, "{of:?}");
        }
    }

    #[test]
    fn triangles_that_are_sound_by_chance_tell_no_size() {
        let random = |k: usize, share: f64| 8.0 * (share * k as f64).fract();
        let of = targets(&square(8, |k, _| [random(k, 0.618_034), random(k, 0.414_214)]));
        // A triangle that cuts off a corner is sound wherever the inner vertices are.
        let others = of.iter().filter(|area| !(0.8..1.4).contains(*area)).count();
        assert!(others <= 1, "{of:?}");
    }
}
