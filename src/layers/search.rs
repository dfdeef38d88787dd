//! The search of layers above the walls of a mesh.

use std::collections::HashSet;

use crate::layers::elements::Elements;
use crate::layers::march::Rows;
use crate::layers::result::Layers;
use crate::layers::sectors::Sectors;
use crate::layers::{ends, front, keep, wakes};

/// A search of layers: the rows above the walls of a mesh, and the nodes that are in layers.
pub(super) struct Search {
    pub(super) sectors: Sectors,
    seeds: Vec<bool>,
    front: Vec<bool>,
    rows: Rows,
    kept: Vec<bool>,
}

impl Search {
    /// Searches the layers above the boundary and `lines`.
    pub(super) fn new(elements: &Elements<'_>, lines: &[[u32; 2]], walls: Option<&[u32]>) -> Self {
        let sectors = Sectors::new(elements, lines);
        let (seeds, mut front) = begin(&sectors, walls);
        let mut rows = Rows::new(&sectors, &front, usize::MAX);
        let mut kept = keep::kept(&rows);
        let judged = keep::judged(&sectors, &rows, &kept);
        if judged != front {
            // Rows above walls without a layer may have taken vertices of a layer.
            front = judged;
            rows = Rows::new(&sectors, &front, usize::MAX);
            kept = keep::kept(&rows);
        }
        Self { sectors, seeds, front, rows, kept }
    }

    /// Returns whether the search has found no layer.
    pub(super) fn is_empty(&self) -> bool {
        !self.front.contains(&true)
    }

    /// Returns the edges of wakes behind the walls of layers, as pairs of vertices.
    pub(super) fn wakes(&self) -> Vec<[u32; 2]> {
        wakes::wakes(&self.sectors, &self.rows, &self.kept)
    }

    /// Returns the layers.
    pub(super) fn layers(mut self) -> Layers {
        ends::add(&self.sectors, &self.rows, &mut self.kept);
        let has_kept = |row: &Vec<u32>| row.iter().any(|&n| self.kept[n as usize]);
        let deepest = self.rows.lists.iter().rposition(has_kept).unwrap_or(0);
        let sides = ends::sides(&self.sectors, &self.rows, &self.kept);
        let marked =
            Marked { seeds: &self.seeds, front: &self.front, kept: &self.kept, sides: &sides };
        marked.layers(&self.sectors, deepest)
    }
}

/// Returns the result of a search if the first rows above walls already show that there is no layer, from the elements near walls
/// alone. Most meshes have no layer, and a search through all elements takes a tenth of the time of a run.
pub(super) fn without_layers(elements: &Elements<'_>, walls: Option<&[u32]>) -> Option<Layers> {
    // A row is one edge farther from the walls than the row before, and so are its neighbors.
    let sectors = Sectors::near_walls(elements, keep::ROWS as usize + 1);
    let (seeds, front) = begin(&sectors, walls);
    let rows = Rows::new(&sectors, &front, keep::ROWS as usize);
    let deep = keep::judged_by(keep::is_deep, &sectors, &rows, &keep::kept(&rows));
    if deep.contains(&true) {
        return None;
    }
    let none = vec![false; sectors.len()];
    Some(Marked { seeds: &seeds, front: &none, kept: &none, sides: &none }.layers(&sectors, 0))
}

/// Returns the seeds, and the front at which the search begins.
fn begin(sectors: &Sectors, walls: Option<&[u32]>) -> (Vec<bool>, Vec<bool>) {
    let seeds = front::seeds(sectors);
    let mut front = front::front(sectors, &seeds);
    if let Some(walls) = walls {
        let named = on_walls(sectors, walls);
        front.iter_mut().zip(named).for_each(|(front, named)| *front &= named);
    }
    (seeds, front)
}

/// Marks the nodes of walls at the given vertices.
pub(super) fn on_walls(sectors: &Sectors, walls: &[u32]) -> Vec<bool> {
    let named: HashSet<u32> = walls.iter().copied().collect();
    let is_named = |n: u32| sectors.is_wall(n) && named.contains(&sectors.vertex[n as usize]);
    (0..sectors.len() as u32).map(is_named).collect()
}

