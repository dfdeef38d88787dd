//! Meshes on the sphere, whose vertices move in the Mercator projection. Bounds, curves and fields of targets are in
//! longitude and latitude.

use crate::{backends, name, run, with_points};
use gpu_smooth::{
    Backend, Mesh, Options, Slide, Smoother, Stop, Stopping, TargetField, Targets,
    gpu::Sweeps,
    measure::Change,
    options::{Precision, WorstBy},
    targets::Surface,
};
use support::{SplitMix64, check};

/// Returns a lattice of 10 by 10 squares, uniform in degrees, from 60 to 85 degrees north. Coordinates of vertices inside
/// are perturbed by up to `noise` edges.
fn lattice(noise: f64) -> Mesh {
    let mut random = SplitMix64::new(4);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..=10_u32 {
        for column in 0..=10_u32 {
            let is_inside = row % 10 != 0 && column % 10 != 0;
            let mut off = || if is_inside { noise * random.range(-1.0, 1.0) } else { 0.0 };
            points.push([2.5 * (f64::from(column) + off()), 60.0 + 2.5 * (f64::from(row) + off())]);
            if row < 10 && column < 10 {
                let at = |c: u32, r: u32| (row + r) * 11 + column + c;
                triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
                triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
    }
    Mesh { points, triangles, ..Mesh::default() }
}

/// Returns a lattice with a sliver that is inverted in the projection: a vertex inside is near the middle of the
/// opposite edge of one of its triangles, whose image is curved. The vertex is 0.05 degrees from the edge, on the side that
/// inverts the sliver.
fn with_a_sliver(noise: f64) -> Mesh {
    let mut mesh = lattice(noise);
    // The triangle has corners at two columns of one row, and above or below.
    let vertex = 8 * 11 + 5;
    let opposite = |t: &[u32; 3]| {
        let at = t.iter().position(|&v| v == vertex)?;
        Some([t[(at + 1) % 3], t[(at + 2) % 3]])
    };
    let edges: Vec<[u32; 2]> = mesh.triangles.iter().filter_map(opposite).collect();
    for edge in edges {
        let [a, b] = edge.map(|v| mesh.points[v as usize]);
        let way = [b[0] - a[0], b[1] - a[1]];
        let left = [-way[1], way[0]].map(|x| 0.05 * x / way[0].hypot(way[1]));
        mesh.points[vertex as usize] = [0, 1].map(|k| 0.5 * (a[k] + b[k]) + left[k]);
        let images: Vec<_> = mesh.points.iter().map(|&point| image(point)).collect();
        if check::is_valid(&mesh) && !check::is_valid(&with_points(&mesh, &images)) {
            return mesh;
        }
    }
    panic!("no sliver is inverted by the projection");
}

fn on_sphere(mesh: &Mesh) -> Smoother<'_> {
    let mut smoother = Smoother::new(mesh).unwrap();
    assert!(smoother.project_from_sphere().unwrap());
    smoother
}

/// Returns the Mercator projection of a point, without use of the library's projection.
fn image([x, y]: [f64; 2]) -> [f64; 2] {
    let half = 0.5 * y.to_radians() + 0.25 * std::f64::consts::PI;
    [x, half.tan().ln().to_degrees()]
}

/// Returns f by the inverse mean ratio of the projected triangles.
fn f(mesh: &Mesh, points: &[[f64; 2]]) -> f64 {
    mean_square(mesh, |t| t.map(|v| image(points[v as usize])))
}

/// Returns f by the inverse mean ratio of the triangles as seen from their centers.
fn f_at_centers(mesh: &Mesh, points: &[[f64; 2]]) -> f64 {
    mean_square(mesh, |t| {
        let corners = t.map(|v| points[v as usize]);
        let latitude = corners.iter().map(|corner| corner[1]).sum::<f64>() / 3.0;
        corners.map(|[x, y]| [x * latitude.to_radians().cos(), y])
    })
}

/// Returns the mean squared inverse mean ratio of triangles with the given corners.
fn mean_square(mesh: &Mesh, corners: impl Fn([u32; 3]) -> [[f64; 2]; 3]) -> f64 {
    let square = |&t: &[u32; 3]| {
        let [p, q, r] = corners(t);
        let [a, b] = [q, r].map(|end| [end[0] - p[0], end[1] - p[1]]);
        let sum = a[0] * a[0] + a[1] * a[1] + b[0] * b[0] + b[1] * b[1] - a[0] * b[0] - a[1] * b[1];
        (sum / (a[0] * b[1] - a[1] * b[0])).powi(2) / 3.0
    };
    mesh.triangles.iter().map(square).sum::<f64>() / mesh.triangles.len() as f64
}

/// Returns the gain on f, as a share, of moving each free vertex alone by up to 0.003 degrees, if `allows` the position.
fn left(mesh: &Mesh, points: &[[f64; 2]], mut allows: impl FnMut(&[[f64; 2]]) -> bool) -> f64 {
    let held = check::held(mesh);
    let end = f(mesh, points);
    let mut gained = 0.0;
    for v in (0..points.len()).filter(|&v| !held[v]) {
        let mut moved = points.to_vec();
        let mut best = end;
        for k in 0..16 {
            let [cos, sin] = support::trig::on_circle(f64::from(k) / 16.0);
            moved[v] = [points[v][0] + 3e-3 * cos, points[v][1] + 3e-3 * sin];
            if allows(&moved) {
                best = best.min(f(mesh, &moved));
            }
        }
        gained += end - best;
    }
    gained / end
}

/// A former defect: runs with a bound had latitudes scaled by constants, and ended 6.7 % above the optimum.
#[test]
fn a_wide_bound_leaves_the_optimum_of_the_projection() {
    let mesh = lattice(0.2);
    let smoother = on_sphere(&mesh);
    let free = Options::default().stopping(Stopping::Tolerance(1e-8));
    let bounded = free.clone().max_move(Some(50.0));
    for backend in backends() {
        let [free, bounded] = [&free, &bounded].map(|options| run(&smoother, options, backend));
        assert_eq!(bounded.stop, Stop::Converged, "{}", name(backend));
        let [free, bounded] = [free, bounded].map(|outcome| f(&mesh, &outcome.points));
        assert!((bounded / free - 1.0).abs() < 1e-5, "{}: {bounded} {free}", name(backend));
    }
}

/// A former defect: runs on meshes with slivers that the projection inverts had latitudes scaled by constants, and ended
/// up to 6 % above the optimum.
#[test]
fn a_mesh_with_a_sliver_reaches_the_optimum_of_the_projection() {
    let (plain, mesh) = (lattice(0.2), with_a_sliver(0.2));
    let options = Options::default().stopping(Stopping::Tolerance(1e-8));
    let best = run(&on_sphere(&plain), &options, &backends()[0]);
    let best = f(&plain, &best.points);
    let mut smoother = on_sphere(&mesh);
    for backend in backends() {
        let outcome = run(&smoother, &options, backend);
        assert_eq!(outcome.stop, Stop::Converged, "{}", name(backend));
        assert!(check::is_valid(&with_points(&mesh, &outcome.points)));
        let end = f(&mesh, &outcome.points);
        assert!((end / best - 1.0).abs() < 1e-5, "{}: {end} {best}", name(backend));
        let own = smoother.f(options.scheme.base(), &outcome.points).unwrap();
        assert!((own / end - 1.0).abs() < 1e-6, "{own} {end}");
    }
    // Equal targets lead to the same optimum, although the latitudes of vertices near the sliver have changed.
    let targets = Targets::equilateral(mesh.points.len());
    let targets = targets.seen_on(Surface::Sphere, &mesh.points, &mesh.triangles).unwrap();
    smoother.set_targets(&targets).unwrap();
    let outcome = run(&smoother, &options, &backends()[0]);
    assert!((f(&mesh, &outcome.points) / best - 1.0).abs() < 1e-5, "{outcome:?}");
    // A bound is measured from the given positions, also those of the vertices near the sliver.
    let bounded = options.max_move(Some(0.05));
    let outcome = run(&smoother, &bounded, &backends()[0]);
    let change = Change::between(smoother.topology(), &mesh.points, &outcome.points).unwrap();
    assert!(change.moved.most <= 0.05 && change.moved.most > 0.0499, "{change:?}");
}

/// A former defect: sweeps on a device moved the vertices of such a mesh in longitude and latitude.
#[test]
fn frames_of_a_mesh_with_a_sliver_reach_the_optimum_of_the_projection() {
    let mesh = with_a_sliver(0.2);
    let smoother = on_sphere(&mesh);
    let options = Options::default().stopping(Stopping::Tolerance(1e-8));
    let [Backend::Cpu, Backend::Gpu(gpu)] = backends() else { panic!("a device is missing") };
    let best = f(&mesh, &run(&smoother, &options, &Backend::Cpu).points);
    let device_mesh = smoother.to_device(gpu).unwrap();
    let mut sweeps = Sweeps::new(&device_mesh, &options).block().unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    sweeps.encode_sweeps(&mut encoder, 60);
    gpu.queue().submit([encoder.finish()]);
    let mut points = device_mesh.read_points().block().unwrap();
    assert_eq!(smoother.certify(&mut points).unwrap(), 0);
    let end = f(&mesh, &points);
    assert!((end / best - 1.0).abs() < 1e-5, "{end} {best}");
}

/// The optimum in the projection is not that of triangles measured at their centers, as reports measure them.
#[test]
fn the_remaining_gain_covers_the_error_of_the_projection() {
    let mesh = lattice(0.2);
    for backend in backends() {
        let outcome = run(&on_sphere(&mesh), &Options::default(), backend);
        assert_eq!(outcome.stop, Stop::Converged, "{}", name(backend));
        let [projected, on_sphere] = [f, f_at_centers].map(|f| f(&mesh, &outcome.points));
        let least = 1.99 * (projected - on_sphere).abs() / on_sphere;
        assert!(least > 1e-4 && outcome.remaining.unwrap() > least, "{least} {outcome:?}");
    }
}

#[test]
fn a_bound_is_kept_in_degrees_and_no_vertex_gains_within_the_bound() {
    let mesh = lattice(0.2);
    let smoother = on_sphere(&mesh);
    let topology = smoother.topology();
    let most = 0.3;
    let options = Options::default().max_move(Some(most)).stopping(Stopping::Tolerance(1e-8));
    for backend in backends() {
        let outcome = run(&smoother, &options, backend);
        assert_eq!(outcome.stop, Stop::Converged, "{}", name(backend));
        let moved = |points: &[[f64; 2]]| {
            Change::between(topology, &mesh.points, points).unwrap().moved.most
        };
        let most_moved = moved(&outcome.points);
        assert!(most_moved <= most && most_moved > 0.999 * most, "{most_moved}");
        let allows = |points: &[[f64; 2]]| {
            moved(points) <= most && check::is_valid(&with_points(&mesh, points))
        };
        let left = left(&mesh, &outcome.points, allows);
        assert!(left < 1e-5, "{}: {left}", name(backend));
    }
}

#[test]
fn the_least_altitude_in_degrees_is_kept_or_improved() {
    let mesh = lattice(0.04);
    let smoother = on_sphere(&mesh);
    let least = |points: &[[f64; 2]]| {
        let altitude = |t: &[u32; 3]| {
            let [p, q, r] = t.map(|v| points[v as usize]);
            let way = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
            let edges = [way(p, q), way(q, r), way(r, p)];
            let longest = edges.map(|[x, y]| x.hypot(y)).into_iter().fold(0.0, f64::max);
            let [a, b] = [edges[0], edges[1]];
            (a[0] * b[1] - a[1] * b[0]) / longest
        };
        mesh.triangles.iter().map(altitude).fold(f64::INFINITY, f64::min)
    };
    let before = least(&mesh.points);
    let free = run(&smoother, &Options::default(), &backends()[0]);
    assert!(least(&free.points) < 0.9 * before, "the bound must matter");
    let keeps = Options::default().keep_altitude(true);
    let improves = keeps.clone().improve_worst(Some(WorstBy::Altitude));
    let [kept, improved] = [keeps, improves].map(|options| {
        let ends = backends().each_ref().map(|backend| {
            let outcome = run(&smoother, &options, backend);
            assert!(least(&outcome.points) >= before, "{}: {outcome:?}", name(backend));
            outcome
        });
        ends.map(|outcome| (least(&outcome.points), f(&mesh, &outcome.points), outcome.improved))
    });
    let [start, free] = [&mesh.points, &free.points].map(|points| f(&mesh, points));
    assert!(
        kept.iter().all(|kept| kept.1 - free < 0.5 * (start - free)),
        "{start} {free} {kept:?}"
    );
    for (altitude, _, report) in improved {
        let report = report.unwrap();
        // Sweeps leave room for the improvement, which moves no vertex if every triangle has the least altitude.
        assert!(altitude > 1.005 * before, "{altitude} {before} {report:?}");
        assert!((report.worst[1] / altitude - 1.0).abs() < 1e-9, "{altitude} {report:?}");
    }
}

#[test]
fn sliding_vertices_stay_on_their_parallels_and_meridians_and_lower_f() {
    let mesh = lattice(0.2);
    let mut smoother = on_sphere(&mesh);
    let fixed = run(&smoother, &Options::default(), &backends()[0]);
    let slide = Slide::default();
    assert!(smoother.set_slide(Some(&slide)).unwrap() > 30);
    for backend in backends() {
        let outcome = run(&smoother, &Options::default(), backend);
        assert_eq!(outcome.stop, Stop::Converged, "{}", name(backend));
        assert!(outcome.slid.unwrap().moved > 30);
        let topology = smoother.topology();
        assert_eq!(
            slide.misplaced(topology, &mesh.points, &outcome.points, Precision::Double),
            Vec::<u32>::new()
        );
        let [slid, fixed] = [&outcome, &fixed].map(|outcome| f(&mesh, &outcome.points));
        assert!(slid < 0.9 * fixed, "{slid} {fixed}");
        // A vertex of the boundary gains nothing by a step along its line.
        let mut gained = 0.0;
        for v in (0..mesh.points.len()).filter(|&v| !topology.free()[v]) {
            let axes = [0, 1].map(|axis| mesh.points.iter().map(move |p| p[axis]));
            let is_end = axes.map(|axis| {
                let (low, high) = axis.fold((90.0_f64, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
                [low, high]
            });
            let on = [0, 1].map(|axis| is_end[axis].contains(&mesh.points[v][axis]));
            if on == [true, true] {
                continue;
            }
            let along = usize::from(on[0]);
            for by in [-3e-3, 3e-3] {
                let mut points = outcome.points.clone();
                points[v][along] += by;
                gained += (slid - f(&mesh, &points)).max(0.0);
            }
        }
        assert!(gained < 1e-5 * slid, "{}: {gained}", name(backend));
    }
}

#[test]
fn a_field_of_equal_targets_leads_to_the_optimum_of_equal_targets() {
    let mesh = lattice(0.2);
    let mut smoother = on_sphere(&mesh);
    let plain = run(&smoother, &Options::default(), &backends()[0]);
    let targets = Targets::equilateral(mesh.points.len());
    let field = TargetField::new(&mesh, &targets).unwrap().seen_on(Surface::Sphere);
    smoother.set_target_field(field).unwrap();
    for backend in backends() {
        let outcome = run(&smoother, &Options::default(), backend);
        let [placed, plain] = [&outcome, &plain].map(|outcome| f(&mesh, &outcome.points));
        assert!((placed / plain - 1.0).abs() < 1e-4, "{}: {placed} {plain}", name(backend));
    }
}
