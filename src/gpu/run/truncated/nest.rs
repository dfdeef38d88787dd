//! The aggregates of a mesh, level by level, and their places in the buffers of a device.

use crate::gpu::kernels::uniforms::LatticeOp;
use crate::layout::Problem;
use crate::parallel::pace::pause;
use crate::patch::Fan;
use crate::run::multilevel::NONE;
use crate::run::truncated::aggregation::{Members, Pattern};
use crate::slide::{Movers, OnCurves};

/// The aggregates of the vertices that move, and those of all coarser levels.
#[derive(Default)]
pub(super) struct Nest {
    /// The operation on each level, with zeros in place of the next coarser level.
    levels: Vec<LatticeOp>,
    /// The connectivity of all levels: lists of vertices, aggregates and columns.
    pub(super) structure: Vec<u32>,
    /// Number of four-component rows of all levels. A block of a matrix has four rows.
    pub(super) rows: u32,
    /// Offsets in `structure` of the aggregates of the vertices: aggregate, starts and members.
    pub(super) of_vertices: [u32; 3],
    /// `None` if no vertex slides.
    pub(super) slides: Option<SlideLists>,
}

/// The sliding vertices of a mesh, and the triangles around them.
pub(super) struct SlideLists {
    /// The sliding vertices in the order of [`OnCurves::tangents`].
    pub(super) vertices: Vec<u32>,
    /// Offset in the structure of the index of each vertex's first triangle. Free vertices have none.
    pub(super) corner_starts: u32,
    /// Offset in the structure of the other two vertices of each triangle.
    pub(super) corners: u32,
    /// Number of triangles around sliding vertices, counted once for each of these vertices.
    pub(super) triangles: u32,
}

impl Nest {
    /// Makes the levels from the connectivity of a mesh, with the vertices that slide. The coarsest level has few aggregates,
    /// usually one.
    pub(super) async fn new(problem: &Problem, curves: Option<&OnCurves>) -> Self {
        let movers = Movers::new(problem, curves);
        let (mut first, mut pattern) = movers.joined().await;
        let mut nest = Self::default();
        if let Some(curves) = curves {
            first = of_all_vertices(problem, &movers, &first);
            nest.slides = Some(nest.place_slides(problem, curves));
        }
        nest.of_vertices = nest.place_members(&first);
        drop((first, movers));
        loop {
            pause().await;
            match pattern.joined(1).await {
                Some((members, coarser)) => {
                    nest.add(&pattern, Some(&members));
                    pattern = coarser;
                }
                None => {
                    nest.add(&pattern, None);
                    return nest;
                }
            }
        }
    }

    /// Adds a level with its coarser aggregates, if it has any.
    fn add(&mut self, pattern: &Pattern, members: Option<&Members>) {
        let count = pattern.rows() as u32;
        let [starts, columns] = [&pattern.start, &pattern.columns].map(|list| self.place(list));
        let of_members = members.map(|members| self.place_members(members));
        let [aggregate_of, member_starts, members] = of_members.unwrap_or_default();
        let blocks = taken(&mut self.rows, 4 * pattern.columns.len() as u32);
        let inverses = taken(&mut self.rows, 4 * count);
        let [right, solution, step, left, shifts] =
            std::array::from_fn(|_| taken(&mut self.rows, count));
        self.levels.push(LatticeOp {
            rows: count,
            starts,
            columns,
            aggregate_of,
            member_starts,
            members,
            blocks,
            inverses,
            right,
            solution,
            step,
            left,
            extents: taken(&mut self.rows, 2 * count),
            shifts,
            coarse_starts: 0,
            coarse_columns: 0,
            coarse_blocks: 0,
            coarse_inverses: 0,
            coarse_right: 0,
            coarse_solution: 0,
            coarse_step: 0,
            coarse_extents: 0,
            padding: [0; 2],
        });
    }

