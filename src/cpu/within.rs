//! Newton steps of vertices whose moves and altitudes are bounded, for one vertex in each lane.

use glam::DVec2;

use crate::layout::{MeshCoordinates, Problem};
use crate::metric::{Dual, Real};
use crate::patch::lanes::{LANES, Width, numbers, points};
use crate::patch::numbers::{Mask, Numbers};
use crate::patch::{
    AT_DISC, Circle, Direction, GROWTH, LanePatch, MIN_CIRCLE_CURVATURE, Objective,
};

/// The bounds of free vertices of a problem with bounds.
#[derive(Clone, Copy)]
pub(super) struct LaneBounds<T: Numbers> {
    coordinates: MeshCoordinates,
    /// Center of the disc of each vertex in coordinates of the mesh, and its radius, infinite without discs.
    center: [T; 2],
    radius: T,
    /// Lower limit of altitudes, 0 for no limit.
    least_altitude: f64,
}

impl<T: Numbers> LaneBounds<T> {
    /// Returns the bounds of vertices. `None` if the problem has none.
    #[inline(always)]
    pub(super) fn gather<W: Width<Numbers = T>>(
        width: W,
        problem: &Problem,
        vertices: [u32; LANES],
    ) -> Option<Self> {
        if !problem.is_bounded() {
            return None;
        }
        let coordinates = problem.coordinates();
        let center = points(width, problem.positions(), vertices);
        let radius = match problem.radii() {
            Some(radii) => numbers(width, radii, vertices),
            None => width.splat(f64::INFINITY),
        };
        let center = in_mesh(coordinates, center);
        Some(Self { coordinates, center, radius, least_altitude: problem.least_altitude() })
    }

    /// Does the work of [`Within::point`] for vertices that move in a projection, lane by lane.
    fn projected_point(&self, on_line: [T; 2]) -> [T; 2] {
        let &Self { coordinates, center, radius, .. } = self;
        let mut found = on_line;
        for lane in 0..T::LANES {
            let center = DVec2::new(center[0].lane(lane), center[1].lane(lane));
            let circle = Circle { center, radius: radius.lane(lane) };
            let to = DVec2::new(on_line[0].lane(lane), on_line[1].lane(lane));
            let nearest = circle.nearest_position(coordinates, to);
            found[0].set_lane(lane, nearest.x);
            found[1].set_lane(lane, nearest.y);
        }
        found
    }
}

/// Returns points in coordinates of the mesh, given positions.
#[inline(always)]
fn in_mesh<T: Numbers>(coordinates: MeshCoordinates, positions: [T; 2]) -> [T; 2] {
    match coordinates.is_projected() {
        true => each(positions, |position| coordinates.at(position)),
        false => positions,
    }
}

/// Returns the results of a function of each lane's point.
fn each<T: Numbers>(points: [T; 2], of: impl Fn(DVec2) -> DVec2) -> [T; 2] {
    let mut found = points;
    for lane in 0..T::LANES {
        let to = of(DVec2::new(points[0].lane(lane), points[1].lane(lane)));
        found[0].set_lane(lane, to.x);
        found[1].set_lane(lane, to.y);
    }
    found
}

/// The objective of vertices at `at` that may leave neither their discs nor lower a triangle below the least altitude.
/// Without bounds, the objective is unchanged. Trials beyond a disc end at the nearest point of the disc. Steps of vertices at the circle of their disc that would lead
/// outward are Newton steps along the circle.
pub(super) struct Within<'a, T: Numbers, O, P> {
    pub(super) objective: &'a O,
    pub(super) rings: &'a P,
    pub(super) at: [T; 2],
    pub(super) bounds: Option<LaneBounds<T>>,
}

impl<T: Numbers, O, P: LanePatch<T>> Within<'_, T, O, P> {
    /// Returns which corners are acceptable in all lanes' patches; see
    /// [`keeps_altitude`](crate::patch::keeps_altitude).
    #[inline(always)]
    fn keeps_altitudes(&self, to: [T; 2], bounds: &LaneBounds<T>) -> T::Mask {
        let &LaneBounds { coordinates, least_altitude, .. } = bounds;
        let mut kept = to[0].mask(true);
        let least_altitude = to[0].constant(least_altitude * least_altitude);
        for i in 0..self.rings.count() {
            let now = self.rings.vertices(i, to).map(|point| in_mesh(coordinates, point));
            let (area, longest) = doubled_area_and_square(now);
            let squared = area * Numbers::abs(area);
            let mut is_kept = (least_altitude * longest).le(squared);
            if !is_kept.all() {
                let before = self.rings.vertices(i, self.at);
                let before = before.map(|point| in_mesh(coordinates, point));
                let (before, longest_before) = doubled_area_and_square(before);
                let grown = before * Numbers::abs(before) * (GROWTH * GROWTH);
                is_kept = is_kept | (grown * longest).le(squared * longest_before);
            }
            kept = kept & is_kept;
        }
        kept
    }
}

