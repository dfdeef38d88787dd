//! Secant pairs on the CPU; see [`crate::run::secant`].

use glam::{DVec2, Vec2};

use crate::parallel::paced;
use crate::run::EngineState;
use crate::run::secant::Products;

/// Number of vertices that one task handles.
const CHUNK: usize = 1 << 12;

/// Names of the vectors of the pairs in a saved state of the engine.
const VECTORS: [&str; 5] = ["step", "older step", "change", "older change", "start, low"];
const PRODUCTS: &str = "products of secants";
const IS_OPEN: &str = "secant is open";

/// The coarser levels of a correction.
pub(crate) trait Levels: Sync {
    /// Returns the correction -M⁻¹ v of the levels for a vector v.
    fn correction(&self, vector: &[Vec2]) -> impl Future<Output = Vec<Vec2>> + Send;
}

/// Two secant pairs at the free vertices, the newer pair first, in single precision.
///
/// From one correction to the next, the newer pair is open: `steps[0]` holds the high parts of the positions, and
/// `changes[0]` minus the gradient. Two pairs and the low parts of the positions, 40 bytes per free vertex, are
/// therefore all that is stored.
#[derive(Default)]
pub(crate) struct Secants {
    steps: [Vec<Vec2>; 2],
    changes: [Vec<Vec2>; 2],
    low: Vec<Vec2>,
    products: Products,
    is_open: bool,
}

impl Secants {
    /// Returns the search direction for a gradient, and opens the next pair. An open pair is closed first. `levels`
    /// returns the correction -M⁻¹ v of the coarser levels for any vector v.
    pub(crate) async fn direction<L: Levels>(
        &mut self,
        positions: &[DVec2],
        gradient: &[Vec2],
        levels: &L,
    ) -> Vec<Vec2> {
        let direction = if self.is_open {
            self.close(positions, gradient).await;
            let before = self.products.before();
            let [newer, older] = before.map(|factor| factor as f32);
            let [new, old] = &self.changes;
            let mut bent = paced::copied(gradient).await;
            paced::for_each_chunk(&mut bent, CHUNK, |first, bent| {
                for (v, bent) in (first..).zip(bent) {
                    *bent -= new[v] * newer + at(old, v) * older;
                }
            })
            .await;
            let mut direction = levels.correction(&bent).await;
            drop(bent);
            // `levels` returns -M⁻¹ v, hence the minus sign.
            let mut corrected = [0.0; 2];
            for (corrected, change) in corrected.iter_mut().zip(&self.changes) {
                *corrected = -dot(change, &direction).await;
            }
            let [newer, older] = self.products.after(before, corrected).map(|factor| factor as f32);
            let [new, old] = &self.steps;
            paced::for_each_chunk(&mut direction, CHUNK, |first, direction| {
                for (v, direction) in (first..).zip(direction) {
                    *direction -= new[v] * newer + at(old, v) * older;
                }
            })
            .await;
            direction
        } else {
            levels.correction(gradient).await
        };
        self.open(positions, gradient).await;
        direction
    }

    /// Adds the pairs to a saved state of the engine.
    pub(crate) fn save(&self, state: &mut EngineState) {
        let Self { steps, changes, low, products, is_open } = self;
        let pairs = [&steps[0], &steps[1], &changes[0], &changes[1], low];
        for (name, vectors) in VECTORS.iter().zip(pairs) {
            let vectors: Vec<[f32; 2]> = vectors.iter().map(Vec2::to_array).collect();
            state.own.add_list(name, &vectors);
        }
        let Products { along, curvature, across } = products;
        state.own.add_list(PRODUCTS, &[along[0], along[1], curvature[0], curvature[1], *across]);
        state.own.add_flag(IS_OPEN, *is_open);
    }

    /// Returns the pairs of a saved state, `None` unless the state has pairs for `free` free vertices.
    pub(crate) fn saved_in(state: &EngineState, free: usize) -> Option<Self> {
        let vectors = |i: usize| {
            let name = VECTORS[i];
            // A pair that did not exist yet was saved as an empty vector.
            let found =
                state.own.list_of::<[f32; 2]>(name, free).or_else(|| state.own.list_of(name, 0))?;
            Some(found.into_iter().map(Vec2::from_array).collect::<Vec<_>>())
        };
        let products = state.own.list_of::<f64>(PRODUCTS, 5)?;
        let [a, b, c, d, across] = <[f64; 5]>::try_from(products).ok()?;
        let low = vectors(4)?;
        let [step, change] = [vectors(0)?, vectors(2)?];
        let is_open = state.own.flag(IS_OPEN)?;
        let is_whole = [&low, &step, &change].iter().all(|v| v.len() == free) || !is_open;
        is_whole.then_some(Self {
            steps: [step, vectors(1)?],
            changes: [change, vectors(3)?],
            low,
            products: Products { along: [a, b], curvature: [c, d], across },
            is_open,
        })
    }

