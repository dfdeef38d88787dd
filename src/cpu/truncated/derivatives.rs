//! The pass over all triangles that computes the numbers of a Newton step: the gradient, the Hessian of each triangle, and
//! the sums of its positive semidefinite part at the vertices and over aggregates.

use fearless_simd::{Level, prelude::*};
use glam::DVec2;

use super::blocks::{Block, Blocks, receive, split};
use super::couplings::{CornerGroups, Couplings, Entries};
use super::levels::Extent;
use super::matrix::{ROWS, Square};
use super::scalar::{Scalar, narrowed};
use super::slides::Line;
use crate::layout::Problem;
use crate::metric::{Corner, Curvature, Curved, H, Metric, OfImr, TargetMap};
use crate::parallel::paced;
use crate::patch::lanes::{LANES, Lanes, Points, with_instructions};
use crate::run::multilevel::NONE;
use crate::run::truncated::aggregation::{Pattern, UNKNOWNS};

/// The Hessian of a triangle: see [`Curvature`]. Lengths are in units of |C|, so that the numbers keep their digits for
/// triangles of any stretching.
#[derive(Clone, Copy, Default)]
pub(super) struct Terms<T> {
    pub(super) conformal: [T; 2],
    pub(super) anticonformal: [T; 2],
    pub(super) own: [T; 2],
    pub(super) mixed: [T; 3],
}

/// The target map of a triangle: a displacement p becomes s p + t p̄ in complex numbers, with real s.
#[derive(Clone, Copy)]
pub(super) struct Map<T> {
    pub(super) scale: T,
    pub(super) stretch: [T; 2],
}

impl Map<f64> {
    fn of(map: &TargetMap<f64>) -> Self {
        let [xx, xy, yy] = map.0;
        Self { scale: 0.5 * (xx + yy), stretch: [0.5 * (xx - yy), xy] }
    }
}

impl<T: Scalar> Map<T> {
    /// Transforms the changes of C and D by a displacement to those of the transformed triangle: C' = s C + t D̄ and D' =
    /// s D + t C̄. The same map leads back from forces on C' and D' to forces on C and D.
    #[inline(always)]
    pub(super) fn apply(&self, c: [T; 2], d: [T; 2]) -> [[T; 2]; 2] {
        let Self { scale, stretch: [x, y] } = *self;
        [
            [scale * c[0] + x * d[0] + y * d[1], scale * c[1] + y * d[0] - x * d[1]],
            [scale * d[0] + x * c[0] + y * c[1], scale * d[1] + y * c[0] - x * c[1]],
        ]
    }

    fn narrowed<U: Scalar>(&self) -> Map<U> {
        Map { scale: U::of(self.scale.wide()), stretch: self.stretch.map(|x| U::of(x.wide())) }
    }
}

/// The input of a step: positions, blocks of triangles, and the admitted moves of sliding vertices.
pub(super) struct Source<'a, T> {
    pub(super) problem: &'a Problem,
    pub(super) positions: &'a [DVec2],
    pub(super) blocks: &'a Blocks,
    pub(super) couplings: &'a Couplings,
    /// Pattern of the first level's matrix.
    pub(super) pattern: &'a Pattern,
    pub(super) extents: &'a [Extent],
    pub(super) lines: &'a [Line<T>],
}

/// Numbers of a Newton step, which [`Source::compute`] fills.
pub(super) struct Numbers<T> {
    /// Terms of the triangles of each block.
    pub(super) terms: Vec<Vec<Terms<T>>>,
    /// Maps of the triangles of each block. Empty without targets.
    pub(super) maps: Vec<Vec<Map<T>>>,
    /// Place of each vertex in its aggregate: (z - c)/s.
    pub(super) places: Vec<[T; 2]>,
    /// The negative gradient of the sum of q² over all triangles.
    pub(super) residual: Vec<[T; 2]>,
    /// Inverses of the diagonal blocks, as xx, xy, yy.
    pub(super) inverses: Vec<[T; 3]>,
}

/// Gradient and diagonal block of a vertex: x, y, xx, xy, yy.
type AtVertex = [f64; 5];