/// Marks of nodes.
pub(super) struct Marked<'m> {
    /// Nodes of walls at which a layer may begin.
    pub(super) seeds: &'m [bool],
    /// Nodes of walls below layers.
    pub(super) front: &'m [bool],
    /// Nodes of layers, those of the front included.
    pub(super) kept: &'m [bool],
    /// Nodes of other walls at the ends of rows.
    pub(super) sides: &'m [bool],
}

impl Marked<'_> {
    /// Returns the vertices of the nodes as layers of at most `rows` rows.
    pub(super) fn layers(&self, sectors: &Sectors, rows: usize) -> Layers {
        let vertices = |marked: &dyn Fn(usize) -> bool| {
            let nodes = (0..sectors.len()).filter(|&n| marked(n));
            let mut list: Vec<u32> = nodes.map(|n| sectors.vertex[n]).collect();
            list.sort_unstable();
            list.dedup();
            list
        };
        Layers {
            vertices: vertices(&|n| self.kept[n] || self.sides[n]),
            walls: vertices(&|n| self.front[n]),
            sides: vertices(&|n| self.sides[n] && !self.front[n]),
            seeds: vertices(&|n| self.seeds[n]),
            rows,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::topology::Topology;

    /// Returns a generator of numbers from 0 to 1.
    fn random(mut state: u64) -> impl FnMut() -> f64 {
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / (1u64 << 31) as f64
        }
    }

    /// Rows of a channel.
    const ROWS: u32 = 18;

    /// Returns the mesh of a channel of 12 columns of cells. Four rows of cells grow by `growth` from the height `first` at both
    /// walls. Each cell is a quadrilateral or two triangles, and vertices inside move by up to `shift` of a cell.
    fn channel(random: &mut impl FnMut() -> f64, first: f64, growth: f64, shift: f64) -> Mesh {
        let mut mesh = Mesh::default();
        let mut y = 0.0;
        for row in 0..=ROWS {
            let height = first * growth.powi(row.min(ROWS - 1 - row.min(ROWS - 1)).min(4) as i32);
            for column in 0..=12 {
                let is_inside = (1..ROWS).contains(&row) && (1..12).contains(&column);
                let mut moved =
                    |size: f64| if is_inside { shift * size * (random() - 0.5) } else { 0.0 };
                mesh.points.push([f64::from(column) + moved(1.0), y + moved(first)]);
            }
            y += height;
        }
        for row in 0..ROWS {
            for column in 0..12 {
                let a = row * 13 + column;
                let [b, c, d] = [a + 1, a + 14, a + 13];
                match (random() * 4.0) as u32 {
                    0 => mesh.quadrilaterals.push([a, b, c, d]),
                    1 => mesh.triangles.extend([[a, b, c], [a, c, d]]),
                    _ => mesh.triangles.extend([[a, b, d], [b, c, d]]),
                }
            }
        }
        mesh
    }

    #[test]
    fn elements_near_walls_show_the_lack_of_layers_that_all_elements_show() {
        let mut random = random(3);
        let [mut without, mut with] = [0; 2];
        for round in 0..200 {
            let first = 0.05 + 0.8 * random();
            let growth = 1.1 + 0.5 * random();
            let shift = random();
            let mut mesh = channel(&mut random, first, growth, shift);
            mesh.fixed = (0..random() as u32 * 9).map(|k| 20 + k).collect();
            let faces = match round % 3 {
                0 => mesh.quadrilaterals.drain(..).map(Vec::from).collect(),
                _ => Vec::new(),
            };
            let line: Vec<[u32; 2]> = (0..12).map(|k| [117 + k, 118 + k]).collect();
            let lines = if round % 2 == 0 { &line[..] } else { &[] };
            let walls: Vec<u32> = (0..13).collect();
            let walls = (round % 5 == 0).then_some(&walls[..]);
            let topology = Topology::new(&mesh).unwrap();
            let (points, faces) = (&mesh.points[..], &faces[..]);
            let elements = Elements { topology: &topology, points, faces, lines };
            let whole = Search::new(&elements, lines, walls);
            match without_layers(&elements, walls) {
                Some(none) => {
                    assert!(whole.is_empty() && whole.wakes().is_empty(), "{round}");
                    assert_eq!(whole.layers(), none, "{round}");
                    without += 1;
                }
                None => with += usize::from(!whole.is_empty()),
            }
        }
        assert!(without > 30 && with > 10, "{without} without, {with} with layers");
    }
}
