//! Rows of vertices, one above the other, from a front on the walls.

use crate::layers::measure::Measure;
use crate::layers::sectors::{NONE, Sectors};
use crate::layers::vector::{angle, cross, length, minus};

/// Largest offset of a vertex from the vertex below, as a share of an edge of the row. Extruded columns have offsets of
/// up to 0.1, unstructured meshes have offsets that are uniform from 0 to 0.5.
pub(super) const OFFSET: f64 = 0.3;

/// Largest offset where the columns of both row neighbors go on.
const BRIDGED: f64 = 0.6;

/// Largest growth of the height from row to row, and its inverse.
const GROWTH: f64 = 3.0;

/// Angle of the fluid at a vertex, in degrees, from which several columns may start there: a convex turn of 20 degrees.
const FAN: f64 = 200.0;

/// The rows above a front.
pub(super) struct Rows {
    /// The nodes of each row, row 0 on the wall first.
    pub(super) lists: Vec<Vec<u32>>,
    /// Row of each node; [`NONE`] for a node in no row.
    pub(super) row: Vec<u32>,
    /// Parent of each node: the nearest node of the row before; [`NONE`] in row 0.
    pub(super) parent: Vec<u32>,
    /// Height of each node above the row before, in the unit of the mesh, and its aspect: the mean length of the edges of the
    /// row before beside the parent, divided by the height. 0 and infinite in row 0.
    pub(super) height: Vec<f64>,
    pub(super) aspect: Vec<f64>,
    /// Whether a column goes on above a node.
    pub(super) has_child: Vec<bool>,
    /// Range of each node's row neighbors in `pool`.
    range: Vec<[u32; 2]>,
    pool: Vec<u32>,
}

/// A vertex above a row.
struct Candidate {
    node: u32,
    parent: u32,
    distance: f64,
    measure: Measure,
}

impl Rows {
    /// Finds up to `limit` rows above the nodes of walls that `front` marks.
    pub(super) fn new(sectors: &Sectors, front: &[bool], limit: usize) -> Self {
        let count = sectors.len();
        let first: Vec<u32> =
            (0..).zip(front).filter(|(_, is_front)| **is_front).map(|(node, _)| node).collect();
        let mut rows = Self {
            lists: Vec::new(),
            row: vec![NONE; count],
            parent: vec![NONE; count],
            height: vec![0.0; count],
            aspect: vec![f64::INFINITY; count],
            has_child: vec![false; count],
            range: vec![[0; 2]; count],
            pool: Vec::new(),
        };
        for &node in &first {
            rows.row[node as usize] = 0;
            rows.set_beside(node, &sectors.wall[node as usize]);
        }
        rows.lists.push(first);
        let mut mark = vec![NONE; count];
        while rows.lists.len() <= limit {
            let row = rows.step(sectors, &mut mark);
            if row.is_empty() {
                break;
            }
            rows.lists.push(row);
        }
        rows
    }

    /// Returns the neighbors of a node along its row.
    pub(super) fn beside(&self, node: u32) -> &[u32] {
        let [start, end] = self.range[node as usize];
        &self.pool[start as usize..end as usize]
    }

    fn set_beside(&mut self, node: u32, beside: &[u32]) {
        let start = self.pool.len() as u32;
        self.pool.extend_from_slice(beside);
        self.range[node as usize] = [start, self.pool.len() as u32];
    }