/// What the triangles of one block fill.
struct Part<'p, T> {
    terms: &'p mut Vec<Terms<T>>,
    maps: &'p mut Vec<Map<T>>,
    entries: Entries<'p, T>,
    /// Aggregates and sums of the vertices of the local list.
    groups: Vec<u32>,
    sums: Vec<AtVertex>,
}

impl<T: Scalar> Source<'_, T> {
    /// Fills `numbers` with the terms of the metric at the positions. Returns the upper blocks of the first level's matrix.
    pub(super) async fn compute(&self, metric: Metric, numbers: &mut Numbers<T>) -> Vec<Square<T>> {
        let Self { blocks, couplings, .. } = self;
        self.place(&mut numbers.places).await;
        let mut upper = couplings.upper();
        let mut shared: Vec<AtVertex> = blocks.shared();
        let Numbers { terms, maps, residual, inverses, .. } = numbers;
        let lengths = blocks.blocks.iter().map(|block| couplings.own(block).len());
        let lists = terms.iter_mut().zip(maps).zip(split(&mut upper, lengths));
        let own = blocks.split(residual).zip(blocks.split(inverses));
        let parts: Vec<_> = lists.zip(own).zip(blocks.split_shared(&mut shared)).collect();
        let made = paced::map_parts(parts, |at, (((lists, upper), own), shared)| {
            let ((terms, maps), (residual, inverses)) = (lists, own);
            let block = &blocks.blocks[at];
            let mut part = Part {
                terms,
                maps,
                entries: couplings.entries(self.pattern, block, upper),
                groups: couplings.groups(block),
                sums: vec![AtVertex::default(); block.vertices.len()],
            };
            with_instructions!(Level::new(), simd => match metric.curved() {
                Some(_) if metric == Metric::Imr => self.block(simd, OfImr, block, &mut part),
                Some(curved) => self.block(simd, curved, block, &mut part),
                None => {}
            });
            let Part { sums, entries, .. } = part;
            shared.copy_from_slice(&sums[block.foreign()]);
            let own = residual.iter_mut().zip(inverses).zip(&sums);
            for (v, ((residual, inverse), sum)) in own.enumerate() {
                (*residual, *inverse) = self.solved(block, v, sum);
            }
            // Sums of other blocks are missing at these vertices.
            let rim: Vec<AtVertex> = block.received().map(|(v, _)| sums[v]).collect();
            (rim, entries.into_beyond())
        });
        let (rims, beyond): (Vec<_>, Vec<_>) = made.await.into_iter().unzip();
        Couplings::add_beyond(beyond, &mut upper);
        let own = blocks.split(residual).zip(blocks.split(inverses));
        let parts: Vec<_> = own.zip(rims).collect();
        paced::for_each_part(parts, |at, ((residual, inverses), rim)| {
            let block = &blocks.blocks[at];
            for ((v, received), mut sum) in block.received().zip(rim) {
                receive(&mut sum, received, &shared);
                (residual[v], inverses[v]) = self.solved(block, v, &sum);
            }
        })
        .await;
        upper
    }

    /// Returns the negative gradient and the inverse of the diagonal block at an own vertex of a block, given its sums.
    #[inline(always)]
    fn solved(&self, block: &Block, v: usize, sum: &AtVertex) -> ([T; 2], [T; 3]) {
        let [x, y, xx, xy, yy] = *sum;
        let inverse = match block.slide(v as u32) {
            NONE => inverse_of([xx, xy, yy]),
            // The rows at sliding vertices are along their lines.
            slide => inverse_along(xx + yy, &self.lines[slide as usize]),
        };
        (narrowed([-x, -y]), inverse)
    }

    /// Computes the places of the vertices in their aggregates.
    async fn place(&self, places: &mut [[T; 2]]) {
        let Self { blocks, positions, extents, .. } = self;
        let parts: Vec<_> = blocks.split(places).collect();
        paced::for_each_part(parts, |at, places| {
            let block = &blocks.blocks[at];
            for group in block.groups.clone() {
                let ends = &blocks.group_start[group..group + 2];
                for v in ends[0] as usize..ends[1] as usize {
                    let at = positions[blocks.order[v] as usize];
                    places[v - block.own.start] = narrowed(extents[group].place(at));
                }
            }
        })
        .await;
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, curved: impl Curved, block: &Block, part: &mut Part<'_, T>) {
        part.terms.clear();
        part.maps.clear();
        let mut first = 0;
        while first < block.corners.len() {
            let four = curved.curvature(&self.corners(simd, block, first));
            let count = LANES.min(block.corners.len() - first);
            let mut lane = 0;
            while lane < count {
                let t = &block.corners[first + lane];
                let vertices = vertices_of(block, t);
                let is_right = first + lane >= block.triangles;
                let mut curvature = of_lane(&four, lane);
                if is_right {
                    curvature = curvature.times(RIGHT_WEIGHT);
                }
                let map = self.problem.target_map(&vertices).map(|map| Map::of(&map));
                part.terms.push(terms_of(&curvature));
                part.maps.extend(map.as_ref().map(Map::narrowed));
                let Curvature { conformal: c, anticonformal: d, own, rows, .. } = &mut curvature;
                let mut force = [[own[0] * c[0], own[0] * c[1]], [own[1] * d[0], own[1] * d[1]]];
                if let Some(map) = map {
                    force = map.apply(force[0], force[1]);
                    rows.iter_mut().for_each(|row| *row = map.apply(row[0], row[1]));
                }
                let mut force = at_corners(force);
                let mut rows = [at_corners(rows[0]), at_corners(rows[1]), at_corners(rows[2])];
                if is_right {
                    force = before_shear(force);
                    rows = rows.map(before_shear);
                }
                if block.has_sliding_corner(t) {
                    self.project(block, t, &mut rows);
                }
                let mut k = 0;
                while k < 3 {
                    let sum = &mut part.sums[t[k] as usize];
                    let ([a, b], [c, d], [e, f]) = (rows[0][k], rows[1][k], rows[2][k]);
                    sum[0] += force[k][0];
                    sum[1] += force[k][1];
                    sum[2] += a * a + c * c + e * e;
                    sum[3] += a * b + c * d + e * f;
                    sum[4] += b * b + d * d + f * f;
                    k += 1;
                }
                self.couple(block, &rows, t, &vertices, part);
                lane += 1;
            }
            first += LANES;
        }
    }

    /// Returns the corners of four triangles of a block, from `first` on. The last triangle stands for missing ones.
    #[inline(always)]
    fn corners<S: Simd>(&self, simd: S, block: &Block, first: usize) -> Corner<Lanes<S>> {
        let [mut a, mut b] = [[[0.0; LANES]; 2]; 2];
        let mut lane = 0;
        while lane < LANES {
            let at = (first + lane).min(block.corners.len() - 1);
            let (t, is_right) = (&block.corners[at], at >= block.triangles);
            let position = |v: u32| self.positions[v as usize];
            let corner = self.problem.corner_of(is_right, &vertices_of(block, t), position);
            ([a[0][lane], a[1][lane]], [b[0][lane], b[1][lane]]) = (corner.a, corner.b);
            lane += 1;
        }
        Corner {
            a: [Lanes::simd_from(simd, a[0]), Lanes::simd_from(simd, a[1])],
            b: [Lanes::simd_from(simd, b[0]), Lanes::simd_from(simd, b[1])],
            ideal: self.problem.ideal(),
        }
    }

    /// Projects the rows of a triangle at its sliding corners to the lines of these corners.
    fn project(&self, block: &Block, t: &[u32; 3], rows: &mut [[[f64; 2]; 3]; 3]) {
        for (k, &v) in t.iter().enumerate() {
            if let Some(line) = self.lines.get(block.slide(v) as usize) {
                let [x, y] = line.along.map(Scalar::wide);
                for row in &mut *rows {
                    let length = x * row[k][0] + y * row[k][1];
                    row[k] = [x * length, y * length];
                }
            }
        }
    }

    /// Adds a triangle to the entries of its aggregates.
    #[inline(always)]
    fn couple(
        &self,
        block: &Block,
        rows: &[[[f64; 2]; 3]; 3],
        t: &[u32; 3],
        vertices: &[u32; 3],
        part: &mut Part<'_, T>,
    ) {
        let of = |v: u32| part.groups[v as usize];
        let groups = [of(t[0]), of(t[1]), of(t[2])];
        let of = CornerGroups::new(groups, block.has_sliding_corner(t));
        let pairs = of.pairs();
        if pairs.is_empty() {
            return;
        }
        // Each row by the four unknowns of each aggregate.
        let mut by = [[[T::default(); UNKNOWNS]; 3]; 3];
        let mut k = 0;
        while k < 3 {
            let group = groups[k];
            if group == NONE {
                k += 1;
                continue;
            }
            let [u, v] = self.extents[group as usize].place(self.positions[vertices[k] as usize]);
            let is_last = of.count == 3 && group == of.groups[2];
            let slot = usize::from(group != of.groups[0]) + usize::from(is_last);
            let mut row = 0;
            while row < 3 {
                let ([x, y], by) = (rows[row][k], &mut by[slot][row]);
                by[0] += T::of(x);
                by[1] += T::of(y);
                by[2] += T::of(u * x + v * y);
                by[3] += T::of(u * y - v * x);
                row += 1;
            }
            k += 1;
        }
        let mut at = 0;
        while at < pairs.len() {
            let [low, high] = pairs[at];
            let entry = part.entries.at(of.groups[low], of.groups[high]);
            let (a, b) = (&by[low], &by[high]);
            let mut column = 0;
            while column < UNKNOWNS {
                let [p, q, r] = [b[0][column], b[1][column], b[2][column]];
                let to = column * UNKNOWNS;
                entry[to] += (a[0][0] * p + a[1][0] * q) + a[2][0] * r;
                entry[to + 1] += (a[0][1] * p + a[1][1] * q) + a[2][1] * r;
                entry[to + 2] += (a[0][2] * p + a[1][2] * q) + a[2][2] * r;
                entry[to + 3] += (a[0][3] * p + a[1][3] * q) + a[2][3] * r;
                column += 1;
            }
            at += 1;
        }
    }
}

