//! Checks that must hold for any mesh, shared by the fuzzer's targets and `tests/fuzz.rs`. A violated check panics.

use gpu_smooth::{
    Backend, Guard, Mesh, MeshError, Method, Metric, Options, Quality, Scheme, Slide, SmoothError,
    Smoother, Targets, Topology, Untangle,
    options::{Derivatives, PNormExponent, Paper, Precision, Rounding, WorstBy},
    targets::Surface,
    topology,
};

/// A source of numbers from bytes. After the last byte, all numbers are 0.
struct Bytes<'b>(std::slice::Iter<'b, u8>);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or_default()
    }

    fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }
}

/// Makes options and a small mesh from arbitrary bytes, and smooths the mesh. The mesh may have holes, and be
/// tangled, tiny, huge or stretched.
pub(crate) fn any_mesh(bytes: &[u8], backend: &Backend) -> Became {
    let mut bytes = Bytes(bytes.iter());
    let options = options(&mut bytes);
    let mesh = mesh(&mut bytes, options.stored);
    let became = smooth(&mesh, &options, backend);
    if became == Became::Smoothed {
        smooth_whole(&mut bytes, &mesh, options, backend);
    }
    became
}

/// Continues with features of whole runs, selected by the remaining bytes: targets, sliding, bounds and improvement
/// of the worst triangles.
fn smooth_whole(bytes: &mut Bytes<'_>, mesh: &Mesh, options: Options, backend: &Backend) {
    let (what, which) = (bytes.byte(), bytes.below(4));
    if what == 0 {
        return;
    }
    let mut smoother = Smoother::new(mesh).unwrap();
    let options = options
        .guard(if what & 1 != 0 { Guard::Worst } else { Guard::default() })
        .keep_altitude(what & 2 != 0)
        .max_move((what & 4 != 0).then_some([1e-3, 0.1, 0.5, 2.0][which]))
        .improve_worst((what & 8 != 0).then_some(WorstBy::ALL[which % 3]));
    let rings = which as u32 % 3;
    let targets = match what >> 4 & 3 {
        1 => Targets::keep_size(smoother.topology(), &mesh.points, Surface::Plane, rings),
        2 => Targets::keep_shape(smoother.topology(), &mesh.points, rings),
        3 => {
            let sizes: Vec<f64> =
                mesh.points.iter().map(|_| 0.1 + f64::from(bytes.byte())).collect();
            Targets::sizes(&sizes)
        }
        _ => Ok(Targets::equilateral(mesh.points.len())),
    };
    let Ok(targets) = targets else { return };
    smoother.set_targets(&targets).unwrap();
    let slide = (what & 64 != 0).then(Slide::default);
    smoother.set_slide(slide.as_ref()).unwrap();
    let run = || smoother.run(&options).on(backend).block();
    let outcome = match run() {
        Ok(outcome) => outcome,
        Err(
            SmoothError::Option(_)
            | SmoothError::Mesh(MeshError::BeyondPrecision { .. } | MeshError::NothingFree { .. }),
        ) => {
            return;
        }
        Err(error) => panic!("{error}"),
    };
    let topology = smoother.topology();
    check_feasible(topology, &outcome.points);
    // Without lines to slide along, `misplaced` lists fixed vertices that have moved.
    let slide = slide.unwrap_or_else(|| {
        let held = (0..mesh.points.len() as u32).collect();
        Slide { held, ..Slide::default() }
    });
    let misplaced = slide.misplaced(topology, &mesh.points, &outcome.points, options.stored);
    assert!(misplaced.is_empty(), "vertices {misplaced:?} have left their lines");
    let f = |points: &[[f64; 2]]| smoother.f(options.scheme.base(), points).unwrap();
    let (start, end) = (f(&mesh.points), f(&outcome.points));
    let rises = options.improve_worst.is_some();
    assert!(rises || end <= start * (1.0 + 1e-12), "f rose from {start} to {end}");
    assert!(run().unwrap().points == outcome.points, "other points the second time");
}

fn check_feasible(topology: &Topology<'_>, points: &[[f64; 2]]) {
    let bad = topology::infeasible(points, topology.triangles()).unwrap();
    assert!(bad.is_empty(), "triangles {bad:?} are inverted or flat");
    let bad = topology.bad_quadrilaterals(points).unwrap();
    assert!(bad.is_empty(), "quadrilaterals {bad:?} are not convex");
}

/// The kind of result for a mesh.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Became {
    Refused,
    Smoothed,
    Untangled,
    StillTangled,
}

/// Makes a function that rounds to a number of significant digits, as text of a fixed width does.
macro_rules! digits {
    ($digits:literal) => {
        Rounding {
            name: concat!($digits, " digits"),
            round: |number| format!("{number:.*e}", $digits - 1).parse().unwrap_or(number),
            error: |size| 10f64.powi(1 - $digits) * size,
        }
    };
}

fn options(bytes: &mut Bytes<'_>) -> Options {
    let metric = |i: usize| Metric::ALL[i % Metric::ALL.len()].name();
    let first = bytes.below(256);
    let scheme: Scheme = match first % 3 {
        0 => [metric(first), metric(first / 7)].join("+").parse().unwrap(),
        _ => metric(first / 3).parse().unwrap(),
    };
    let flags = bytes.byte();
    let mut options = Options::default()
        .scheme(scheme)
        .max_sweeps(bytes.below(25) as u32)
        .method(if flags & 1 == 0 { Method::Auto } else { Method::RELAXED })
        .stored(match flags & 14 {
            2 => Precision::Single,
            6 => Precision::Custom(digits!(15)),
            10 => Precision::Custom(digits!(11)),
            14 => Precision::Custom(digits!(5)),
            _ => Precision::Double,
        });
    if flags & 48 == 16 {
        options.method = Method::Paper(Paper { newton_steps: 3, ..Paper::default() });
    }
    if flags & 192 == 64 {
        options.edge_norm = Some(PNormExponent::CONTINUED);
    }
    if flags & 192 == 128 {
        let differences = Paper { derivatives: Derivatives::FiniteDifference, ..Paper::default() };
        options.method = Method::Paper(differences);
    }
    options
}

