//! The V-cycle that computes corrections from coarser levels, on the CPU.

use std::pin::Pin;

use glam::Vec2;

use crate::layout::Problem;
use crate::parallel::paced;
use crate::run::multilevel::{CHEBYSHEV, Coarser, Hierarchy, Level, NONE, Sparse};

/// Number of rows that one task computes. Levels with fewer rows are left to a single thread, as distributing their
/// rows would take longer than computing them.
const GRAIN: usize = 4096;

/// Returns the correction -P M⁻¹ Pᵀ g for the gradient g of Σ q² at the free vertices. P is the prolongation from the
/// aggregates of the free vertices, M⁻¹ a V-cycle over the coarse levels. The correction is a direction of descent.
pub(crate) async fn correction(
    hierarchy: &Hierarchy,
    problem: &Problem,
    gradient: &[Vec2],
) -> Vec<Vec2> {
    let Some(first) = hierarchy.levels().first() else { return vec![Vec2::ZERO; gradient.len()] };
    let smoothing = Hierarchy::smoothing(problem);
    // Marks of opposite vertices are numbers beyond all free vertices.
    let ring = |v: usize| {
        let ring = problem.ring_of(v as u32).iter();
        ring.map(|&k| k as usize).filter(|&k| k < gradient.len())
    };
    let root = hierarchy.roots();
    // `values` are already multiplied by the stiffness roots of their vertices.
    let around = |v: usize, values: &[Vec2]| -> Vec2 {
        root[v] * ring(v).fold(Vec2::ZERO, |sum, k| sum + values[k])
    };
    let diagonal = hierarchy.inverse_diagonal();
    let restricted = {
        let scaled = rows(gradient.len(), |v| gradient[v] * (diagonal[v] * root[v])).await;
        let smoothed = rows(gradient.len(), |v| {
            gradient[v] * (1.0 - smoothing) + around(v, &scaled) * smoothing
        })
        .await;
        let (starts, members) = (hierarchy.member_starts(), hierarchy.members());
        rows(first.operator.rows(), |aggregate| {
            let members = &members[starts[aggregate] as usize..starts[aggregate + 1] as usize];
            -members.iter().map(|&v| smoothed[v as usize]).sum::<Vec2>()
        })
        .await
    };
    let coarse = solve(hierarchy.levels(), &restricted).await;
    let own = |v: usize| match hierarchy.aggregate_of()[v] {
        NONE => Vec2::ZERO,
        aggregate => coarse[aggregate as usize],
    };
    let handed = rows(gradient.len(), |v| own(v) * root[v]).await;
    rows(gradient.len(), |v| {
        own(v) * (1.0 - smoothing) + around(v, &handed) * (smoothing * diagonal[v])
    })
    .await
}

/// Runs one V-cycle over the coarse levels, starting from zero.
fn solve<'l>(
    levels: &'l [Level],
    right: &'l [Vec2],
) -> Pin<Box<dyn Future<Output = Vec<Vec2>> + Send + 'l>> {
    Box::pin(solved(levels, right))
}

/// Does the work of [`solve`], whose box makes the recursion finite in size.
async fn solved(levels: &[Level], right: &[Vec2]) -> Vec<Vec2> {
    let Some((level, below)) = levels.split_first() else { return Vec::new() };
    let n = right.len();
    match &level.coarser {
        Coarser::Direct(inverse) => {
            let row = |i: usize| inverse[i * n..(i + 1) * n].iter().zip(right);
            rows(n, |i| row(i).map(|(&a, &b)| b * a).sum()).await
        }
        Coarser::Nothing => smooth(level, None, right).await,
        Coarser::Level { prolongation, restriction } => {
            let mut x = smooth(level, None, right).await;
            let residual = residual(level, &x, right).await;
            let restricted = rows(restriction.rows(), |i| times(restriction, i, &residual)).await;
            let coarse = solve(below, &restricted).await;
            paced::for_each_chunk(&mut x, GRAIN, |first, x| {
                for (x, i) in x.iter_mut().zip(first..) {
                    *x += times(prolongation, i, &coarse);
                }
            })
            .await;
            smooth(level, Some(x), right).await
        }
    }
}

async fn residual(level: &Level, x: &[Vec2], right: &[Vec2]) -> Vec<Vec2> {
    rows(right.len(), |i| right[i] - times(&level.operator, i, x)).await
}