/// Returns the vertices of a triangle in the problem.
#[inline(always)]
fn vertices_of(block: &Block, t: &[u32; 3]) -> [u32; 3] {
    [block.vertices[t[0] as usize], block.vertices[t[1] as usize], block.vertices[t[2] as usize]]
}

/// Returns the derivatives of one of four triangles.
#[inline(always)]
fn of_lane<S: Simd>(four: &Curvature<Lanes<S>>, lane: usize) -> Curvature {
    let Curvature { conformal: c, anticonformal: d, own, mixed, rows } = four;
    let row = |[x, y]: &[Points<S>; 2]| [[x[0][lane], x[1][lane]], [y[0][lane], y[1][lane]]];
    Curvature {
        conformal: [c[0][lane], c[1][lane]],
        anticonformal: [d[0][lane], d[1][lane]],
        own: [own[0][lane], own[1][lane]],
        mixed: [mixed[0][lane], mixed[1][lane], mixed[2][lane]],
        rows: [row(&rows[0]), row(&rows[1]), row(&rows[2])],
    }
}

/// Returns the inverse of the diagonal block of a vertex: xx, xy, yy. Zero if the block is singular.
#[inline(always)]
fn inverse_of<T: Scalar>([xx, xy, yy]: [f64; 3]) -> [T; 3] {
    let determinant = xx * yy - xy * xy;
    let by = if determinant > 0.0 { 1.0 / determinant } else { 0.0 };
    narrowed([yy * by, -xy * by, xx * by])
}