fn mesh(bytes: &mut Bytes<'_>, stored: Precision) -> Mesh {
    let (columns, rows) = (1 + bytes.below(7), 1 + bytes.below(7));
    let stretch = 2f64.powi(i32::from(bytes.byte() as i8) / 12);
    let size = 2f64.powi(i32::from(bytes.byte() as i8) / 4);
    let offset = [0.0, 0.0, 1.0, 1e3, 1e6, -1e9][bytes.below(6)] * size;
    let disturbed = [0.0, 0.2, 0.5, 1.0, 4.0][bytes.below(5)];
    // No cells are quadrilaterals, or all, or a half.
    let wholes = [0, u8::MAX, 2][bytes.below(3)];
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let mut away = || f64::from(bytes.byte() as i8) / 128.0 * disturbed;
            let (x, y) = (column as f64 + away(), row as f64 + away());
            let point = [x * size * stretch + offset, y * size - offset];
            mesh.points.push(point.map(|x| stored.rounded(x)));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = (row * (columns + 1) + column) as u32;
            let (b, c) = (a + 1, a + columns as u32 + 1);
            let what = bytes.byte();
            if (what ^ what >> 4) & wholes != 0 {
                // Omits the quadrilateral, or reverses its winding.
                let mut quadrilateral = [a, b, c + 1, c];
                if what >> 5 == 7 {
                    quadrilateral.reverse();
                }
                if what >> 3 != 9 {
                    mesh.quadrilaterals.push(quadrilateral);
                }
                continue;
            }
            let halves = match what & 1 {
                0 => [[a, b, c], [b, c + 1, c]],
                _ => [[a, b, c + 1], [a, c + 1, c]],
            };
            for (half, mut triangle) in halves.into_iter().enumerate() {
                // Omits the triangle, or reverses its winding.
                if what >> (2 + half) & 7 == 7 {
                    continue;
                }
                if what >> (5 + half) & 3 == 3 {
                    triangle.swap(0, 1);
                }
                mesh.triangles.push(triangle);
            }
        }
    }
    // Sometimes adds fixed vertices, some of them twice, and a triangle that does not fit into the plane.
    for _ in 0..bytes.below(6) {
        mesh.fixed.push(bytes.below(mesh.points.len()) as u32);
    }
    if bytes.byte() > 250 {
        let corner = || bytes.below(mesh.points.len()) as u32;
        let corners: Vec<u32> = std::iter::repeat_with(corner).take(3).collect();
        mesh.triangles.push([corners[0], corners[1], corners[2]]);
    }
    mesh
}

fn smooth(mesh: &Mesh, options: &Options, backend: &Backend) -> Became {
    let smoother = match Smoother::new(mesh) {
        Ok(smoother) => smoother,
        Err(MeshError::Infeasible { .. }) => return untangled(mesh, options),
        Err(_) => return Became::Refused,
    };
    let run = || smoother.run(options).on(backend).block();
    let outcome = match run() {
        Ok(outcome) => outcome,
        Err(SmoothError::Mesh(
            MeshError::BeyondPrecision { .. } | MeshError::NothingFree { .. },
        )) => return Became::Refused,
        Err(error) => panic!("{error}"),
    };
    let again = run().unwrap();
    let bits = |points: &[[f64; 2]]| points.iter().map(|p| p.map(f64::to_bits)).collect::<Vec<_>>();
    let (before, after) = (bits(&mesh.points), bits(&outcome.points));
    assert!(after == bits(&again.points), "other bits the second time");
    let topology = smoother.topology();
    for (vertex, (old, new)) in before.iter().zip(&after).enumerate() {
        assert!(topology.free()[vertex] || old == new, "vertex {vertex} is fixed and has moved");
    }
    check_feasible(topology, &outcome.points);
    let f = |points: &[[f64; 2]]| {
        Quality::of(points, smoother.topology()).unwrap().f(options.scheme.base())
    };
    let (start, end) = (f(&mesh.points), f(&outcome.points));
    assert!(end <= start * (1.0 + 1e-12), "f rose from {start} to {end}");
    assert_eq!(outcome.history.len() as u32, outcome.sweeps + 1);
    Became::Smoothed
}

/// Untangles a mesh with bad elements. The number of bad triangles and corners must not increase, and a mesh reported as
/// untangled must be valid.
fn untangled(mesh: &Mesh, options: &Options) -> Became {
    let untangled = Untangle::new(mesh).stored(options.stored).run();
    let Ok(untangled) = untangled else { return Became::Refused };
    let left = untangled.left.len() + untangled.left_quadrilaterals.len();
    assert!(left <= untangled.bad_before);
    let mended = Mesh { points: untangled.points, ..mesh.clone() };
    match Smoother::new(&mended) {
        Ok(smoother) => {
            // The remaining corners are so flat that double precision cannot judge them.
            assert!(left <= smoother.beyond_precision().len());
            for (vertex, free) in smoother.topology().free().iter().enumerate() {
                let bits = |mesh: &Mesh| mesh.points[vertex].map(f64::to_bits);
                assert!(*free || bits(mesh) == bits(&mended), "vertex {vertex} has moved");
            }
            Became::Untangled
        }
        Err(MeshError::Infeasible { .. }) => {
            assert!(left > 0);
            Became::StillTangled
        }
        Err(_) => Became::Refused,
    }
}