/// Returns twice the area of triangles, and the square of their longest edges.
#[inline(always)]
fn doubled_area_and_square<T: Numbers>([p, q, r]: [[T; 2]; 3]) -> (T, T) {
    let (a, b) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
    let c = [b[0] - a[0], b[1] - a[1]];
    let square = |[x, y]: [T; 2]| x * x + y * y;
    let longest = Real::max(Real::max(square(a), square(b)), square(c));
    (a[0] * b[1] - a[1] * b[0], longest)
}

impl<T: Numbers, O: Objective<T>, P: LanePatch<T>> Objective<T> for Within<'_, T, O, P> {
    #[inline(always)]
    fn expansion(&self, at: [T; 2]) -> Dual<T> {
        self.objective.expansion(at)
    }

    /// Returns Newton's direction. Where a vertex at the circle of its disc would go outward, returns the Newton direction
    /// along the circle, with the curvature τᵀHτ - g·n / R for the tangent τ, the outward normal n and the radius R.
    #[inline(always)]
    fn direction(&self, here: &Dual<T>, eigenvalue_floor: f64) -> Direction<T> {
        let newton = self.objective.direction(here, eigenvalue_floor);
        let Some(LaneBounds { coordinates, center, radius, .. }) = self.bounds else {
            return newton;
        };
        let zero = radius.constant(0.0);
        let from = in_mesh(coordinates, self.at);
        let (x, y) = (from[0] - center[0], from[1] - center[1]);
        let distance = Real::sqrt(x * x + y * y);
        // Derivative of the mesh's second coordinate by the second coordinate of the positions.
        let mut slope = radius.constant(1.0);
        if coordinates.is_projected() {
            let slopes = each(self.at, |at| DVec2::splat(coordinates.slopes(at)[0]));
            slope = slopes[0];
        }
        let normal = [x / distance, y / distance];
        let out = newton.vector[0] * normal[0] + newton.vector[1] * slope * normal[1];
        let turns = (radius * AT_DISC).le(distance) & zero.lt(out);
        let moves = zero.lt(radius);
        if turns.none() {
            return Direction { descends: newton.descends & moves, ..newton };
        }
        let [gx, gy] = [here.gradient[0], here.gradient[1] / slope];
        let [xx, xy, yy] = here.hessian;
        let (xy, yy) = (xy / slope, yy / (slope * slope));
        let tangent = [zero - normal[1], normal[0]];
        let along = gx * tangent[0] + gy * tangent[1];
        let outward = gx * normal[0] + gy * normal[1];
        let curvature = xx * tangent[0] * tangent[0]
            + xy * tangent[0] * tangent[1] * 2.0
            + yy * tangent[1] * tangent[1]
            - outward / radius;
        let (mean, half) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
        let most = Numbers::abs(mean) + Real::sqrt(half * half + xy * xy);
        let stiffness = Real::max(Numbers::abs(curvature), most * MIN_CIRCLE_CURVATURE);
        // A longer step along the tangent ends at nearly the same point of the circle.
        let length = Real::max(Real::min((zero - along) / stiffness, radius), zero - radius);
        let vector = [tangent[0] * length, tangent[1] * length / slope];
        let decrease = along * length;
        let select = |turned, straight| T::select(turns, turned, straight);
        let descends = (turns & decrease.lt(zero)) | (!turns & newton.descends & moves);
        Direction {
            vector: [select(vector[0], newton.vector[0]), select(vector[1], newton.vector[1])],
            slope: select(decrease, newton.slope),
            descends,
        }
    }

    /// Returns the given point, or the nearest point of the disc if the given point is outside.
    #[inline(always)]
    fn point(&self, on_line: [T; 2]) -> [T; 2] {
        let Some(bounds) = self.bounds else { return on_line };
        let LaneBounds { coordinates, center, radius, .. } = bounds;
        if coordinates.is_projected() {
            return bounds.projected_point(on_line);
        }
        let (x, y) = (on_line[0] - center[0], on_line[1] - center[1]);
        let distance = Real::sqrt(x * x + y * y);
        let (is_inside, share) = (distance.le(radius), radius / distance);
        [
            T::select(is_inside, on_line[0], center[0] + x * share),
            T::select(is_inside, on_line[1], center[1] + y * share),
        ]
    }

    #[inline(always)]
    fn predicted(&self, here: &Dual<T>, to: [T; 2]) -> Option<T> {
        self.bounds?;
        let (x, y) = (to[0] - self.at[0], to[1] - self.at[1]);
        Some(here.gradient[0] * x + here.gradient[1] * y)
    }

    #[inline(always)]
    fn trial(&self, to: [T; 2], max_imr: T) -> (T, T::Mask) {
        let (value, feasible) = self.objective.trial(to, max_imr);
        match &self.bounds {
            Some(bounds) if bounds.least_altitude > 0.0 => {
                (value, feasible & self.keeps_altitudes(to, bounds))
            }
            _ => (value, feasible),
        }
    }

    #[inline(always)]
    fn squares(&self, value: T) -> T {
        self.objective.squares(value)
    }

    #[inline(always)]
    fn shape_guard(&self) -> f64 {
        self.objective.shape_guard()
    }

    #[inline(always)]
    fn worst_shape(&self, at: [T; 2]) -> T {
        self.objective.worst_shape(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{mean_excess, sweep};
    use crate::layout::{Bounds, prepare};
    use crate::mesh::Mesh;
    use crate::metric::Metric;
    use crate::options::Options;
    use crate::parallel::pace::now;
    use crate::run::Plan;

    /// Returns a hexagon with a free vertex at `at`, bounded by a disc of this radius (normalized).
    fn hexagon(at: [f64; 2], radius: f64) -> Problem {
        let corner = |k: u32| (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
        let mut points: Vec<[f64; 2]> = (0..6).map(corner).map(|(y, x)| [x, y]).collect();
        points.push(at);
        let triangles = (0..6).map(|k| [k, (k + 1) % 6, 6]).collect();
        let (_, mut problem) = prepare(&Mesh { points, triangles, ..Mesh::default() }).unwrap();
        problem.set_bounds(Bounds { radii: Some(vec![radius]), least_altitude: 0.0 });
        problem
    }

    fn f(problem: &Problem, metric: Metric, at: DVec2) -> f64 {
        let mut positions = problem.positions().to_vec();
        positions[0] = at;
        now(mean_excess(metric, problem, &positions))
    }

    /// Returns the position of the free vertex after ten sweeps.
    fn swept(problem: &Problem, metric: Metric) -> DVec2 {
        let plan = Plan::new(&Options { scheme: metric.into(), ..Options::default() });
        let (step, mut moved) = (plan.base_step(1.0), Vec::new());
        let mut positions = problem.positions().to_vec();
        for _ in 0..10 {
            now(sweep::sweep(problem, &mut positions, &mut moved, &step));
        }
        positions[0]
    }

    #[test]
    fn visits_find_the_least_f_within_a_disc() {
        for (at, radius) in [([0.6, 0.1], 0.2), ([0.6, 0.1], 0.55), ([-0.3, 0.5], 0.01)] {
            let problem = hexagon(at, radius);
            let center = problem.positions()[0];
            for metric in [Metric::Imr, Metric::Rms, Metric::Area, Metric::ShapeSize] {
                let found = swept(&problem, metric);
                assert!(found.distance(center) <= radius * (1.0 + 1e-12), "{metric}: {found}");
                let on_circle = (0..3600).map(|k| {
                    let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 1800.0).sin_cos();
                    f(&problem, metric, center + DVec2::new(cos, sin) * radius)
                });
                let least = on_circle.filter(|f| f.is_finite()).fold(f64::INFINITY, f64::min);
                let end = f(&problem, metric, found);
                assert!(end <= least + 1e-9, "{metric}, radius {radius}: {end} above {least}");
            }
        }
    }

    #[test]
    fn a_disc_of_radius_zero_holds_its_vertex() {
        let problem = hexagon([0.6, 0.1], 0.0);
        assert_eq!(swept(&problem, Metric::Imr), problem.positions()[0]);
    }
}