/// Takes two steps of the Chebyshev iteration, starting from `x`, or from zero if `x` is `None`.
async fn smooth(level: &Level, x: Option<Vec<Vec2>>, right: &[Vec2]) -> Vec<Vec2> {
    let [first, again, now] = CHEBYSHEV;
    let scale = &level.inverse_diagonal;
    let step = |i: usize, residual: Vec2| residual * (first * scale[i]);
    let (mut x, d) = match x {
        Some(mut x) => {
            let d = rows(x.len(), |i| step(i, right[i] - times(&level.operator, i, &x))).await;
            add(&mut x, &d).await;
            (x, d)
        }
        None => {
            let d = rows(right.len(), |i| step(i, right[i])).await;
            (d.clone(), d)
        }
    };
    let d = rows(x.len(), |i| {
        let residual = right[i] - times(&level.operator, i, &x);
        d[i] * again + residual * (now * scale[i])
    })
    .await;
    add(&mut x, &d).await;
    x
}

/// Adds `d` to `x`.
async fn add(x: &mut [Vec2], d: &[Vec2]) {
    paced::for_each_chunk(x, GRAIN, |first, x| {
        for (x, &d) in x.iter_mut().zip(&d[first..]) {
            *x += d;
        }
    })
    .await;
}

fn times(matrix: &Sparse, row: usize, x: &[Vec2]) -> Vec2 {
    matrix.row(row).map(|(column, value)| x[column] * value).sum()
}

