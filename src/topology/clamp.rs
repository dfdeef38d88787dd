//! Moves vertices toward new positions, as far as no element inverts or exceeds a bound on its inverse mean ratio.

use crate::error::MeshError;
use crate::metric::{Corner, Ideal};
use crate::topology::Topology;
use crate::topology::predicates;

/// Relative tolerance for the rounding of an inverse mean ratio.
const ROUNDING: f64 = 1e-9;

impl Topology<'_> {
    /// Moves vertices straight toward new positions, all by the same share of their displacement, as far as the
    /// triangles allow. Returns the share, from 0 to 1; 1 means that the new positions were reached. Applications call
    /// this function in each frame while a user drags handles or a boundary, with sweeps in between that improve the
    /// mesh.
    ///
    /// `moves` are pairs of a vertex and its new position, in the unit of `points`. Fixed and boundary vertices can be
    /// moved like all others. If a vertex is listed twice, its last position counts.
    ///
    /// No triangle inverts or becomes flat, and no quadrilateral loses its convexity, neither during the move nor, by exact predicates on the values in `points`,
    /// at its end. No triangle gets an inverse mean ratio above `worst_imr`; a triangle whose ratio already exceeds
    /// `worst_imr` does not get worse. If `worst_imr` is [`f64::INFINITY`], triangles may become nearly flat; a bound
    /// of about 8 leaves room for sweeps, and for rounding `points` to single precision. Triangles that are inverted or
    /// flat before the move do not limit the share.
    ///
    /// ```
    /// # use gpu_smooth::{Mesh, Topology};
    /// # let mesh = Mesh {
    /// #     points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]],
    /// #     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    /// #     fixed: vec![],
    /// #     ..Mesh::default()
    /// # };
    /// // The middle vertex of a unit square, dragged out of it.
    /// let topology = Topology::new(&mesh)?;
    /// let mut points = mesh.points.clone();
    /// let share = topology.move_clamped(&mut points, &[(4, [2.5, 0.5])], f64::INFINITY)?;
    /// assert!(share < 0.25 && share > 0.2499 && points[4][0] < 1.0);
    /// # Ok::<(), gpu_smooth::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// No vertex is moved on an error: [`MeshError::PointCount`] if `points` does not have one entry per vertex,
    /// [`MeshError::IndexOutOfRange`] if `moves` lists a vertex that the mesh does not have,
    /// [`MeshError::BoundNotANumber`] if `worst_imr` is NaN, [`MeshError::NotFinite`] if a vertex of an affected
    /// triangle has, or would get, a coordinate that is infinite or NaN, [`MeshError::OutOfRange`] if such a vertex has a
    /// coordinate above 1e100.
    pub fn move_clamped(
        &self,
        points: &mut [[f64; 2]],
        moves: &[(u32, [f64; 2])],
        worst_imr: f64,
    ) -> Result<f64, MeshError> {
        self.check_count(points)?;
        if worst_imr.is_nan() {
            return Err(MeshError::BoundNotANumber);
        }
        let vertices = points.len();
        if let Some(&(vertex, _)) = moves.iter().find(|&&(v, _)| v as usize >= vertices) {
            return Err(MeshError::IndexOutOfRange { element: None, vertex, vertices });
        }
        let is_finite = |[x, y]: [f64; 2]| x.is_finite() && y.is_finite();
        if let Some(&(vertex, _)) = moves.iter().find(|&&(_, to)| !is_finite(to)) {
            return Err(MeshError::NotFinite { vertex });
        }

        let ways = Paths::new(points, moves);
        let mut indices: Vec<u32> =
            ways.0.iter().flat_map(|way| self.corners_with(way.vertex)).collect();
        indices.sort_unstable();
        indices.dedup();
        let corners = || indices.iter().map(|&c| self.corners()[c as usize]);
        // The vertices of the affected corners, and moved vertices that no element uses.
        let touched = ways.0.iter().map(|way| way.vertex).chain(corners().flatten());
        if let Some(vertex) = touched.clone().find(|&v| !is_finite(points[v as usize])) {
            return Err(MeshError::NotFinite { vertex });
        }
        let coordinates = touched.flat_map(|v| points[v as usize]);
        let size = coordinates.fold(0.0, |size: f64, x| size.max(x.abs()));
        if size > 1e100 {
            return Err(MeshError::OutOfRange { size });
        }
        let limited: Vec<Limited> = indices
            .iter()
            .map(|&c| (self.corners()[c as usize], !self.corner_list().is_triangle(c)))
            .filter(|(vertices, _)| predicates::is_positive(points, vertices))
            .map(|(vertices, is_right)| {
                let now = imr(points, &vertices, is_right) * (1.0 + ROUNDING);
                Limited { vertices, is_right, limit: worst_imr.max(now) }
            })
            .collect();

        let gives_way = |corner: &Limited| ways.gives_way(points, corner);
        let mut share = limited.iter().map(gives_way).fold(1.0, f64::min);
        // The share and the points are rounded, so a triangle may still exceed its limit. The share is lowered until no
        // triangle does.
        let mut less = f64::EPSILON;
        loop {
            ways.go(points, share);
            let holds = |Limited { vertices, is_right, limit }: &Limited| {
                predicates::is_positive(points, vertices)
                    && imr(points, vertices, *is_right) <= limit * (1.0 + ROUNDING)
            };
            if share == 0.0 || limited.iter().all(holds) {
                return Ok(share);
            }
            share = if less < 1.0 { share * (1.0 - less) } else { 0.0 };
            less *= 8.0;
        }
    }
}