/// Returns the inverse of the second derivative along a line, as a block. Zero for a vertex that stays.
fn inverse_along<T: Scalar>(second: f64, line: &Line<T>) -> [T; 3] {
    let [x, y] = line.along.map(Scalar::wide);
    let whole = second + line.stiffness.wide();
    let by = if whole > 0.0 { 1.0 / whole } else { 0.0 };
    narrowed([x * x * by, x * y * by, y * y * by])
}

/// Returns the terms of a triangle with lengths in units of |C|.
#[inline(always)]
fn terms_of<T: Scalar>(curvature: &Curvature) -> Terms<T> {
    let Curvature { conformal: c, anticonformal: d, own, mixed, .. } = *curvature;
    let square = c[0] * c[0] + c[1] * c[1];
    let by = 1.0 / square.sqrt();
    Terms {
        conformal: [T::of(c[0] * by), T::of(c[1] * by)],
        anticonformal: [T::of(d[0] * by), T::of(d[1] * by)],
        own: [T::of(own[0]), T::of(own[1])],
        mixed: [T::of(mixed[0] * square), T::of(mixed[1] * square), T::of(mixed[2] * square)],
    }
}

/// Returns the forces on the three corners of a triangle, given those on C and D: F + G, w F + w̄ G and w̄ F + w G.
#[inline(always)]
fn at_corners([c, d]: [[f64; 2]; 2]) -> [[f64; 2]; 3] {
    let sum = [c[0] + d[0], c[1] + d[1]];
    let turned = [-H * (c[1] - d[1]), H * (c[0] - d[0])];
    [
        sum,
        [turned[0] - 0.5 * sum[0], turned[1] - 0.5 * sum[1]],
        [-turned[0] - 0.5 * sum[0], -turned[1] - 0.5 * sum[1]],
    ]
}

