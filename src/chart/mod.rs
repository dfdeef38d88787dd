//! Charts of meshes in longitude and latitude. Longitudes are continued across the line where they jump by a full turn,
//! and elements at a pole get separate copies of the pole vertex.

mod turns;

use std::collections::HashMap;

use crate::chart::turns::{TURN, Turned, is_pole, pole_of, span, turned};
use crate::error::MeshError;
use crate::mesh::{Element, Mesh};
use crate::precision::Precision;

/// A mesh in longitude and latitude, in degrees, whose longitudes continue across the line where they jump by a full
/// turn. The jump is at 180, or at 0 if longitudes run from 0 to 360. In the chart, elements across the line have the
/// same shape in coordinates as elements elsewhere.
///
/// If a part of the mesh closes around the globe, the chart cuts the part along that line. A pole at which elements
/// meet is cut too. A vertex on a cut has copies, which come after all other vertices of the chart's mesh; the vertex
/// itself keeps its index. Cuts are part of the boundary of the chart's mesh, so vertices on cuts do not move.
/// Elements keep their indices.
///
/// ```
/// use gpu_smooth::{Mesh, front_ends::Chart, options::Precision};
///
/// // A square across the date line with a vertex in its middle.
/// let points = vec![[179.0, 0.0], [-179.0, 0.0], [-179.0, 2.0], [179.0, 2.0], [-179.8, 1.1]];
/// let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
/// let mesh = Mesh { points, triangles, ..Mesh::default() };
/// let chart = Chart::new(&mesh, Precision::Double)?.expect("elements are across the date line");
/// assert_eq!(chart.mesh().points[4], [180.2, 1.1]);
/// let mut moved = chart.mesh().points.clone();
/// moved[4] = [180.0625, 1.0];
/// assert_eq!(chart.given(&moved)[4], [-179.9375, 1.0]);
/// # Ok::<(), gpu_smooth::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Chart {
    mesh: Mesh,
    /// The mesh whose chart this is, with longitudes as stored.
    given: Mesh,
    stored: Precision,
    /// Original vertex of each copy, in the order of the copies.
    owners: Vec<u32>,
    /// Ascending indices of the vertices on cuts of the chart, copies included, and opposite to a pole in a quadrilateral.
    /// They do not move.
    held: Vec<u32>,
    across: usize,
    polar: usize,
}

impl Chart {
    /// Makes the chart of a mesh whose coordinates are stored with the given precision. Returns `None` if no element
    /// is across the line or at a pole, so that the mesh needs no chart. Also returns `None` if an element has a vertex
    /// that does not exist or has a coordinate that is infinite or NaN.
    ///
    /// # Errors
    /// [`MeshError::Latitude`] if a latitude is not from -90 to 90 degrees, [`MeshError::Pole`] if a pole is inside an
    /// element or on an edge.
    pub fn new(mesh: &Mesh, stored: Precision) -> Result<Option<Self>, MeshError> {
        let points = &mesh.points;
        let used = || elements(mesh).flat_map(|(_, vertices)| vertices);
        let has_point = |&v: &u32| points.get(v as usize).is_some_and(|[x, y]| (x + y).is_finite());
        if !used().all(has_point) {
            return Ok(None);
        }
        let is_off = |&&v: &&u32| points[v as usize][1].abs() > 90.0;
        if let Some(&vertex) = used().find(is_off) {
            return Err(MeshError::Latitude { vertex });
        }
        let count = |is: fn(&[[f64; 2]], &[u32]) -> bool| {
            elements(mesh).filter(|(_, vertices)| is(points, vertices)).count()
        };
        let across = count(|points, element| span(points, element) >= TURN / 2.0);
        let polar = count(|points, element| pole_of(points, element).is_some());
        if across == 0 && polar == 0 {
            return Ok(None);
        }
        let turned = turned(points, elements(mesh))?;
        Ok(Some(Self::of_turned(mesh, stored, &turned, [across, polar])))
    }