    /// Returns the nodes of the next row. `mark` has an entry per node, [`NONE`] before and after.
    fn step(&mut self, sectors: &Sectors, mark: &mut [u32]) -> Vec<u32> {
        let found = self.candidates(sectors, mark);
        let row = self.lists.len() as u32;
        let (mut near, far): (Vec<_>, Vec<_>) = found
            .into_iter()
            .filter(|c| self.may_follow(sectors, c))
            .partition(|c| c.measure.offset <= OFFSET);
        near.sort_by(|a, b| {
            a.parent
                .cmp(&b.parent)
                .then(a.distance.total_cmp(&b.distance))
                .then(a.node.cmp(&b.node))
        });
        let mut nodes = Vec::with_capacity(near.len());
        for one in &near {
            let parent = one.parent as usize;
            if !self.has_child[parent] || self.fluid(sectors, one.parent) >= FAN {
                self.join(one, row);
                nodes.push(one.node);
            }
        }
        let goes_on: Vec<bool> = far
            .iter()
            .map(|c| {
                let beside = self.beside(c.parent);
                beside.len() >= 2 && beside.iter().all(|&b| self.has_child[b as usize])
            })
            .collect();
        for (one, _) in far.iter().zip(goes_on).filter(|(_, goes_on)| *goes_on) {
            if !self.has_child[one.parent as usize] {
                self.join(one, row);
                nodes.push(one.node);
            }
        }
        nodes.sort_unstable();
        for &node in &nodes {
            let parent = self.parent[node as usize];
            let is_beside = |other: &u32| {
                let of = self.parent[*other as usize];
                self.row[*other as usize] == row
                    && (of == parent || self.beside(parent).contains(&of))
            };
            let beside: Vec<u32> =
                sectors.neighbors(node).iter().copied().filter(is_beside).collect();
            self.set_beside(node, &beside);
        }
        nodes
    }

    /// Returns the nodes inside the mesh that no row has and the last row is next to, each with its nearest node of the
    /// last row.
    fn candidates(&self, sectors: &Sectors, mark: &mut [u32]) -> Vec<Candidate> {
        let last = self.lists.last().map_or(&[][..], Vec::as_slice);
        let mut found: Vec<Candidate> = Vec::new();
        let measure = Measure { offset: 0.0, height: 0.0, aspect: 0.0, along: NONE };
        for &parent in last {
            for &node in sectors.neighbors(parent) {
                if self.row[node as usize] != NONE || sectors.is_wall(node) {
                    continue;
                }
                let distance = length(minus(sectors.point(node), sectors.point(parent)));
                match found.get_mut(mark[node as usize] as usize) {
                    None => {
                        mark[node as usize] = found.len() as u32;
                        found.push(Candidate { node, parent, distance, measure });
                    }
                    Some(own) if distance < own.distance => {
                        (own.parent, own.distance) = (parent, distance);
                    }
                    Some(_) => {}
                }
            }
        }
        for one in &mut found {
            mark[one.node as usize] = NONE;
            one.measure = Measure::new(sectors, one.node, one.parent, self.beside(one.parent));
        }
        found
    }

    /// Returns whether a candidate is above its parent: beyond the row of the parent, at a similar height.
    fn may_follow(&self, sectors: &Sectors, one: &Candidate) -> bool {
        let Measure { offset, height, along, .. } = one.measure;
        if along == NONE || offset.is_nan() || offset > BRIDGED {
            return false;
        }
        let below = self.parent[one.parent as usize];
        if below == NONE {
            return true;
        }
        let growth = height / self.height[one.parent as usize];
        let from = sectors.point(one.parent);
        let edge = minus(sectors.point(along), from);
        let side = |node| cross(edge, minus(sectors.point(node), from));
        (1.0 / GROWTH..=GROWTH).contains(&growth) && side(one.node) * side(below) < 0.0
    }

    /// Returns the angle between the two row edges at a node on the side where the rows grow, in degrees.
    fn fluid(&self, sectors: &Sectors, node: u32) -> f64 {
        let below = self.parent[node as usize];
        if below == NONE {
            return sectors.fluid[node as usize];
        }
        let &[a, b] = self.beside(node) else { return 180.0 };
        let [p, a, b, below] = [node, a, b, below].map(|n| sectors.point(n));
        let whole = angle(p, a, b);
        let is_between = angle(p, a, below) < whole;
        if is_between { 360.0 - whole } else { whole }
    }

    fn join(&mut self, one: &Candidate, row: u32) {
        let node = one.node as usize;
        self.row[node] = row;
        self.parent[node] = one.parent;
        self.height[node] = one.measure.height;
        self.aspect[node] = one.measure.aspect;
        self.has_child[one.parent as usize] = true;
    }
}
