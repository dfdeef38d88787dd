//! Meshes with layers whose rows are known: columns of vertices above walls, and triangles around them.

use std::collections::{HashMap, HashSet};

use gpu_smooth::Mesh;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters};
use spade::{HasPosition, Triangulation};
use support::SplitMix64;

/// How the quadrilaterals between columns become elements.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cut {
    Aligned,
    Alternating,
    Random,
    Shortest,
    /// Quadrilaterals stay.
    Whole,
}

/// All ways to cut quadrilaterals into triangles.
pub(super) const CUTS: [Cut; 4] = [Cut::Aligned, Cut::Alternating, Cut::Random, Cut::Shortest];

/// A mesh with layers.
#[derive(Clone, Debug, Default)]
pub(super) struct Grown {
    pub(super) mesh: Mesh,
    /// Quadrilaterals, whose corners are fixed in the mesh.
    pub(super) faces: Vec<Vec<u32>>,
    /// Edges inside the mesh that are walls.
    pub(super) lines: Vec<[u32; 2]>,
    /// Row of each vertex in a layer: 0 on the wall. `None` outside of layers.
    pub(super) row: Vec<Option<usize>>,
    /// Vertices of each column, from the wall upward.
    pub(super) columns: Vec<Vec<u32>>,
}

impl Grown {
    /// Weaves columns of points, in the order of a wall with the fluid on its left. The first `rows` rows are in a layer.
    /// Neighboring columns that begin at equal points begin at one vertex. Triangles close the steps between columns of
    /// different lengths.
    pub(super) fn woven(columns: &[Vec<[f64; 2]>], is_closed: bool, rows: usize, cut: Cut) -> Self {
        let mut grown = Self::default();
        for (c, column) in columns.iter().enumerate() {
            let mut own = Vec::with_capacity(column.len());
            for (k, &point) in column.iter().enumerate() {
                match k == 0 && c > 0 && columns[c - 1][0] == point {
                    true => own.push(grown.columns[c - 1][0]),
                    false => own.push(grown.add(point, (k <= rows).then_some(k))),
                }
            }
            grown.columns.push(own);
        }
        let mut rng = SplitMix64::new(7);
        let count = columns.len();
        for c in 0..count - usize::from(!is_closed) {
            let [left, right] = [c, (c + 1) % count].map(|c| grown.columns[c].clone());
            let low = left.len().min(right.len()) - 1;
            for k in 0..low {
                let quad = [left[k], right[k], right[k + 1], left[k + 1]];
                grown.fill(quad, c % 2 == 0, cut, &mut rng);
            }
            let triangles = &mut grown.mesh.triangles;
            triangles.extend(left[low..].windows(2).map(|w| [w[0], right[low], w[1]]));
            triangles.extend(right[low..].windows(2).map(|w| [left[low], w[0], w[1]]));
        }
        grown
    }

    /// Adds a vertex, and returns its index.
    pub(super) fn add(&mut self, point: [f64; 2], row: Option<usize>) -> u32 {
        self.mesh.points.push(point);
        self.row.push(row);
        self.mesh.points.len() as u32 - 1
    }