    fn of_turned(
        given: &Mesh,
        stored: Precision,
        turned: &[Turned],
        [across, polar]: [usize; 2],
    ) -> Self {
        let mut mesh = given.clone();
        // The vertex itself takes the number of turns nearest to 0; each other number of turns gets a copy.
        let mut own: Vec<Option<i32>> = vec![None; given.points.len()];
        for &(v, turns) in turned {
            let (Some(turns), own) = (turns, &mut own[v as usize]) else { continue };
            if own.is_none_or(|own| (turns.abs(), turns) < (own.abs(), own)) {
                *own = Some(turns);
            }
        }
        let place = |v: u32, turns: i32| {
            let [x, y] = given.points[v as usize];
            [stored.rounded(x + TURN * f64::from(turns)), y]
        };
        for (v, own) in (0..).zip(&own) {
            if let Some(turns @ (..=-1 | 1..)) = *own {
                mesh.points[v as usize] = place(v, turns);
            }
        }
        let (mut owners, mut held, mut copies) = (Vec::new(), Vec::new(), HashMap::new());
        let mut left = turned;
        let Mesh { points, triangles, quadrilaterals, fixed } = &mut mesh;
        let triangles = triangles.iter_mut().map(|t| &mut t[..]);
        for element in triangles.chain(quadrilaterals.iter_mut().map(|q| &mut q[..])) {
            let (turned, after) = left.split_at(element.len());
            left = after;
            for (vertex, &(v, turns)) in element.iter_mut().zip(turned) {
                let Some(turns) = turns else { continue };
                if own[v as usize] == Some(turns) {
                    continue;
                }
                *vertex = *copies.entry((v, turns)).or_insert_with(|| {
                    let copy = points.len() as u32;
                    points.push(place(v, turns));
                    owners.push(v);
                    held.extend([v, copy]);
                    copy
                });
            }
            if let Some(at) = turned.iter().position(|(_, turns)| turns.is_none()) {
                let (pole, count) = (element[at], element.len());
                let beside = [element[(at + 1) % count], element[(at + count - 1) % count]];
                let [[a, _], [b, _]] = beside.map(|other| points[other as usize]);
                let copy = points.len() as u32;
                points.push([stored.rounded(0.5 * (a + b)), given.points[pole as usize][1]]);
                owners.push(pole);
                element[at] = copy;
                // The vertex opposite to the pole in a quadrilateral is on no cut, so not on the boundary.
                fixed.extend((count == 4).then(|| element[(at + 2) % 4]));
                held.push(pole);
                held.extend_from_slice(element);
            }
        }
        held.sort_unstable();
        held.dedup();
        Self { mesh, given: given.clone(), stored, owners, held, across, polar }
    }

    /// Returns the mesh with continued longitudes: first the given vertices, then the copies.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the given mesh, with longitudes as stored.
    pub fn original(&self) -> &Mesh {
        &self.given
    }

    /// Returns the vertices of the chart's mesh that do not move because they are on a cut, copies included, or opposite to a
    /// pole in a quadrilateral, ascending.
    pub fn held(&self) -> &[u32] {
        &self.held
    }

    /// Returns for each copy, in order, the vertex of the given mesh that was copied.
    pub fn owners(&self) -> &[u32] {
        &self.owners
    }

    /// Returns the number of elements that reach across the line where longitudes jump by a full turn.
    pub fn across(&self) -> usize {
        self.across
    }

    /// Returns the number of elements with exactly one vertex at a pole.
    pub fn polar(&self) -> usize {
        self.polar
    }

    /// Returns the points of the chart's mesh for new points of the given mesh, in degrees. Each longitude is shifted
    /// by the whole turns that bring it nearest to the chart's point of the vertex. If `given` has fewer points than
    /// the mesh has vertices, the remaining vertices keep their points in the chart; excess points are ignored.
    pub fn continued(&self, given: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut points = self.mesh.points.clone();
        let count = self.given.points.len();
        let same = |v: usize| given.get(v).map(bits) == Some(bits(&self.given.points[v]));
        for v in (0..count.min(given.len())).filter(|&v| !same(v)) {
            let [x, y] = given[v];
            let turns = ((self.mesh.points[v][0] - x) / TURN).round();
            points[v] = [self.stored.rounded(x + TURN * turns), y];
        }
        let (points_of_vertices, copies) = points.split_at_mut(count);
        for (copy, &owner) in copies.iter_mut().zip(&self.owners) {
            // The copies of a moved vertex move with the vertex.
            if !same(owner as usize) && !is_pole(&self.given.points, owner) {
                let [x, y] = points_of_vertices[owner as usize];
                let turns = ((copy[0] - x) / TURN).round();
                *copy = [self.stored.rounded(x + TURN * turns), y];
            }
        }
        points
    }

    /// Returns the chart for new positions of the given mesh; see [`continued`](Self::continued).
    pub fn moved(&self, given: &Mesh) -> Self {
        let mesh = Mesh { points: self.continued(&given.points), ..self.mesh.clone() };
        Self { mesh, given: given.clone(), ..self.clone() }
    }

    /// Extends data of the given mesh's vertices, `each` numbers per vertex, to the vertices of the chart's mesh. A
    /// copy gets the data of the copied vertex.
    pub fn extended(&self, values: &[f64], each: usize) -> Vec<f64> {
        let of = |&v: &u32| values.iter().skip(v as usize * each).take(each).copied();
        values.iter().copied().chain(self.owners.iter().flat_map(of)).collect()
    }