    /// Adds a list to the structure. Returns its offset.
    fn place(&mut self, list: &[u32]) -> u32 {
        let at = self.structure.len() as u32;
        self.structure.extend_from_slice(list);
        at
    }

    fn place_slides(&mut self, problem: &Problem, curves: &OnCurves) -> SlideLists {
        let free = problem.free_count();
        let mut fans = vec![None; problem.positions().len() - free];
        let mut vertices = Vec::new();
        for fan in curves.fans() {
            vertices.push(fan.own());
            fans[fan.own() as usize - free] = Some(fan);
        }
        let mut starts = vec![0];
        let mut corners = Vec::new();
        for fan in fans {
            corners.extend(fan.into_iter().flat_map(Fan::marked_others).flatten());
            starts.push(corners.len() as u32 / 2);
        }
        let triangles = starts[starts.len() - 1];
        let (corner_starts, corners) = (self.place(&starts), self.place(&corners));
        SlideLists { vertices, corner_starts, corners, triangles }
    }

    fn place_members(&mut self, members: &Members) -> [u32; 3] {
        [&members.group, &members.start, &members.members].map(|list| self.place(list))
    }

    /// Returns the number of levels.
    pub(super) fn depth(&self) -> usize {
        self.levels.len()
    }

    /// Returns the operation on a level, with the offsets of the next coarser level if there is one.
    pub(super) fn op(&self, level: usize) -> LatticeOp {
        let mut op = self.levels[level];
        if let Some(next) = self.levels.get(level + 1) {
            (op.coarse_starts, op.coarse_columns) = (next.starts, next.columns);
            (op.coarse_blocks, op.coarse_inverses) = (next.blocks, next.inverses);
            (op.coarse_right, op.coarse_step) = (next.right, next.step);
            (op.coarse_solution, op.coarse_extents) = (next.solution, next.extents);
        }
        op
    }
}

/// Returns aggregates with vertices of the problem in place of movers, and with [`NONE`] as the aggregate of fixed vertices.
fn of_all_vertices(problem: &Problem, movers: &Movers<'_>, aggregates: &Members) -> Members {
    let mut group = vec![NONE; problem.positions().len()];
    for (mover, &aggregate) in (0..).zip(&aggregates.group) {
        group[movers.vertex(mover) as usize] = aggregate;
    }
    let members = aggregates.members.iter().map(|&mover| movers.vertex(mover)).collect();
    Members { group, start: aggregates.start.clone(), members }
}

/// Takes room from a total. Returns the offset of the room.
fn taken(total: &mut u32, length: u32) -> u32 {
    let at = *total;
    *total += length;
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::prepare;
    use crate::mesh::Mesh;
    use crate::parallel::pace::now;

    #[test]
    fn levels_end_with_one_aggregate_and_do_not_overlap() {
        let side = 40;
        let points = (0..side * side).map(|k| [f64::from(k % side), f64::from(k / side)]).collect();
        let cells = (0..side * (side - 1)).filter(|k| k % side + 1 < side);
        let triangles =
            cells.flat_map(|k| [[k, k + 1, k + side + 1], [k, k + side + 1, k + side]]).collect();
        let problem = prepare(&Mesh { points, triangles, ..Mesh::default() }).unwrap().1;
        let nest = now(Nest::new(&problem, None));
        assert!(nest.depth() >= 4);
        assert_eq!(nest.op(nest.depth() - 1).rows, 1);
        let ops: Vec<_> = (0..nest.depth()).map(|level| nest.op(level)).collect();
        for pair in ops.windows(2) {
            let [fine, coarse] = [pair[0], pair[1]];
            assert!(coarse.rows < fine.rows);
            assert_eq!(fine.coarse_blocks, coarse.blocks);
            assert_eq!(fine.coarse_solution, coarse.solution);
            assert!(fine.inverses + 4 * fine.rows <= fine.right, "{fine:?}");
            assert!(fine.extents + 2 * fine.rows <= coarse.blocks, "{fine:?}");
        }
    }
}