/// The weight of a corner of a quadrilateral.
const RIGHT_WEIGHT: f64 = 0.25;

/// Returns the forces on the vertices of a corner of a quadrilateral, given those on the vertices of its sheared triangle. The
/// third vertex of the triangle is p + (q - p)/2 + √3/2 (r - p) for the vertices p, q and r.
#[inline(always)]
pub(super) fn before_shear<T: Scalar>([p, q, r]: [[T; 2]; 3]) -> [[T; 2]; 3] {
    let (half, h, rest) = (T::of(0.5), T::of(H), T::of(0.5 - H));
    [
        [p[0] + rest * r[0], p[1] + rest * r[1]],
        [q[0] + half * r[0], q[1] + half * r[1]],
        [h * r[0], h * r[1]],
    ]
}

/// Returns the displacements of the vertices of the sheared triangle of a corner, given those of the corner's vertices.
#[inline(always)]
pub(super) fn sheared<T: Scalar>([p, q, r]: [[T; 2]; 3]) -> [[T; 2]; 3] {
    let (half, h, rest) = (T::of(0.5), T::of(H), T::of(0.5 - H));
    let third = [0, 1].map(|k| rest * p[k] + half * q[k] + h * r[k]);
    [p, q, third]
}

impl Extent {
    /// Returns the extent of the vertices at the given positions.
    pub(super) fn of(positions: impl Iterator<Item = DVec2> + Clone) -> Self {
        let count = positions.clone().count() as f64;
        let center = positions.clone().sum::<DVec2>() / count;
        let square = positions.map(|at| at.distance_squared(center)).sum::<f64>() / count;
        let size = if square > 0.0 { square.sqrt() } else { 1.0 };
        Self::new(center.to_array(), size)
    }

    /// Returns (z - c)/s of a position z.
    #[inline(always)]
    fn place(&self, at: DVec2) -> [f64; 2] {
        [(at.x - self.center[0]) * self.inverse, (at.y - self.center[1]) * self.inverse]
    }
}

/// Computes the extents of the aggregates of vertices.
pub(super) async fn extents(blocks: &Blocks, positions: &[DVec2], extents: &mut [Extent]) {
    paced::for_each_chunk(extents, ROWS, |first, extents| {
        for (group, extent) in (first..).zip(extents) {
            let ends = &blocks.group_start[group..group + 2];
            let vertices = &blocks.order[ends[0] as usize..ends[1] as usize];
            *extent = Extent::of(vertices.iter().map(|&v| positions[v as usize]));
        }
    })
    .await;
}

/// The terms and the maps of the triangles of each block.
type Lists<T> = (Vec<Vec<Terms<T>>>, Vec<Vec<Map<T>>>);

/// Returns the blocks' own lists of terms, empty.
pub(super) fn room<T>(blocks: &[Block], mapped: bool) -> Lists<T> {
    let of = |block: &Block| Vec::with_capacity(block.corners.len());
    let maps = |block: &Block| Vec::with_capacity(if mapped { block.corners.len() } else { 0 });
    (blocks.iter().map(of).collect(), blocks.iter().map(maps).collect())
}
