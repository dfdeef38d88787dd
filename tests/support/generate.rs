//! Generators of meshes: lattices, graded rings, hubs, layers, and triangulations of an outline.

use super::Mesh;
use super::check::{area, boundary, is_ccw, is_valid, min_angle};
use super::outline::Outline;
use super::trig::{on_circle, sin_turns};
use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation,
};

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Smallest angle after refinement, in degrees, except at sharper corners of the outline.
pub const ANGLE_LIMIT: f64 = 29.0;

/// Makes a lattice of `columns` times `rows` pairs of equilateral triangles with unit edges. The left and right sides
/// zigzag, so that the lattice is upright. All triangles are ideal up to rounding.
pub fn lattice(columns: usize, rows: usize) -> Mesh {
    let height = 3f64.sqrt() / 2.0;
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
        mesh.points.extend((0..=columns).map(|i| [i as f64 + shift, row as f64 * height]));
    }
    for row in 0..rows {
        for i in 0..columns {
            let a = (row * (columns + 1) + i) as u32;
            let (b, c) = (a + 1, a + columns as u32 + 1);
            let d = c + 1;
            mesh.triangles.extend(if row % 2 == 0 {
                [[a, b, c], [b, d, c]]
            } else {
                [[a, b, d], [a, d, c]]
            });
        }
    }
    mesh
}

/// Makes rings of `around` vertices between the unit circle and a hole of radius `ratio` around the origin. Elements
/// shrink with the radius and stay nearly equilateral.
pub fn graded(around: usize, ratio: f64) -> Mesh {
    assert!(around >= 8 && ratio > 0.0, "a ring needs 8 vertices and a hole");
    let turns = 1.0 / around as f64;
    // Halfway between two factors: one makes triangles with an edge on the inner ring equilateral, the other those with
    // an edge on the outer ring.
    let [cos, sin] = on_circle(turns / 2.0);
    let height = 3f64.sqrt() * sin;
    let shrink = ((cos - height) / (cos + height)).sqrt();
    let mut mesh = Mesh::default();
    let (mut radius, mut ring) = (1.0, 0);
    loop {
        let shift = if ring % 2 == 0 { 0.0 } else { 0.5 };
        for i in 0..around {
            let [cos, sin] = on_circle((i as f64 + shift) * turns);
            mesh.points.push([radius * cos, radius * sin]);
        }
        if radius <= ratio {
            return mesh;
        }
        for i in 0..around {
            let index = |ring: usize, i: usize| (ring * around + i % around) as u32;
            let (a, b) = (index(ring, i), index(ring, i + 1));
            let (c, d) = (index(ring + 1, i), index(ring + 1, i + 1));
            mesh.triangles.extend(if ring % 2 == 0 {
                [[a, b, c], [b, d, c]]
            } else {
                [[a, b, d], [a, d, c]]
            });
        }
        radius *= shrink;
        ring += 1;
    }
}

/// Makes a vertex with `around` neighbors, in the center of rings of `around` vertices each. The outermost ring is `1 /
/// ratio` times as large as the innermost. Outside of the innermost ring, triangles are nearly equilateral.
pub fn hub(around: usize, ratio: f64) -> Mesh {
    let mut mesh = graded(around, ratio);
    let center = mesh.points.len() as u32;
    let ring = center - around as u32;
    mesh.points.push([0.0, 0.0]);
    let turn = |i: u32| [ring + i, ring + (i + 1) % around as u32, center];
    mesh.triangles.extend((0..around as u32).map(turn));
    mesh
}

/// Makes a vertex with `around` neighbors, in the center of `rings` equidistant rings of `around` vertices each.
/// Triangles closer to the center are more stretched.
pub fn hub_evenly(around: usize, rings: usize) -> Mesh {
    // A ratio for which `hub` makes at least `rings` rings.
    let mut mesh = hub(around, (-6.0 * rings as f64 / around as f64).exp());
    let all = (mesh.points.len() - 1) / around;
    assert!(all >= rings, "{all} rings instead of {rings}");
    let last = (rings * around) as u32;
    // Replaces the triangles inside the innermost kept ring by a fan.
    mesh.triangles.retain(|t| t.iter().all(|&v| v < last));
    mesh.points.truncate(last as usize);
    for (i, point) in mesh.points.iter_mut().enumerate() {
        let radius = 1.0 - (i / around) as f64 / rings as f64;
        let now = point[0].hypot(point[1]);
        *point = point.map(|x| x * radius / now);
    }
    mesh.points.push([0.0, 0.0]);
    let ring = last - around as u32;
    let turn = |i: u32| [ring + i, ring + (i + 1) % around as u32, last];
    mesh.triangles.extend((0..around as u32).map(turn));
    mesh
}