/// A corner that limits a move.
struct Limited {
    vertices: [u32; 3],
    /// Whether the corner is of a quadrilateral.
    is_right: bool,
    /// Largest inverse mean ratio after the move.
    limit: f64,
}

/// The straight path of a vertex, from its position to its new position.
struct Path {
    vertex: u32,
    from: [f64; 2],
    to: [f64; 2],
}

/// Paths of all moved vertices, one per vertex, in ascending order of vertices.
struct Paths(Vec<Path>);

impl Paths {
    fn new(points: &[[f64; 2]], moves: &[(u32, [f64; 2])]) -> Self {
        let way = |&(vertex, to): &(u32, [f64; 2])| {
            let from = points[vertex as usize];
            Path { vertex, from, to }
        };
        let mut ways: Vec<Path> = moves.iter().rev().map(way).collect();
        ways.sort_by_key(|way| way.vertex);
        ways.dedup_by_key(|way| way.vertex);
        Self(ways)
    }

    /// Sets each vertex to the point at `share` of its path. At share 1 the vertex gets the bits of its new position.
    fn go(&self, points: &mut [[f64; 2]], share: f64) {
        for &Path { vertex, from, to } in &self.0 {
            let between = |i: usize| from[i] + share * (to[i] - from[i]);
            points[vertex as usize] = if share == 1.0 { to } else { [between(0), between(1)] };
        }
    }

    /// Returns the displacement of a vertex over its whole path, zero for a vertex that does not move.
    fn of(&self, vertex: u32) -> [f64; 2] {
        match self.0.binary_search_by_key(&vertex, |way| way.vertex) {
            Ok(i) => minus(self.0[i].to, self.0[i].from),
            Err(_) => [0.0; 2],
        }
    }

    /// Returns the share of the paths at which the inverse mean ratio of a corner reaches its limit, infinite if never.
    /// The ratio of a triangle is L / (2√3 D), with L the sum of the squared edge lengths and D the doubled area, and that
    /// of a corner of a quadrilateral L / (2 D), with L the sum over its two sides. So the share is the least positive
    /// root of the quadratic D - L / (2√3 limit), or D - L / (2 limit).
    fn gives_way(&self, points: &[[f64; 2]], corner: &Limited) -> f64 {
        let &Limited { vertices, is_right, limit } = corner;
        let [p, q, r] = vertices.map(|v| points[v as usize]);
        let [dp, dq, dr] = vertices.map(|v| self.of(v));
        let edges = [minus(q, p), minus(r, p), minus(dq, dp), minus(dr, dp)];
        // Edges are divided by the largest difference of coordinates, so that no product overflows.
        let unit = edges.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let [e, f, de, df] = edges.map(|edge| edge.map(|x| x / unit));
        let [c, dc] = [minus(f, e), minus(df, de)];
        let (edges, factor) = if is_right { (2, 2.0) } else { (3, 2.0 * 3f64.sqrt()) };
        let weight = 1.0 / (factor * limit);
        let lengths = |u: [[f64; 2]; 3], v: [[f64; 2]; 3]| {
            (0..edges).map(|i| u[i][0] * v[i][0] + u[i][1] * v[i][1]).sum::<f64>() * weight
        };
        let (still, moving) = ([e, f, c], [de, df, dc]);
        least_root(
            cross(e, f) - lengths(still, still),
            cross(e, df) + cross(de, f) - 2.0 * lengths(still, moving),
            cross(de, df) - lengths(moving, moving),
        )
    }
}

/// Returns the least positive root t of constant + slope t + bend t² = 0, infinite if there is none.
fn least_root(constant: f64, slope: f64, bend: f64) -> f64 {
    let discriminant = slope * slope - 4.0 * bend * constant;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    // The smaller root is found from the product of the roots, as the quadratic formula would cancel for one of them.
    let half = -0.5 * (slope + discriminant.sqrt().copysign(slope));
    let roots = [half / bend, constant / half].into_iter();
    roots.filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min)
}

fn minus(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    [p[0] - q[0], p[1] - q[1]]
}

fn cross(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

/// Returns the inverse mean ratio of a corner that is neither inverted nor flat.
fn imr(points: &[[f64; 2]], corners: &[u32; 3], is_right: bool) -> f64 {
    let [p, q, r] = corners.map(|v| points[v as usize]);
    let corner = Corner { a: minus(q, p), b: minus(r, p), ideal: Ideal::of_area(1.0) };
    if is_right {
        corner.of_right_angle().inverse_mean_ratio()
    } else {
        corner.inverse_mean_ratio()
    }
}
