//! Boundary layers: rows of stretched elements along walls, found by their connectivity and geometry.

mod ends;
mod front;
mod keep;
mod march;
mod measure;
mod sectors;
mod segments;
mod vector;
mod wakes;

use std::collections::HashSet;
use std::str::FromStr;

use march::Rows;
use sectors::Sectors;
use segments::Segments;

use crate::error::MeshError;
use crate::topology::Topology;

/// The elements of a mesh among which layers are searched.
#[derive(Clone, Copy, Debug)]
pub struct Elements<'m> {
    /// The triangles.
    pub topology: &'m Topology<'m>,
    /// Positions of the vertices, in any unit.
    pub points: &'m [[f64; 2]],
    /// Quadrilaterals and larger faces as vertex indices, of either winding.
    pub faces: &'m [Vec<u32>],
    /// Edges inside the mesh that are walls: named lines, and edges between regions. Edges of the boundary are walls
    /// without a list.
    pub lines: &'m [[u32; 2]],
}

/// The layers that a run keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum KeepLayers {
    /// Layers that [`Elements::layers`] finds.
    #[default]
    Auto,
    /// None.
    None,
    /// The first rows above walls; see [`Elements::rows`].
    Rows(u32),
    /// The vertices within a distance of walls; see [`Elements::within`].
    Within(f64),
}

impl KeepLayers {
    /// Finds the layers that a run keeps by [`Mesh::fixed`](crate::Mesh::fixed). `walls` are the vertices of the only walls
    /// that count; `None` stands for all walls at which layers may begin. Vertices of inverted and flat triangles are
    /// left out, so that the triangles can be untangled.
    ///
    /// # Errors
    /// Those of [`Elements::layers`].
    pub fn find(self, elements: &Elements<'_>, walls: Option<&[u32]>) -> Result<Layers, MeshError> {
        let mut layers = match self {
            Self::Auto => elements.layers(walls)?,
            Self::None => return Ok(Layers::default()),
            Self::Rows(count) => elements.rows(count as usize, walls)?,
            Self::Within(distance) => elements.within(distance, walls)?,
        };
        let bad = elements.topology.bad_triangles(elements.points)?;
        if !bad.is_empty() {
            let bad: HashSet<u32> = bad.iter().flat_map(|bad| bad.vertices).collect();
            layers.vertices.retain(|v| !bad.contains(v));
        }
        Ok(layers)
    }
}

impl FromStr for KeepLayers {
    type Err = &'static str;

    /// Reads `auto`, `none`, `rows=N` with N from 1 to 1000, or `within=DISTANCE` with a positive distance.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let rows = |text: &str| text.parse().ok().filter(|n| (1..=1000).contains(n));
        let distance = |text: &str| text.parse().ok().filter(|d: &f64| *d > 0.0 && d.is_finite());
        match (text, text.split_once('=')) {
            ("auto", _) => Ok(Self::Auto),
            ("none", _) => Ok(Self::None),
            (_, Some(("rows", count))) => {
                rows(count).map(Self::Rows).ok_or("give a number of rows from 1 to 1000")
            }
            (_, Some(("within", size))) => {
                distance(size).map(Self::Within).ok_or("give a positive distance")
            }
            _ => Err("give auto, none, rows=N or within=DISTANCE"),
        }
    }
}

/// The boundary layers of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// The vertices of layers, ascending: those in rows, and those on the walls below.
    pub vertices: Vec<u32>,
    /// The vertices of walls below layers, ascending.
    pub walls: Vec<u32>,
    /// The vertices of walls at which a layer may begin, ascending, whether a layer was found there or not.
    pub seeds: Vec<u32>,
    /// Largest number of rows.
    pub rows: usize,
}

impl Layers {
    /// Returns whether the layers have all free vertices of a mesh, and at least one.
    pub fn have_all_free(&self, topology: &Topology<'_>) -> bool {
        let is_free = |v: &&u32| topology.free().get(**v as usize) == Some(&true);
        let free = self.vertices.iter().filter(is_free).count();
        free > 0 && free == topology.free_count()
    }
}