    /// Returns the points of the given mesh, in degrees, for points of the chart's mesh. Longitudes return to the range
    /// of the given mesh. Points that have not moved keep their bits.
    pub fn given(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let range = self.range();
        let back = |((now, was), given): ((&[f64; 2], &[f64; 2]), &[f64; 2])| {
            if bits(now) == bits(was) {
                return *given;
            }
            let x = now[0] - TURN * ((was[0] - given[0]) / TURN).round();
            [brought_back(x, range), now[1]]
        };
        let pairs = points.iter().zip(&self.mesh.points).zip(&self.given.points);
        pairs.map(back).collect()
    }

    /// Returns a longitude of the chart, in degrees, in the range of the given mesh: from -180 to 180, or from 0 to
    /// 360. If the given mesh exceeds both ranges, the longitude is returned unchanged.
    pub fn given_longitude(&self, longitude: f64) -> f64 {
        brought_back(longitude, self.range())
    }

    /// Returns the range that contains all longitudes of the given mesh: [-180, 180] or else [0, 360], `None` if
    /// neither does.
    fn range(&self) -> Option<[f64; 2]> {
        let all = || self.given.points.iter().map(|point| point[0]);
        let ranges = [[-180.0, 180.0], [0.0, TURN]];
        ranges.into_iter().find(|[low, high]| all().all(|x| (*low..=*high).contains(&x)))
    }
}

/// Returns the elements of a mesh with their vertices, the triangles first.
fn elements(mesh: &Mesh) -> impl Iterator<Item = (Element, &[u32])> + Clone {
    let triangles = mesh.triangles.iter().enumerate();
    let triangles = triangles.map(|(index, vertices)| (Element::Triangle(index), &vertices[..]));
    let others = mesh.quadrilaterals.iter().enumerate();
    triangles.chain(others.map(|(index, q)| (Element::Quadrilateral(index), &q[..])))
}

/// Returns a longitude that is less than a turn outside of `range`, shifted by a turn into the range.
fn brought_back(x: f64, range: Option<[f64; 2]>) -> f64 {
    match range {
        Some([_, high]) if x > high => x - TURN,
        Some([low, _]) if x < low => x + TURN,
        _ => x,
    }
}

