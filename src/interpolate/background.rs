//! Interpolation of vertex data of one mesh at arbitrary points.

use super::element::{Cell, LocatedPoint};
use super::interpolation::check_feasible;
use super::locate::Locator;
use crate::error::MeshError;
use crate::mesh::Mesh;
use crate::parallel::map_ranges;
use crate::topology::Topology;

/// Smallest limit of the steps of a walk.
const LEAST_STEPS: usize = 200;
/// Largest number of nearby vertices from which a walk to a point is tried.
const TRIED: usize = 9;

/// A mesh in which arbitrary points are located, such as a mesh that carries the sizes wanted on another mesh.
#[derive(Clone, Debug)]
pub(crate) struct Background {
    topology: Topology<'static>,
    points: Vec<[f64; 2]>,
    seeds: Seeds,
}

/// A located point: the element of a background that contains the point, or the nearest point of an element.
pub(crate) struct Spot {
    found: LocatedPoint,
    /// Distance of the point from the mesh, 0 inside.
    pub(crate) outside: f64,
}

impl Background {
    /// Returns points and corners as words, for the fingerprint of a run.
    pub(crate) fn words(&self) -> Vec<u64> {
        let points = self.points.as_flattened().iter().map(|x| x.to_bits());
        let corners = self.topology.corners().as_flattened().iter().map(|&v| u64::from(v));
        points.chain(corners).collect()
    }

    /// Makes a background; copies the mesh.
    ///
    /// # Errors
    /// [`MeshError::Infeasible`] if triangles are inverted or flat, or if quadrilaterals are not convex, or an error of
    /// [`Topology::new`].
    pub(crate) fn new(mesh: &Mesh) -> Result<Self, MeshError> {
        let topology = Topology::new(mesh)?.into_owned();
        check_feasible(&topology, &mesh.points)?;
        let seeds = Seeds::new(topology.corners(), &mesh.points);
        Ok(Self { topology, points: mesh.points.clone(), seeds })
    }

    /// Locates points, on all cores. Returns a spot per point, in the order of `places`.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if a coordinate of a point is infinite or NaN. The error's `vertex` is the index of the
    /// point in `places`.
    pub(crate) fn find(&self, places: &[[f64; 2]]) -> Result<Vec<Spot>, MeshError> {
        if let Some(vertex) = places.iter().position(|place| !place.iter().all(|x| x.is_finite())) {
            return Err(MeshError::NotFinite { vertex: vertex as u32 });
        }
        // Beyond, squares of distances are infinite.
        let sizes = places.as_flattened().iter().map(|x| x.abs());
        if let Some(size) = sizes.into_iter().find(|&size| size > 1e100) {
            return Err(MeshError::OutOfRange { size });
        }
        let (topology, points) = (&self.topology, &self.points[..]);
        let locator = Locator { topology, points };
        let found = map_ranges(places.len(), 1 << 10, |range| {
            let spot = |place: &[f64; 2]| {
                let found = self.found(&locator, *place)?;
                let at = [0, 1].map(|axis| found.value(|v| points[v as usize][axis]));
                let outside = (at[0] - place[0]).hypot(at[1] - place[1]);
                Some(Spot { found, outside })
            };
            places[range].iter().filter_map(spot).collect::<Vec<_>>()
        });
        Ok(found.into_iter().flatten().collect())
    }

    /// Locates a point by walks from nearby vertices. If the boundary blocks every walk, searches all elements for the
    /// nearest.
    fn found(&self, locator: &Locator<'_>, place: [f64; 2]) -> Option<LocatedPoint> {
        let starts = self.seeds.around(place).filter_map(|v| self.topology.star(v).first());
        // Seeds are equally spaced, and elements may be many times smaller.
        let elements = self.topology.element_count();
        let most = LEAST_STEPS.max(4 * elements.isqrt());
        let mut starts = starts.take(TRIED);
        if let Some(element) = starts.find_map(|&corner| locator.walk(corner, place, most)) {
            return Some(locator.within(element, place));
        }
        let mut best: Option<(f64, u32, [f64; 2])> = None;
        for element in self.topology.corner_list().firsts() {
            // Most elements are skipped, as their bounding box is farther away than the best element.
            let cell = Cell::of(&self.topology, element);
            let apart = [0, 1].map(|axis| {
                let along = || cell.vertices().iter().map(|&v| self.points[v as usize][axis]);
                let (low, high) = (along().reduce(f64::min), along().reduce(f64::max));
                let [low, high] = [low, high].map(|end| end.unwrap_or(f64::INFINITY));
                (low - place[axis]).max(place[axis] - high).max(0.0)
            });
            let is_farther = |&(best, ..): &(f64, u32, [f64; 2])| {
                apart[0] * apart[0] + apart[1] * apart[1] >= best
            };
            if best.as_ref().is_some_and(is_farther) {
                continue;
            }
            let (distance, nearest) = locator.nearest(element, place);
            if best.is_none_or(|(least, ..)| distance < least) {
                best = Some((distance, element, nearest));
            }
            if distance == 0.0 {
                break;
            }
        }
        best.map(|(_, element, nearest)| locator.within(element, nearest))
    }

    /// Returns the value at a spot, interpolated from the values `of` the background's vertices.
    pub(crate) fn value(&self, spot: &Spot, of: impl Fn(u32) -> f64) -> f64 {
        spot.found.value(of)
    }

    /// Returns the least and the largest x coordinate of the background.
    pub(crate) fn breadth(&self) -> [f64; 2] {
        [self.seeds.low[0], self.seeds.low[0] + self.seeds.size[0]]
    }