async fn rows(count: usize, row: impl Fn(usize) -> Vec2 + Sync + Send) -> Vec<Vec2> {
    let mut rows = vec![Vec2::ZERO; count];
    paced::for_each_chunk(&mut rows, GRAIN, |first, rows| {
        for (to, i) in rows.iter_mut().zip(first..) {
            *to = row(i);
        }
    })
    .await;
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::sweep::stiffness_roots;
    use crate::layout::prepare;
    use crate::mesh::Mesh;
    use crate::metric::{Metric, Smoothing};
    use crate::parallel::pace::now;
    use glam::DVec2;

    /// Returns a square of right triangles of two sizes, large enough for three coarse levels.
    fn square() -> Problem {
        let side = 81u32;
        let at = |i: u32| f64::from(i) * if i < 40 { 1.0 } else { 1.5 };
        let points = (0..side * side).map(|k| [at(k % side), f64::from(k / side)]).collect();
        let cells = (0..side * (side - 1)).filter(|k| k % side + 1 < side);
        let triangles = cells.flat_map(|k| [[k, k + 1, k + side + 1], [k, k + side + 1, k + side]]);
        let mesh = Mesh { points, triangles: triangles.collect(), ..Mesh::default() };
        prepare(&mesh).unwrap().1
    }

    fn hierarchy(problem: &Problem) -> Hierarchy {
        let positions = problem.positions();
        let roots = now(stiffness_roots(Metric::Imr, problem, positions, Smoothing::of(0)));
        now(Hierarchy::new(problem, roots))
    }

    /// Returns a hierarchy built for the mesh with stretched positions, then fitted to the positions of the mesh.
    fn fitted(problem: &Problem) -> Hierarchy {
        let positions = problem.positions();
        let extent = positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let stretched = |p: &DVec2| *p * (1.0 + 1.5 * *p * *p / (extent * extent));
        let stretched: Vec<DVec2> = positions.iter().map(stretched).collect();
        let roots =
            |positions| now(stiffness_roots(Metric::Imr, problem, positions, Smoothing::of(0)));
        let built = now(Hierarchy::new(problem, roots(&stretched)));
        now(built.fitted_to(problem, roots(positions)))
    }

    /// Returns pseudorandom vectors.
    fn noise(count: usize, seed: f64) -> Vec<Vec2> {
        let at =
            |k: usize| DVec2::new((k as f64 * seed).sin(), (k as f64 * seed * 1.7).cos()).as_vec2();
        (0..count).map(at).collect()
    }

    fn dot(a: &[Vec2], b: &[Vec2]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a.as_dvec2().dot(b.as_dvec2())).sum()
    }

    #[test]
    fn a_hierarchy_has_several_shrinking_levels() {
        let problem = square();
        let rows: Vec<usize> =
            hierarchy(&problem).levels().iter().map(|level| level.operator.rows()).collect();
        assert!(rows.len() >= 3, "{rows:?}");
        assert!(rows[0] < problem.free_count() / 4, "{rows:?}");
        assert!(rows.windows(2).all(|pair| pair[1] < pair[0] / 2), "{rows:?}");
    }

    #[test]
    fn a_correction_is_symmetric_and_descends() {
        let problem = square();
        let hierarchies = [hierarchy(&problem), fitted(&problem)];
        for (seed, hierarchy) in [0.37, 1.1, 2.9].into_iter().zip(hierarchies.iter().cycle()) {
            let (a, b) =
                (noise(problem.free_count(), seed), noise(problem.free_count(), seed + 0.2));
            let (to_a, to_b) = (
                now(correction(hierarchy, &problem, &a)),
                now(correction(hierarchy, &problem, &b)),
            );
            assert!(dot(&a, &to_a) < 0.0 && dot(&b, &to_b) < 0.0);
            let (across, back) = (dot(&a, &to_b), dot(&b, &to_a));
            let scale = (dot(&a, &to_a) * dot(&b, &to_b)).sqrt();
            assert!((across - back).abs() < 1e-5 * scale, "{across} and {back} of {scale}");
        }
    }

    #[test]
    fn smooth_errors_are_corrected_nearly_whole() {
        // The error is a wave over the whole square. Sweeps alone would take thousands to remove the wave.
        let problem = square();
        assert_corrects_a_wave(&problem, &hierarchy(&problem), 0.1);
        // Stretching has changed shapes as well as sizes, and factors at the vertices fit shapes less well.
        assert_corrects_a_wave(&problem, &fitted(&problem), 0.15);
    }

    fn assert_corrects_a_wave(problem: &Problem, hierarchy: &Hierarchy, most: f64) {
        let positions = problem.positions();
        let low = positions.iter().copied().reduce(DVec2::min).unwrap();
        let high = positions.iter().copied().reduce(DVec2::max).unwrap();
        let pi = std::f64::consts::PI;
        let wave = |p: &DVec2| {
            let at = (*p - low) / (high - low) * pi;
            DVec2::splat(at.x.sin() * at.y.sin())
        };
        let wave: Vec<DVec2> = positions.iter().map(wave).collect();
        let laplacian = |v: usize| -> DVec2 {
            let ring = problem.ring_of(v as u32).iter().map(|&k| k as usize);
            ring.map(|k| (wave[v] - wave[k]) * f64::from(hierarchy.weight(v, k))).sum()
        };
        let free = problem.free_count();
        let gradient: Vec<Vec2> = (0..free).map(|v| laplacian(v).as_vec2()).collect();
        let step = now(correction(hierarchy, problem, &gradient));
        // Step length that leaves least of the wave.
        let squared: f64 = step.iter().map(|s| f64::from(s.length_squared())).sum();
        let along: f64 = wave.iter().zip(&step).map(|(w, s)| w.dot(s.as_dvec2())).sum();
        let length = -along / squared;
        let left =
            wave.iter().zip(&step).map(|(w, s)| (*w + s.as_dvec2() * length).length_squared());
        let whole: f64 = wave[..free].iter().map(|w| w.length_squared()).sum();
        let share = (left.sum::<f64>() / whole).sqrt();
        assert!(share < most, "{share} of the wave is left");
    }

    /// A line of held vertices from side to side divides the square. A gradient on the left yields no correction on the
    /// right.
    #[test]
    fn corrections_do_not_reach_across_held_vertices() {
        let problem = square();
        let positions = &problem.positions()[..problem.free_count()];
        let most = positions.iter().map(|p| p.x).fold(0.0, f64::max);
        let line = positions.iter().map(|p| p.x).filter(|x| *x > 0.5 * most).fold(most, f64::min);
        let held: Vec<bool> = positions.iter().map(|p| p.x == line).collect();
        let areas = vec![1.0; problem.positions().len()];
        let hierarchy = Hierarchy::of_sizes(&problem, &areas, &held);
        assert_eq!(held.iter().filter(|held| **held).count(), 79);
        let in_none = hierarchy.aggregate_of().iter().map(|&of| of == NONE);
        assert!(in_none.eq(held.iter().copied()));
        let on_the_left = |v: usize| positions[v].x < line;
        let mut gradient = noise(problem.free_count(), 0.37);
        for (_, g) in gradient.iter_mut().enumerate().filter(|(v, _)| !on_the_left(*v)) {
            *g = Vec2::ZERO;
        }
        let correction = now(correction(&hierarchy, &problem, &gradient));
        assert!(dot(&gradient, &correction) < 0.0);
        for (v, step) in correction.iter().enumerate().filter(|(v, _)| !held[*v]) {
            assert_eq!(on_the_left(v), *step != Vec2::ZERO, "vertex {v} at {}", positions[v]);
        }
    }
}