    /// Adds a quadrilateral whose first two corners may be one vertex.
    pub(super) fn fill(
        &mut self,
        [p, q, r, s]: [u32; 4],
        is_even: bool,
        cut: Cut,
        rng: &mut SplitMix64,
    ) {
        if p == q {
            self.mesh.triangles.push([p, r, s]);
            return;
        }
        let distance = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|v| self.mesh.points[v as usize]);
            (a[0] - b[0]).hypot(a[1] - b[1])
        };
        let is_first = match cut {
            Cut::Aligned => true,
            Cut::Alternating => is_even,
            Cut::Random => rng.below(2) == 0,
            Cut::Shortest => distance(p, r) <= distance(q, s),
            Cut::Whole => {
                self.faces.push(vec![p, q, r, s]);
                self.mesh.fixed.extend([p, q, r, s]);
                return;
            }
        };
        let area = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|v| self.mesh.points[v as usize]);
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        let [first, second] = [[[p, q, r], [p, r, s]], [[p, q, s], [q, r, s]]];
        let is_valid = |cut: [[u32; 3]; 2]| cut.into_iter().all(|t| area(t) > 0.0);
        let takes_first = if is_first { is_valid(first) } else { !is_valid(second) };
        self.mesh.triangles.extend(if takes_first { first } else { second });
    }

    /// Fills the region between an outer loop of vertices and inner loops with triangles of angles of 25 degrees and more
    /// where the loops allow them. Edges of the loops are not split.
    pub(super) fn surround(&mut self, loops: &[Vec<u32>], size: f64) {
        let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        let mut vertices = Vec::new();
        for ring in loops {
            let handles: Vec<_> = ring
                .iter()
                .map(|&v| {
                    let [x, y] = self.mesh.points[v as usize];
                    vertices.push(v);
                    cdt.insert(Point2::new(x, y)).unwrap()
                })
                .collect();
            for i in 0..handles.len() {
                assert!(cdt.add_constraint(handles[i], handles[(i + 1) % handles.len()]));
            }
        }
        assert_eq!(cdt.num_vertices(), vertices.len(), "a loop has a vertex twice");
        let result = cdt.refine(
            RefinementParameters::<f64>::new()
                .with_angle_limit(AngleLimit::from_deg(25.0))
                .with_max_allowed_area(0.43 * size * size)
                .keep_constraint_edges()
                .exclude_outer_faces(true),
        );
        let mut is_outside = vec![false; cdt.num_all_faces()];
        result.excluded_faces.iter().for_each(|face| is_outside[face.index()] = true);
        for vertex in cdt.vertices().skip(vertices.len()) {
            let Point2 { x, y } = vertex.data().position();
            vertices.push(self.add([x, y], None));
        }
        for face in cdt.inner_faces().filter(|face| !is_outside[face.index()]) {
            self.mesh.triangles.push(face.vertices().map(|v| vertices[v.fix().index()]));
        }
    }

    /// Adds the elements of another mesh, with vertices of their own.
    pub(super) fn append(&mut self, other: Self) {
        let offset = self.mesh.points.len() as u32;
        let moved = |v: u32| v + offset;
        self.mesh.points.extend(other.mesh.points);
        self.mesh.triangles.extend(other.mesh.triangles.into_iter().map(|t| t.map(moved)));
        self.mesh.fixed.extend(other.mesh.fixed.into_iter().map(moved));
        let all =
            |lists: Vec<Vec<u32>>| lists.into_iter().map(|l| l.into_iter().map(moved).collect());
        self.faces.extend(all(other.faces));
        self.columns.extend(all(other.columns));
        self.row.extend(other.row);
    }

    /// Gives the vertices `from` of a mesh the places of the vertices `to`, in all elements.
    pub(super) fn merge(&mut self, pairs: impl IntoIterator<Item = [u32; 2]>) {
        let mut new: Vec<u32> = (0..self.mesh.points.len() as u32).collect();
        pairs.into_iter().for_each(|[from, to]| new[from as usize] = to);
        let vertices = self.mesh.triangles.as_flattened_mut().iter_mut();
        vertices.chain(self.faces.iter_mut().flatten()).for_each(|v| *v = new[*v as usize]);
    }

    /// Returns the vertices of the boundary between two vertices, with the elements on the left.
    pub(super) fn outline(&self, from: u32, to: u32) -> Vec<u32> {
        let sides: HashMap<u32, u32> = self.sides().into_iter().collect();
        let mut outline = vec![from];
        while outline.last() != Some(&to) {
            outline.push(sides[outline.last().unwrap()]);
        }
        outline
    }

    /// Returns the edges that one element has, with the element on the left.
    fn sides(&self) -> Vec<(u32, u32)> {
        let elements = self.mesh.triangles.iter().map(<[u32; 3]>::as_slice);
        let elements = elements.chain(self.faces.iter().map(Vec::as_slice));
        let edges =
            |e: &[u32]| (0..e.len()).map(|i| (e[i], e[(i + 1) % e.len()])).collect::<Vec<_>>();
        let all: HashSet<(u32, u32)> = elements.flat_map(edges).collect();
        let mut sides: Vec<_> =
            all.iter().copied().filter(|&(a, b)| !all.contains(&(b, a))).collect();
        sides.sort_unstable();
        sides
    }

    /// Adds the vertices of a path of straight lines between corners, with edges of about the given length. The last
    /// corner is left out.
    pub(super) fn path(&mut self, corners: &[[f64; 2]], edge: f64) -> Vec<u32> {
        let mut path = Vec::new();
        for ends in corners.windows(2) {
            let [[ax, ay], [bx, by]] = [ends[0], ends[1]];
            let count = ((bx - ax).hypot(by - ay) / edge).round().max(1.0);
            for i in 0..count as usize {
                let share = i as f64 / count;
                path.push(self.add([ax + share * (bx - ax), ay + share * (by - ay)], None));
            }
        }
        path
    }

    /// Returns whether each vertex is on an edge that one element has.
    pub(super) fn boundary(&self) -> Vec<bool> {
        let mut is_boundary = vec![false; self.mesh.points.len()];
        self.sides().into_iter().for_each(|(v, _)| is_boundary[v as usize] = true);
        is_boundary
    }
}