    /// Returns the larger of the background's width and height.
    pub(crate) fn extent(&self) -> f64 {
        self.seeds.size[0].max(self.seeds.size[1])
    }
}

/// A grid of cells with a vertex each, to find a vertex near any point.
#[derive(Clone, Debug)]
struct Seeds {
    low: [f64; 2],
    size: [f64; 2],
    counts: [usize; 2],
    vertices: Vec<u32>,
}

impl Seeds {
    fn new(corners: &[[u32; 3]], points: &[[f64; 2]]) -> Self {
        let used = corners.as_flattened();
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for &v in used {
            for axis in 0..2 {
                low[axis] = low[axis].min(points[v as usize][axis]);
                high[axis] = high[axis].max(points[v as usize][axis]);
            }
        }
        let size = [high[0] - low[0], high[1] - low[1]];
        // Cells are about as many as vertices, and about as high as wide.
        let wanted = (corners.len() as f64 / 2.0).max(1.0);
        let share = |a: f64, b: f64| (wanted * a / b).sqrt().clamp(1.0, wanted);
        let counts = [share(size[0], size[1]), share(size[1], size[0])].map(|n| n.ceil() as usize);
        let mut seeds = Self { low, size, counts, vertices: vec![u32::MAX; counts[0] * counts[1]] };
        let mut filled = Vec::new();
        for &v in used {
            let cell = seeds.cell(points[v as usize]);
            if seeds.vertices[cell] == u32::MAX {
                seeds.vertices[cell] = v;
                filled.push(cell);
            }
        }
        // Empty cells take the vertex of a neighbor, spreading outward from the filled cells.
        let mut next = 0;
        while let Some(&cell) = filled.get(next) {
            next += 1;
            let (column, row) = (cell % counts[0], cell / counts[0]);
            let beside = [
                (column > 0).then(|| cell - 1),
                (column + 1 < counts[0]).then(|| cell + 1),
                (row > 0).then(|| cell - counts[0]),
                (row + 1 < counts[1]).then(|| cell + counts[0]),
            ];
            for other in beside.into_iter().flatten() {
                if seeds.vertices[other] == u32::MAX {
                    seeds.vertices[other] = seeds.vertices[cell];
                    filled.push(other);
                }
            }
        }
        seeds
    }

    fn cell(&self, place: [f64; 2]) -> usize {
        let [column, row] = [0, 1].map(|axis| {
            let share = (place[axis] - self.low[axis]) / self.size[axis];
            let last = self.counts[axis] - 1;
            // Points outside the grid belong to the nearest cell of its border.
            ((share * self.counts[axis] as f64) as usize).min(last)
        });
        row * self.counts[0] + column
    }

    /// Returns the vertices of the point's cell and of the eight cells around it.
    fn around(&self, place: [f64; 2]) -> impl Iterator<Item = u32> + '_ {
        let cell = self.cell(place);
        let (column, row) = (cell % self.counts[0], cell / self.counts[0]);
        let steps = [[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, -1], [1, -1], [-1, 1]];
        steps.into_iter().filter_map(move |[x, y]: [isize; 2]| {
            let column = column.checked_add_signed(x).filter(|c| *c < self.counts[0])?;
            let row = row.checked_add_signed(y).filter(|r| *r < self.counts[1])?;
            self.vertices.get(row * self.counts[0] + column).copied()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a square ring: 6 by 6 cells without the four cells in the middle.
    fn ring() -> Mesh {
        let points = (0..49).map(|v| [f64::from(v % 7), f64::from(v / 7)]).collect();
        let is_hole = |c: u32, r: u32| (2..4).contains(&c) && (2..4).contains(&r);
        let fields = (0..36).map(|k| (k % 6, k / 6)).filter(|&(c, r)| !is_hole(c, r));
        let of = |(c, r): (u32, u32)| {
            let a = 7 * r + c;
            [[a, a + 1, a + 8], [a, a + 8, a + 7]]
        };
        Mesh { points, triangles: fields.flat_map(of).collect(), ..Mesh::default() }
    }

    #[test]
    fn linear_values_are_found_everywhere_and_the_nearest_outside() {
        let mesh = ring();
        let background = Background::new(&mesh).unwrap();
        let values: Vec<f64> = mesh.points.iter().map(|[x, y]| 3.0 * x - 2.0 * y + 1.0).collect();
        let at = |place: [f64; 2]| {
            let spot = &background.find(&[place]).unwrap()[0];
            (background.value(spot, |v| values[v as usize]), spot.outside)
        };
        for k in 0..200 {
            let place = [f64::from(k) * 0.03, (f64::from(k) * 0.37) % 6.0];
            let is_hole = place.iter().all(|x| (2.0..4.0).contains(x));
            let (value, outside) = at(place);
            if !is_hole {
                let wanted = 3.0 * place[0] - 2.0 * place[1] + 1.0;
                assert!((value - wanted).abs() < 1e-12 && outside < 1e-12, "{place:?}: {value}");
            }
        }
        // Points in the hole and outside the ring, with the nearest points of the ring.
        for (place, [x, y], apart) in [
            ([2.5, 2.9], [2.0, 2.9], 0.5),
            ([-1.0, 3.3], [0.0, 3.3], 1.0),
            ([9.0, 10.0], [6.0, 6.0], 5.0),
        ] {
            let (value, outside) = at(place);
            assert!((value - (3.0 * x - 2.0 * y + 1.0)).abs() < 1e-12, "{place:?}: {value}");
            assert!((outside - apart).abs() < 1e-12, "{place:?}: {outside}");
        }
        let wrong = background.find(&[[0.0, 0.0], [f64::NAN, 1.0]]);
        assert!(matches!(wrong, Err(MeshError::NotFinite { vertex: 1 })));
    }
}