/// Makes the mesh of [`layered`] with wavy rows: one wave over the width, with a height of `height` edges.
pub fn wavy_layer(columns: usize, ratio: f64, height: f64) -> Mesh {
    let mut mesh = layered(columns, ratio);
    for point in &mut mesh.points {
        point[1] += height * sin_turns(point[0] / columns as f64);
    }
    mesh
}

/// Makes a square lattice whose rows are compressed toward the middle, where triangles are stretched by approximately
/// `ratio`.
pub fn layered(columns: usize, ratio: f64) -> Mesh {
    let rows = columns / 2 * 2;
    let mut mesh = lattice(columns, rows);
    let height = mesh.points.iter().map(|p| p[1]).fold(0.0, f64::max);
    let bend = ratio.asinh();
    for point in &mut mesh.points {
        let along = 2.0 * point[1] / height - 1.0;
        point[1] = 0.5 * height * (bend * along).sinh() / ratio;
    }
    mesh
}

/// Triangulates the inside of an outline. Angles are at least [`ANGLE_LIMIT`], except at sharper corners of the
/// outline. The triangle size is chosen so that the number of vertices is within 1 % of `vertices`. Vertices begin with
/// the corners of the outline, in order. The result depends only on the version of spade, not on the machine.
pub fn triangulate(outline: &Outline, vertices: usize) -> Result<Mesh, String> {
    let mesh = triangulate_within(outline, vertices, false)?;
    if min_angle(&mesh) > ANGLE_LIMIT - 1e-6 {
        return Ok(mesh);
    }
    // spade does not split edges at a sharp angle with the convex hull, and leaves bad triangles there.
    let boxed = triangulate_within(outline, vertices, true)?;
    Ok(if min_angle(&boxed) > min_angle(&mesh) { boxed } else { mesh })
}

/// Triangulates an outline with approximately `vertices` vertices. With `boxed`, a surrounding box keeps the convex
/// hull away from the outline.
fn triangulate_within(outline: &Outline, vertices: usize, boxed: bool) -> Result<Mesh, String> {
    let (domain, target) = (outline.area(), vertices as f64);
    // The search starts at the size of a typical mesh, then bisects between sizes with too many and too few vertices.
    let (mut size, mut low, mut high) = (domain / (1.2 * target), 0.0, f64::INFINITY);
    let mut closest: Option<(f64, Mesh)> = None;
    for _ in 0..24 {
        let refined = refine(outline, size, 2 * vertices + 10_000, boxed)?;
        let count = refined.as_ref().map_or(2.0 * target, |mesh| mesh.points.len() as f64);
        let off = (count / target - 1.0).abs();
        if let Some(mesh) = refined
            && closest.as_ref().is_none_or(|(best, _)| off < *best)
        {
            closest = Some((off, mesh));
        }
        if off < 0.005 || size > domain {
            break;
        }
        if count > target {
            low = size
        } else {
            high = size
        }
        size *= count / target;
        if size <= low || size >= high {
            size = if high.is_finite() { (low + high) / 2.0 } else { 2.0 * low };
        }
    }
    match closest {
        Some((off, mesh)) if off < 0.01 => Ok(mesh),
        Some((_, mesh)) => Err(format!(
            "no size of triangles makes {vertices} vertices; the closest makes {}",
            mesh.points.len()
        )),
        None => Err(format!("the outline alone takes more than {vertices} vertices")),
    }
}

