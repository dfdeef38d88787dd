//! Layers above walls: those that are found, a number of rows, and all vertices within a distance.

use crate::error::MeshError;
use crate::layers::elements::Elements;
use crate::layers::march::Rows;
use crate::layers::result::Layers;
use crate::layers::search::{Marked, Search, on_walls, without_layers};
use crate::layers::sectors::Sectors;
use crate::layers::segments::Segments;
use crate::layers::{ends, front};

impl Elements<'_> {
    /// Finds the layers above walls. A layer has at least three rows above at least eight vertices of a wall. Each vertex of
    /// a row stands on a vertex of the row below, and heights grow from row to row. Columns may fan out around edges of a
    /// wall and close over noses. Edges of wakes, which continue a wall as in C-grids, count as walls.
    ///
    /// `walls` are the vertices of the only walls above which layers count; `None` stands for all walls. The time is linear in
    /// the number of elements.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex, [`MeshError::IndexOutOfRange`] if `faces`,
    /// `lines` or `walls` name a vertex that does not exist.
    pub fn layers(&self, walls: Option<&[u32]>) -> Result<Layers, MeshError> {
        self.check(walls)?;
        if let Some(none) = without_layers(self, walls) {
            return Ok(none);
        }
        let found = Search::new(self, self.lines, walls);
        let wakes = found.wakes();
        if !wakes.is_empty() {
            let again = Search::new(self, &[self.lines, &wakes].concat(), walls);
            if !again.is_empty() {
                return Ok(again.layers());
            }
        }
        Ok(found.layers())
    }

    /// Returns the first `count` rows above walls, whatever their heights. Where a column ends, rings of neighbors count as
    /// rows. `walls` are the vertices of the walls; `None` stands for each wall, from corner to corner, of which a
    /// layer may begin at a quarter of the vertices, and for these vertices of other walls. At corners, the elements have an angle below 120 degrees.
    ///
    /// # Errors
    /// Those of [`layers`](Self::layers).
    pub fn rows(&self, count: usize, walls: Option<&[u32]>) -> Result<Layers, MeshError> {
        self.check(walls)?;
        let (sectors, seeds, front) = self.front(walls);
        // No more rows have a node.
        let count = count.min(sectors.len());
        let rows = Rows::new(&sectors, &front, count);
        let mut level = rows.row.clone();
        let mut lists = rows.lists.clone();
        lists.resize(count + 1, Vec::new());
        for k in 0..count {
            for i in 0..lists[k].len() {
                let node = lists[k][i];
                if rows.has_child[node as usize] {
                    continue;
                }
                for &other in sectors.neighbors(node) {
                    if level[other as usize] > k as u32 + 1 && !sectors.is_wall(other) {
                        level[other as usize] = k as u32 + 1;
                        lists[k + 1].push(other);
                    }
                }
            }
        }
        let kept: Vec<bool> = level.iter().map(|&level| level as usize <= count).collect();
        let deepest = lists.iter().rposition(|list| !list.is_empty()).unwrap_or(0);
        let sides = ends::sides(&sectors, &rows, &kept);
        let marked = Marked { seeds: &seeds, front: &front, kept: &kept, sides: &sides };
        Ok(marked.layers(&sectors, deepest))
    }

    /// Returns the vertices within a distance of walls, in the unit of the points. `walls` are the vertices of the walls;
    /// `None` stands for the walls of [`rows`](Self::rows).
    ///
    /// # Errors
    /// Those of [`layers`](Self::layers).
    pub fn within(&self, distance: f64, walls: Option<&[u32]>) -> Result<Layers, MeshError> {
        self.check(walls)?;
        let (sectors, seeds, front) = self.front(walls);
        let mut edges = Vec::new();
        for node in (0..sectors.len() as u32).filter(|&n| front[n as usize]) {
            let after = sectors.wall[node as usize][1];
            let end = if front[after as usize] { after } else { node };
            edges.push([sectors.point(node), sectors.point(end)]);
        }
        let tree = Segments::new(edges);
        let is_near = |n: u32| front[n as usize] || tree.are_within(sectors.point(n), distance);
        let kept: Vec<bool> = (0..sectors.len() as u32).map(is_near).collect();
        let is_side = |n: u32| kept[n as usize] && !front[n as usize] && sectors.is_wall(n);
        let sides: Vec<bool> = (0..sectors.len() as u32).map(is_side).collect();
        let marked = Marked { seeds: &seeds, front: &front, kept: &kept, sides: &sides };
        Ok(marked.layers(&sectors, 0))
    }

    /// Returns the sectors of the elements, the seeds, and the front on given walls or on those with seeds.
    fn front(&self, walls: Option<&[u32]>) -> (Sectors, Vec<bool>, Vec<bool>) {
        let sectors = Sectors::new(self, self.lines);
        let seeds = front::seeds(&sectors);
        let front = match walls {
            None => front::walls(&sectors, &seeds),
            Some(walls) => on_walls(&sectors, walls),
        };
        (sectors, seeds, front)
    }
}