    async fn close(&mut self, positions: &[DVec2], gradient: &[Vec2]) {
        let Self { steps: [step, old], changes: [change, _], low, products, .. } = self;
        let chunks = step.chunks_mut(CHUNK).zip(change.chunks_mut(CHUNK));
        let sums = paced::map_parts(chunks, |chunk, (step, change)| {
            let mut sums = [0.0; 4];
            for ((step, change), v) in step.iter_mut().zip(change).zip(chunk * CHUNK..) {
                let start = step.as_dvec2() + low[v].as_dvec2();
                *step = (positions[v] - start).as_vec2();
                *change += gradient[v];
                let (s, y, g) = (step.as_dvec2(), change.as_dvec2(), gradient[v].as_dvec2());
                let older = at(old, v).as_dvec2();
                let terms = [s.dot(g), s.dot(y), older.dot(g), older.dot(y)];
                sums = std::array::from_fn(|i| sums[i] + terms[i]);
            }
            sums
        })
        .await;
        // Sums are added in order, so that the result does not depend on the number of threads.
        let [sg, sy, older_g, older_y] =
            sums.iter().fold([0.0; 4], |total, sums| std::array::from_fn(|i| total[i] + sums[i]));
        *products = Products::new([sg, older_g], [sy, products.curvature[0]], older_y);
    }

    async fn open(&mut self, positions: &[DVec2], gradient: &[Vec2]) {
        let Self { steps, changes, low, is_open, .. } = self;
        if *is_open {
            steps.swap(0, 1);
            changes.swap(0, 1);
        }
        *is_open = true;
        let (step, change) = (&mut steps[0], &mut changes[0]);
        for values in [&mut *step, &mut *change, &mut *low] {
            values.resize(gradient.len(), Vec2::ZERO);
        }
        let parts = step.chunks_mut(CHUNK).zip(change.chunks_mut(CHUNK)).zip(low.chunks_mut(CHUNK));
        paced::for_each_part(parts, |chunk, ((step, change), low)| {
            for (((step, change), low), v) in
                step.iter_mut().zip(change).zip(low).zip(chunk * CHUNK..)
            {
                *step = positions[v].as_vec2();
                *low = (positions[v] - step.as_dvec2()).as_vec2();
                *change = -gradient[v];
            }
        })
        .await;
    }
}

/// Returns the vector of a pair at a vertex, zero if the pair does not exist yet.
#[inline(always)]
fn at(values: &[Vec2], v: usize) -> Vec2 {
    values.get(v).copied().unwrap_or_default()
}

/// Returns the inner product, summed in an order that does not depend on the number of threads. 0 if `a` is empty.
pub(crate) async fn dot(a: &[Vec2], b: &[Vec2]) -> f64 {
    let of_part = |_, (a, b): (&[Vec2], &[Vec2])| -> f64 {
        a.iter().zip(b).map(|(a, b)| a.as_dvec2().dot(b.as_dvec2())).sum()
    };
    paced::map_parts(a.chunks(CHUNK).zip(b.chunks(CHUNK)), of_part).await.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::pace::now;

    /// Levels with 0.5 times the identity for M⁻¹.
    struct Halved;

    impl Levels for Halved {
        async fn correction(&self, vector: &[Vec2]) -> Vec<Vec2> {
            vector.iter().map(|v| *v * -0.5).collect()
        }
    }

    /// Minimizes a quadratic function with a diagonal Hessian of condition number 100, with 0.5 times the identity for
    /// M⁻¹. Pairs lower f by ten orders of magnitude in 40 corrections; steps along the gradient alone converge far
    /// more slowly.
    #[test]
    fn a_quadratic_is_minimized() {
        let stiffness = |v: usize| [0.1, 0.5, 2.0, 10.0][v % 4];
        let mut positions: Vec<DVec2> =
            (0..8).map(|v| DVec2::new(1.0, -0.5) * (f64::from(v) - 3.3)).collect();
        let mut secants = Secants::default();
        let f = |positions: &[DVec2]| -> f64 {
            positions.iter().enumerate().map(|(v, p)| 0.5 * stiffness(v) * p.length_squared()).sum()
        };
        let start = f(&positions);
        for _ in 0..40 {
            let gradient: Vec<Vec2> =
                positions.iter().enumerate().map(|(v, p)| (*p * stiffness(v)).as_vec2()).collect();
            let direction = now(secants.direction(&positions, &gradient, &Halved));
            let slope = now(dot(&direction, &gradient));
            assert!(slope <= 0.0, "{slope}");
            // The line search along the direction is exact.
            let bend: f64 = direction
                .iter()
                .enumerate()
                .map(|(v, d)| stiffness(v) * f64::from(d.length_squared()))
                .sum();
            let length = if bend > 0.0 { -slope / bend } else { 0.0 };
            for (position, along) in positions.iter_mut().zip(&direction) {
                *position += along.as_dvec2() * length;
            }
        }
        assert!(f(&positions) < 1e-10 * start, "{} of {start}", f(&positions));
    }
}
