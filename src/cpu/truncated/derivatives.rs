//! The pass over all triangles that computes the numbers of a Newton step: the gradient, the Hessian of each triangle, and
//! the sums of its positive semidefinite part at the vertices and over aggregates.

use fearless_simd::prelude::*;
use glam::DVec2;

use super::blocks::{Block, Blocks, receive, split};
use super::couplings::{CornerGroups, Couplings, Entries};
use super::levels::Extent;
use super::matrix::{ROWS, Square};
use super::scalar::{Scalar, narrowed};
use super::slides::Line;
use super::terms::{Map, Terms, at_corners, before_shear, of_lane, squares_at};
use crate::layout::Problem;
use crate::metric::{Corner, Curvature, Curved, Metric, OfImr};
use crate::parallel::paced;
use crate::patch::instructions::with_instructions;
use crate::patch::lanes::{LANES, Lanes, Points, apart, points};
use crate::run::multilevel::NONE;
use crate::run::truncated::aggregation::{Pattern, UNKNOWNS};

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
            part.terms.clear();
            part.maps.clear();
            with_instructions!(simd => match metric.curved() {
                Some(_) if metric == Metric::Imr => self.block(simd, OfImr, block, &mut part),
                Some(curved) => self.block(simd, curved, block, &mut part),
                None => {}
            }, alone => if let Some(curved) = metric.curved() {
                self.block_alone(curved, block, &mut part);
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
        let has_targets = self.problem.targets().is_some();
        let mut first = 0;
        while first < block.corners.len() {
            let count = LANES.min(block.corners.len() - first);
            let is_usual = !has_targets && first + count <= block.triangles;
            let four = match is_usual {
                true => self.triangles(simd, block, first),
                false => self.corners(simd, block, first),
            };
            let four = curved.curvature(&four);
            if is_usual {
                self.add_triangles(&four, block, first, count, part);
            } else {
                let mut index = first;
                while index < first + count {
                    let rows =
                        self.add(block, index, curvature_of_lane(&four, index - first), part);
                    apart(
                        simd,
                        #[inline(always)]
                        || self.couple(block, &rows, &block.corners[index], part),
                    );
                    index += 1;
                }
            }
            first += LANES;
        }
    }

    /// Adds up to four triangles without target maps, from `first` on.
    #[inline(always)]
    fn add_triangles<S: Simd>(
        &self,
        four: &Curvature<Lanes<S>>,
        block: &Block,
        first: usize,
        count: usize,
        part: &mut Part<'_, T>,
    ) {
        let Curvature { conformal: c, anticonformal: d, own, rows, .. } = four;
        let terms = Terms::of(four);
        let force = at_corners([[c[0] * own[0], c[1] * own[0]], [d[0] * own[1], d[1] * own[1]]]);
        let rows = [at_corners(rows[0]), at_corners(rows[1]), at_corners(rows[2])];
        let squares = [squares_at(&rows, 0), squares_at(&rows, 1), squares_at(&rows, 2)];
        let mut lane = 0;
        while lane < count {
            let t = &block.corners[first + lane];
            part.terms.push(terms.lane(lane).narrowed());
            let row =
                |[p, q, r]: &[Points<S>; 3]| [of_lane(p, lane), of_lane(q, lane), of_lane(r, lane)];
            let mut rows = [row(&rows[0]), row(&rows[1]), row(&rows[2])];
            let slides = block.has_sliding_corner(t);
            if slides {
                self.project(block, t, &mut rows);
            }
            let mut k = 0;
            while k < 3 {
                let square = match slides {
                    true => squares_at(&rows, k),
                    false => of_lane(&squares[k], lane),
                };
                add_at(&mut part.sums[t[k] as usize], of_lane(&force[k], lane), square);
                k += 1;
            }
            self.couple(block, &rows, t, part);
            lane += 1;
        }
    }

    /// Does the work of [`block`](Self::block) without vectors.
    fn block_alone(&self, curved: impl Curved, block: &Block, part: &mut Part<'_, T>) {
        for (index, t) in block.corners.iter().enumerate() {
            let is_right = index >= block.triangles;
            let position = |v: u32| self.positions[v as usize];
            let corner = self.problem.corner_of(is_right, &vertices_of(block, t), position);
            let rows = self.add(block, index, curved.curvature(&corner), part);
            self.couple(block, &rows, t, part);
        }
    }

    /// Adds the terms of the corner `index` of a block, and its sums at the vertices. `curvature` has the derivatives of the corner
    /// before its target map, if there is one. Returns the rows of the corner.
    #[inline(always)]
    fn add(
        &self,
        block: &Block,
        index: usize,
        mut curvature: Curvature,
        part: &mut Part<'_, T>,
    ) -> [[[f64; 2]; 3]; 3] {
        let t = &block.corners[index];
        let vertices = vertices_of(block, t);
        let is_right = index >= block.triangles;
        if is_right {
            curvature = curvature.times(RIGHT_WEIGHT);
        }
        let map = self.problem.target_map(&vertices).map(|map| Map::of(&map));
        part.terms.push(Terms::of(&curvature).narrowed());
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
            add_at(&mut part.sums[t[k] as usize], force[k], squares_at(&rows, k));
            k += 1;
        }
        rows
    }

    /// Returns four triangles of a block, from `first` on. The last triangle stands for missing ones.
    #[inline(always)]
    fn triangles<S: Simd>(&self, simd: S, block: &Block, first: usize) -> Corner<Lanes<S>> {
        let last = block.triangles - 1;
        let vertices = |lane: usize| vertices_of(block, &block.corners[last.min(first + lane)]);
        let [t, u, v, w] = [vertices(0), vertices(1), vertices(2), vertices(3)];
        let p = points(simd, self.positions, [t[0], u[0], v[0], w[0]]);
        let q = points(simd, self.positions, [t[1], u[1], v[1], w[1]]);
        let r = points(simd, self.positions, [t[2], u[2], v[2], w[2]]);
        let (a, b) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
        Corner { a, b, ideal: self.problem.ideal() }
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
        part: &mut Part<'_, T>,
    ) {
        let of = |v: u32| part.groups[v as usize];
        let groups = [of(t[0]), of(t[1]), of(t[2])];
        let of = CornerGroups::new(groups, block.has_sliding_corner(t));
        let pairs = of.pairs();
        if pairs.is_empty() {
            return;
        }
        let vertices = vertices_of(block, t);
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
fn curvature_of_lane<S: Simd>(four: &Curvature<Lanes<S>>, lane: usize) -> Curvature {
    let Curvature { conformal, anticonformal, own, mixed, rows } = four;
    let row = |[x, y]: &[Points<S>; 2]| [of_lane(x, lane), of_lane(y, lane)];
    Curvature {
        conformal: of_lane(conformal, lane),
        anticonformal: of_lane(anticonformal, lane),
        own: of_lane(own, lane),
        mixed: of_lane(mixed, lane),
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

/// The weight of a corner of a quadrilateral.
const RIGHT_WEIGHT: f64 = 0.25;

/// Adds the force and the diagonal block of a triangle to those of its vertex.
#[inline(always)]
fn add_at(sum: &mut AtVertex, force: [f64; 2], square: [f64; 3]) {
    sum[0] += force[0];
    sum[1] += force[1];
    sum[2] += square[0];
    sum[3] += square[1];
    sum[4] += square[2];
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