/// Refines the outline to triangles with areas of at most `size`; `None` if more than `limit` vertices are necessary.
fn refine(outline: &Outline, size: f64, limit: usize, boxed: bool) -> Result<Option<Mesh>, String> {
    let mut cdt = Cdt::new();
    let closed = outline.loops.iter().map(|ring| (ring, true));
    for (points, closed) in closed.chain(outline.lines.iter().map(|line| (line, false))) {
        let handles = points.iter().map(|&p| insert(&mut cdt, p)).collect::<Result<Vec<_>, _>>()?;
        let back = closed.then(|| [handles[handles.len() - 1], handles[0]]);
        for [from, to] in handles.windows(2).map(|pair| [pair[0], pair[1]]).chain(back) {
            if from == to || !cdt.can_add_constraint(from, to) {
                let p = cdt.vertex(from).position();
                return Err(format!("the outline crosses or repeats itself near {} {}", p.x, p.y));
            }
            cdt.add_constraint(from, to);
        }
    }
    let lone =
        outline.vertices.iter().map(|&p| insert(&mut cdt, p)).collect::<Result<Vec<_>, _>>()?;
    // spade regards each constraint edge as a border between inside and outside. For outlines with inner lines, spade
    // must therefore refine everything; a surrounding box then prevents sharp angles with the convex hull.
    let borders_only = outline.lines.is_empty();
    if !borders_only || boxed {
        for p in surrounding_box(outline) {
            insert(&mut cdt, p)?;
        }
    }
    let result = cdt.refine(
        RefinementParameters::<f64>::new()
            .with_angle_limit(AngleLimit::from_deg(ANGLE_LIMIT))
            .with_max_allowed_area(size)
            .with_max_additional_vertices(if borders_only { limit } else { 16 * limit })
            .exclude_outer_faces(borders_only),
    );
    if !result.refinement_complete {
        return Ok(None);
    }
    let mut outside = vec![!borders_only; cdt.num_all_faces()];
    result.excluded_faces.iter().for_each(|face| outside[face.index()] = true);
    let kept = cdt.inner_faces().filter(|face| {
        let center = face.center();
        if borders_only { !outside[face.index()] } else { outline.contains([center.x, center.y]) }
    });
    let triangles: Vec<_> =
        kept.map(|face| face.vertices().map(|v| v.fix().index() as u32)).collect();
    let points = cdt.vertices().map(|v| [v.position().x, v.position().y]).collect();
    let on_lines = cdt
        .undirected_edges()
        .filter(|edge| edge.is_constraint_edge())
        .flat_map(|edge| edge.vertices().map(|v| v.fix()));
    let fixed = lone.into_iter().chain(on_lines).map(|v| v.index() as u32).collect();
    let mesh = compacted(Mesh { points, triangles, fixed, ..Mesh::default() });
    // The triangles fill the area enclosed by the loops, so no loop was lost.
    let fills = (area(&mesh) / outline.area() - 1.0).abs() < 1e-9;
    if is_ccw(&mesh) && is_valid(&mesh) && fills {
        Ok(Some(mesh))
    } else {
        Err("the outline could not be triangulated; do its loops cross?".into())
    }
}

fn insert(cdt: &mut Cdt, [x, y]: [f64; 2]) -> Result<spade::handles::FixedVertexHandle, String> {
    cdt.insert(Point2::new(x, y)).map_err(|e| format!("the point {x} {y} cannot be used: {e}"))
}

fn surrounding_box(outline: &Outline) -> [[f64; 2]; 4] {
    let all = || outline.loops.iter().flatten();
    let [[left, right], [bottom, top]] = [0, 1].map(|x| {
        let low = all().map(|p| p[x]).fold(f64::INFINITY, f64::min);
        let high = all().map(|p| p[x]).fold(f64::NEG_INFINITY, f64::max);
        let margin = (high - low) / 8.0;
        [low - margin, high + margin]
    });
    [[left, bottom], [right, bottom], [right, top], [left, top]]
}

/// Returns the mesh without unused vertices, and without boundary vertices in `fixed`.
fn compacted(mesh: Mesh) -> Mesh {
    const UNUSED: u32 = u32::MAX;
    let mut new_index = vec![UNUSED; mesh.points.len()];
    mesh.triangles.iter().flatten().for_each(|&v| new_index[v as usize] = 0);
    let mut points = Vec::new();
    for (index, point) in new_index.iter_mut().zip(&mesh.points).filter(|(i, _)| **i != UNUSED) {
        *index = points.len() as u32;
        points.push(*point);
    }
    let renamed = |v: &u32| new_index[*v as usize];
    let triangles = mesh.triangles.iter().map(|t| t.each_ref().map(renamed)).collect();
    let fixed = mesh.fixed.iter().map(renamed).filter(|&v| v != UNUSED).collect();
    let mut mesh = Mesh { points, triangles, fixed, ..Mesh::default() };
    let on_boundary = boundary(&mesh);
    mesh.fixed.retain(|&v| !on_boundary[v as usize]);
    mesh.fixed.sort_unstable();
    mesh.fixed.dedup();
    mesh
}