fn bits(point: &[f64; 2]) -> [u64; 2] {
    point.map(f64::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::Topology;

    /// Returns a grid of cells of 20 by 10 degrees whose southwest corner is given. `written` turns each longitude into
    /// the longitude that the mesh stores.
    fn grid(
        [columns, rows]: [u32; 2],
        [west, south]: [f64; 2],
        written: impl Fn(f64) -> f64,
    ) -> Mesh {
        let closes = columns == 18;
        let across = if closes { columns } else { columns + 1 };
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for row in 0..=rows {
            for column in 0..across {
                let x = west + 20.0 * f64::from(column);
                points.push([written(x), south + 10.0 * f64::from(row)]);
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let at = |c: u32, r: u32| (row + r) * across + (column + c) % across;
                triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
                triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
        Mesh { points, triangles, ..Mesh::default() }
    }

    fn within_half(x: f64) -> f64 {
        (x + 180.0).rem_euclid(360.0) - 180.0
    }

    #[track_caller]
    fn assert_sound(chart: &Chart) {
        let mesh = chart.mesh();
        let topology = Topology::new(mesh).unwrap();
        assert_eq!(topology.bad_triangles(&mesh.points), Ok(vec![]));
        assert_eq!(topology.bad_quadrilaterals(&mesh.points), Ok(vec![]));
        assert!(elements(mesh).all(|(_, vertices)| span(&mesh.points, vertices) < 90.0));
        assert!(chart.held().iter().all(|&v| !topology.free()[v as usize]));
    }

    #[test]
    fn a_strip_across_the_date_line_is_continued_and_written_back_to_the_bit() {
        for (west, written) in
            [(130.0, within_half as fn(f64) -> f64), (-50.0, |x| x.rem_euclid(360.0))]
        {
            let mesh = grid([6, 3], [west, -20.0], written);
            let chart = Chart::new(&mesh, Precision::Double).unwrap().unwrap();
            assert_sound(&chart);
            assert!(chart.owners().is_empty() && chart.held().is_empty());
            assert_eq!((chart.across(), chart.polar()), (6, 0));
            assert_eq!(chart.given(&chart.mesh().points), mesh.points);
            assert_eq!(chart.continued(&mesh.points), chart.mesh().points);
            // Vertices that moved across the line and back are written with longitudes in the range of the file.
            for by in [-25.0, 25.0] {
                let mut moved = chart.mesh().points.clone();
                moved.iter_mut().for_each(|point| point[0] += by);
                let given = chart.given(&moved);
                for (given, chart) in given.iter().zip(&moved) {
                    assert_eq!(given[0], written(chart[0]));
                }
                assert_eq!(chart.continued(&given), moved);
            }
        }
    }

    #[test]
    fn a_mesh_around_the_globe_is_cut_and_only_vertices_at_the_cut_stay() {
        let mesh = grid([18, 3], [-170.0, -20.0], within_half);
        let chart = Chart::new(&mesh, Precision::Double).unwrap().unwrap();
        assert_sound(&chart);
        // A column of four vertices is cut, and each vertex has a copy.
        assert_eq!((chart.owners().len(), chart.held().len()), (4, 8));
        assert_eq!((chart.across(), chart.polar()), (6, 0));
        let topology = Topology::new(chart.mesh()).unwrap();
        assert_eq!(topology.free_count(), 17 * 2);
        assert_eq!(chart.given(&chart.mesh().points), mesh.points);
        assert_eq!(chart.continued(&mesh.points), chart.mesh().points);
    }

    /// Returns a mesh of triangles in pairs as a mesh of quadrilaterals, one for each pair.
    fn joined(mesh: Mesh) -> Mesh {
        let pairs = mesh.triangles.chunks_exact(2);
        let quadrilaterals = pairs.map(|pair| [pair[0][0], pair[0][1], pair[0][2], pair[1][2]]);
        Mesh { quadrilaterals: quadrilaterals.collect(), triangles: Vec::new(), ..mesh }
    }

    #[test]
    fn quadrilaterals_are_continued_as_triangles_are() {
        for (size, west, copies) in [([6, 3], 130.0, 0), ([18, 3], -170.0, 4)] {
            let mesh = joined(grid(size, [west, -20.0], within_half));
            let chart = Chart::new(&mesh, Precision::Double).unwrap().unwrap();
            assert_sound(&chart);
            assert_eq!((chart.across(), chart.owners().len()), (3, copies));
            assert_eq!(chart.given(&chart.mesh().points), mesh.points);
        }
        // Nine quadrilaterals around a pole, each with two edges of the row below.
        let mut mesh = joined(grid([18, 3], [-170.0, 50.0], within_half));
        let pole = mesh.points.len() as u32;
        mesh.points.push([0.0, 90.0]);
        let top = |k: u32| pole - 18 + k % 18;
        let around = (0..9).map(|k| [top(2 * k), top(2 * k + 1), top(2 * k + 2), pole]);
        mesh.quadrilaterals.extend(around);
        let chart = Chart::new(&mesh, Precision::Double).unwrap().unwrap();
        assert_eq!((chart.across(), chart.polar()), (4, 9));
        let topology = Topology::new(chart.mesh()).unwrap();
        assert_eq!(topology.free_count(), 17 * 2, "those around the pole stay");
        assert_eq!(chart.given(&chart.mesh().points), mesh.points);
    }

    #[test]
    fn the_triangles_at_a_pole_stay() {
        let mut mesh = grid([18, 3], [-170.0, 50.0], within_half);
        let pole = mesh.points.len() as u32;
        mesh.points.push([0.0, 90.0]);
        let top = pole - 18;
        mesh.triangles.extend((0..18).map(|k| [top + k, top + (k + 1) % 18, pole]));
        let chart = Chart::new(&mesh, Precision::Double).unwrap().unwrap();
        assert_sound(&chart);
        assert_eq!((chart.across(), chart.polar()), (7, 18));
        let topology = Topology::new(chart.mesh()).unwrap();
        assert_eq!(topology.free_count(), 17 * 2, "those around the pole stay");
        assert_eq!(chart.given(&chart.mesh().points), mesh.points);
        assert_eq!(chart.continued(&mesh.points), chart.mesh().points);
    }

    #[test]
    fn a_pole_within_a_triangle_and_a_latitude_off_the_sphere_are_refused() {
        let of = |points: [[f64; 2]; 3]| {
            let mesh =
                Mesh { points: points.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
            Chart::new(&mesh, Precision::Double).map(|chart| chart.is_some())
        };
        let pole = Err(MeshError::Pole { element: Element::Triangle(0) });
        assert_eq!(of([[-120.0, 80.0], [0.0, 80.0], [120.0, 80.0]]), pole);
        assert_eq!(of([[-90.0, 80.0], [90.0, 80.0], [100.0, 70.0]]), pole);
        assert!(matches!(
            of([[0.0, 0.0], [1.0, 91.0], [2.0, 0.0]]),
            Err(MeshError::Latitude { vertex: 1 })
        ));
        assert_eq!(of([[0.0, 80.0], [10.0, 80.0], [5.0, 85.0]]), Ok(false));
        // Other defects of a mesh are reported by other checks.
        assert_eq!(of([[0.0, f64::NAN], [10.0, 80.0], [-175.0, 85.0]]), Ok(false));
    }
}