impl Elements<'_> {
    /// Finds the layers: at least three rows above at least eight vertices of a wall, whose columns stand on the vertices
    /// below and whose heights grow. Columns may fan out around edges of a wall and close over noses. Edges of wakes, which
    /// continue a wall as in C-grids, count as walls.
    ///
    /// `walls` are the vertices of the only walls above which layers count; `None` stands for all walls. The time is linear in
    /// the number of elements.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex, [`MeshError::IndexOutOfRange`] if `faces`,
    /// `lines` or `walls` name a vertex that does not exist.
    pub fn layers(&self, walls: Option<&[u32]>) -> Result<Layers, MeshError> {
        self.check(walls)?;
        let found = Found::new(self, self.lines, walls);
        let wakes = found.wakes();
        if !wakes.is_empty() {
            let again = Found::new(self, &[self.lines, &wakes].concat(), walls);
            if !again.is_empty() {
                return Ok(again.layers());
            }
        }
        Ok(found.layers())
    }

    /// Returns the first `count` rows above walls, whatever their heights. Where a column ends, rings of neighbors count as
    /// rows. `walls` are the vertices of the walls; `None` stands for the walls at which layers may begin.
    ///
    /// # Errors
    /// Those of [`layers`](Self::layers).
    pub fn rows(&self, count: usize, walls: Option<&[u32]>) -> Result<Layers, MeshError> {
        self.check(walls)?;
        let (sectors, seeds, front) = self.front(walls);
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
        Ok(collect(&sectors, &seeds, &front, &kept, deepest))
    }

    /// Returns the vertices within a distance of walls, in the unit of the points. `walls` are the vertices of the walls;
    /// `None` stands for the walls at which layers may begin.
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
        let is_near = |n: u32| {
            front[n as usize]
                || (!sectors.is_wall(n) && tree.are_within(sectors.point(n), distance))
        };
        let kept: Vec<bool> = (0..sectors.len() as u32).map(is_near).collect();
        Ok(collect(&sectors, &seeds, &front, &kept, 0))
    }

    /// Returns the sectors of the elements, the seeds, and the front on given walls or on those with seeds.
    fn front(&self, walls: Option<&[u32]>) -> (Sectors, Vec<bool>, Vec<bool>) {
        let sectors = Sectors::new(self.points, self.topology.triangles(), self.faces, self.lines);
        let seeds = front::seeds(&sectors);
        let front = match walls {
            None => front::front(&sectors, &seeds),
            Some(walls) => on_walls(&sectors, walls),
        };
        (sectors, seeds, front)
    }

    /// Checks that all elements, lines and walls name vertices that have points.
    fn check(&self, walls: Option<&[u32]>) -> Result<(), MeshError> {
        self.topology.check_count(self.points)?;
        let vertices = self.points.len();
        let faces = self.faces.iter().flatten();
        let named = faces.chain(self.lines.as_flattened()).chain(walls.into_iter().flatten());
        match named.copied().find(|&v| v as usize >= vertices) {
            Some(vertex) => Err(MeshError::IndexOutOfRange { triangle: None, vertex, vertices }),
            None => Ok(()),
        }
    }
}

/// The rows found above the walls of a mesh.
struct Found {
    sectors: Sectors,
    seeds: Vec<bool>,
    front: Vec<bool>,
    rows: Rows,
    kept: Vec<bool>,
}

impl Found {
    /// Searches the layers above the boundary and `lines`.
    fn new(elements: &Elements<'_>, lines: &[[u32; 2]], walls: Option<&[u32]>) -> Self {
        let sectors =
            Sectors::new(elements.points, elements.topology.triangles(), elements.faces, lines);
        let seeds = front::seeds(&sectors);
        let mut front = front::front(&sectors, &seeds);
        if let Some(walls) = walls {
            let named = on_walls(&sectors, walls);
            front.iter_mut().zip(named).for_each(|(front, named)| *front &= named);
        }
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

    fn is_empty(&self) -> bool {
        !self.front.contains(&true)
    }

    fn wakes(&self) -> Vec<[u32; 2]> {
        wakes::wakes(&self.sectors, &self.rows, &self.kept)
    }

    fn layers(mut self) -> Layers {
        ends::add(&self.sectors, &self.rows, &mut self.kept);
        let has_kept = |row: &Vec<u32>| row.iter().any(|&n| self.kept[n as usize]);
        let deepest = self.rows.lists.iter().rposition(has_kept).unwrap_or(0);
        collect(&self.sectors, &self.seeds, &self.front, &self.kept, deepest)
    }
}

/// Marks the nodes of walls at the given vertices.
fn on_walls(sectors: &Sectors, walls: &[u32]) -> Vec<bool> {
    let named: HashSet<u32> = walls.iter().copied().collect();
    let is_named = |n: u32| sectors.is_wall(n) && named.contains(&sectors.vertex[n as usize]);
    (0..sectors.len() as u32).map(is_named).collect()
}

/// Returns the layers of kept nodes.
fn collect(
    sectors: &Sectors,
    seeds: &[bool],
    front: &[bool],
    kept: &[bool],
    rows: usize,
) -> Layers {
    let [vertices, walls, seeds] = [kept, front, seeds].map(|marked| vertices(sectors, marked));
    Layers { vertices, walls, seeds, rows }
}

/// Returns the vertices of marked nodes, ascending.
fn vertices(sectors: &Sectors, marked: &[bool]) -> Vec<u32> {
    let nodes = sectors.vertex.iter().zip(marked);
    let mut list: Vec<u32> = nodes.filter(|(_, marked)| **marked).map(|(&v, _)| v).collect();
    list.sort_unstable();
    list.dedup();
    list
}
