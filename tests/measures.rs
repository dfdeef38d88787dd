//! Quality measures compared with independent formulas, known triangles, and plain loops.

#[path = "measures/meshkernel.rs"]
mod meshkernel;
#[allow(dead_code)]
#[path = "metrics/oracles.rs"]
mod oracles;
#[path = "measures/quadrilaterals.rs"]
mod quadrilaterals;
#[allow(dead_code)]
#[path = "metrics/triangles.rs"]
mod triangles;

use gpu_smooth::{
    Mesh, Metric, Topology,
    measure::{Better, Definition, Measure, Measured, QUANTILES, Statistics},
    metric::Ideal,
};
use support::SplitMix64;

fn value(measure: Measure, points: [[f64; 2]; 3]) -> f64 {
    let mesh = Mesh { points: points.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    Measured::new(&mesh.points, &topology).unwrap().value(measure, 0)
}

/// Returns the value of a triangle whose winding is preserved. The topology belongs to another, counterclockwise
/// triangle: a topology of a single inverted triangle would reverse the winding.
fn value_as_wound(measure: Measure, points: [[f64; 2]; 3]) -> f64 {
    let upright = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let mesh = Mesh { points: upright, triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    Measured::new(&points, &topology).unwrap().value(measure, 0)
}

#[track_caller]
fn assert_close(found: f64, expected: f64, what: &str) {
    let close = found == expected || (found - expected).abs() <= 1e-9 * expected.abs().max(1.0);
    assert!(close, "{what}: {found} instead of {expected}");
}

/// Computes measures from edge lengths: angles by the law of cosines, the area by Heron's formula, radii from both, and
/// the condition from the singular values of the map from an equilateral triangle.
fn oracle(measure: Measure, [p, q, r]: [[f64; 2]; 3]) -> f64 {
    let distance = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
    let (a, b, c) = (distance(q, r), distance(r, p), distance(p, q));
    let angle = |opposite: f64, b: f64, c: f64| {
        ((b * b + c * c - opposite * opposite) / (2.0 * b * c)).clamp(-1.0, 1.0).acos()
    };
    let angles = [angle(a, b, c), angle(b, c, a), angle(c, a, b)];
    let least = angles.into_iter().fold(f64::INFINITY, f64::min);
    let most = angles.into_iter().fold(0.0, f64::max);
    let half = (a + b + c) / 2.0;
    let area = (half * (half - a) * (half - b) * (half - c)).sqrt();
    let (inradius, circumradius) = (area / half, a * b * c / (4.0 * area));
    let longest = a.max(b).max(c);
    let third = std::f64::consts::FRAC_PI_3;
    // The columns of A W⁻¹, where W has the columns (1, 0) and (1/2, √3/2).
    let (e, f) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
    let second = [0, 1].map(|i| (2.0 * f[i] - e[i]) / 3f64.sqrt());
    let (trace, determinant) = (
        e[0].powi(2) + e[1].powi(2) + second[0].powi(2) + second[1].powi(2),
        e[0] * second[1] - e[1] * second[0],
    );
    let root = (trace * trace / 4.0 - determinant * determinant).max(0.0).sqrt();
    let [large, small] = [(trace / 2.0 + root).sqrt(), (trace / 2.0 - root).sqrt()];
    let condition = (large / small + small / large) / 2.0;
    match measure {
        Measure::MinAngle => least.to_degrees(),
        Measure::MaxAngle => most.to_degrees(),
        Measure::EdgeRatio => longest / a.min(b).min(c),
        Measure::AspectRatio => longest / (2.0 * 3f64.sqrt() * inradius),
        Measure::RadiusRatio => circumradius / (2.0 * inradius),
        // The two longest edges enclose the smallest angle, whose sine is the smallest.
        Measure::ScaledJacobian => least.sin() / third.sin(),
        Measure::Condition | Measure::MedAspectFrobenius => condition,
        Measure::Shape => 1.0 / condition,
        Measure::Skewness => ((most - third) / (2.0 * third)).max((third - least) / third),
        Measure::SchismSkewness => longest / (area / std::f64::consts::PI).sqrt(),
        Measure::SizeRatio => 1.0,
        // The mesh consists of one triangle, without neighbors.
        Measure::Orthogonality => 0.0,
        Measure::Smoothness => 1.0,
        Measure::FlowLink => 2.0 / 3f64.powf(0.75),
        // The mesh consists of one triangle, so the triangle's area is the mean area.
        Measure::Metric(metric) => oracles::quality(metric, [a, b, c], area, Ideal::of_area(area)),
    }
}

#[test]
fn measures_agree_with_formulas_of_other_origin() {
    let mut rng = SplitMix64::new(7);
    let mut inside = 0;
    for _ in 0..2000 {
        let points = [(); 3].map(|()| [(); 2].map(|()| rng.unit()));
        let smallest = oracle(Measure::MinAngle, points);
        // The formulas of `oracle` lose digits on nearly flat triangles.
        if smallest < 0.5 {
            continue;
        }
        inside += 1;
        for &measure in Measure::ALL {
            let (found, expected) = (value(measure, points), oracle(measure, points));
            let slack = 1e-7 * expected.abs().max(1.0);
            assert!(
                (found - expected).abs() < slack,
                "{measure} of {points:?}: {found}, not {expected}"
            );
            let [least, most] = measure.definition().range;
            assert!((least..=most).contains(&found), "{measure}: {found}");
        }
    }
    assert!(inside > 1500);
}

#[test]
fn known_triangles_have_known_values() {
    use Measure::*;
    let root = |x: f64| x.sqrt();
    let equilateral = [[0.0, 0.0], [1.0, 0.0], [0.5, root(3.0) / 2.0]];
    for &measure in Measure::ALL {
        let ideal = measure.definition().ideal;
        // At the ideal, metrics of size are roots of sums of squares that vanish up to rounding.
        let is_of_size = |metric: gpu_smooth::Metric| {
            !metric.properties().scale_invariant && metric.properties().barrier
        };
        let slack = if matches!(measure, Metric(m) if is_of_size(m)) { 1e-7 } else { 1e-13 };
        assert!((value(measure, equilateral) - ideal).abs() < 60.0 * slack, "{measure}");
    }
    // Half a square: r = 1 - √2/2, R = √2/2.
    let half_square = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    // Legs 3 and 4: r = 1, R = 5/2, S = 6.
    let three_four_five = [[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]];
    // Angles of 30°, 30° and 120°: edges 1, 1 and √3, S = √3/4.
    let obtuse = [[0.0, 0.0], [root(3.0), 0.0], [root(3.0) / 2.0, 0.5]];
    let cases = [
        (half_square, MinAngle, 45.0),
        (half_square, MaxAngle, 90.0),
        (half_square, EdgeRatio, root(2.0)),
        (half_square, AspectRatio, root(2.0) / (2.0 * root(3.0) * (1.0 - root(0.5)))),
        (half_square, RadiusRatio, root(0.5) / (2.0 - root(2.0))),
        (half_square, ScaledJacobian, root(2.0 / 3.0)),
        (half_square, Condition, 2.0 / root(3.0)),
        (half_square, Shape, root(3.0) / 2.0),
        (half_square, Skewness, 0.25),
        (half_square, SchismSkewness, 2.0 * root(std::f64::consts::PI)),
        (three_four_five, MinAngle, 0.6f64.asin().to_degrees()),
        (three_four_five, MaxAngle, 90.0),
        (three_four_five, EdgeRatio, 5.0 / 3.0),
        (three_four_five, AspectRatio, 5.0 / (2.0 * root(3.0))),
        (three_four_five, RadiusRatio, 1.25),
        (three_four_five, ScaledJacobian, 1.2 / root(3.0)),
        (three_four_five, Condition, 50.0 / (24.0 * root(3.0))),
        (three_four_five, Shape, 24.0 * root(3.0) / 50.0),
        (obtuse, MinAngle, 30.0),
        (obtuse, MaxAngle, 120.0),
        (obtuse, EdgeRatio, root(3.0)),
        (obtuse, RadiusRatio, root(3.0) * (2.0 + root(3.0)) / (16.0 * 3.0 / 16.0)),
        (obtuse, ScaledJacobian, 1.0 / root(3.0)),
        (obtuse, Condition, 5.0 / 3.0),
        (obtuse, Skewness, 0.5),
    ];
    for (points, measure, expected) in cases {
        assert_close(value(measure, points), expected, measure.name());
    }
}

#[test]
fn measures_do_not_depend_on_size_place_and_rotation() {
    let (sin, cos) = 0.7f64.sin_cos();
    let base = [[0.0, 0.0], [4.0, 0.5], [1.0, 3.0]];
    for &measure in Measure::ALL {
        let expected = value(measure, base);
        let turned = base.map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]);
        assert_close(value(measure, turned), expected, measure.name());
        // The value does not depend on the choice of the first corner.
        assert_close(value(measure, [base[1], base[2], base[0]]), expected, measure.name());
        assert_close(value(measure, [base[0], base[2], base[1]]), expected, measure.name());
        for scale in [1e-90, 1e90] {
            let scaled = base.map(|p| p.map(|x| scale * x));
            assert_close(value(measure, scaled), expected, measure.name());
        }
        let far = base.map(|[x, y]| [x + 2f64.powi(40), y - 2f64.powi(40)]);
        assert_close(value(measure, far), expected, measure.name());
    }
    // Scales that `Topology` refuses, at which squares overflow or vanish.
    let scale_invariant = |m: &&Measure| !matches!(m, Measure::Metric(_));
    for &measure in
        Measure::ALL.iter().filter(scale_invariant).filter(|m| **m != Measure::SizeRatio)
    {
        for scale in [1e-300, 1e-200, 1e200, 1e307] {
            let scaled = base.map(|p| p.map(|x| scale * x));
            assert_close(value_as_wound(measure, scaled), value(measure, base), measure.name());
        }
    }
}

#[test]
fn measures_have_equal_values_only_if_their_rows_say_so() {
    let mut random = SplitMix64::new(5);
    // Metrics of sizes need triangles of several sizes.
    let points: Vec<[f64; 2]> = (0..60).map(|_| [0; 2].map(|_| random.unit())).collect();
    let triangles = (0..20).map(|t| [0, 1, 2].map(|corner| 3 * t + corner)).collect();
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    let measured = Measured::new(&mesh.points, &topology).unwrap();
    for (i, &measure) in Measure::ALL.iter().enumerate() {
        let is_close = |a: f64, b: f64| a == b || (a - b).abs() <= 1e-9 * b.abs();
        // Equal in the plane alone.
        if measure == Measure::Smoothness {
            continue;
        }
        let is_equal = |other: &&Measure| {
            (0..20).all(|t| is_close(measured.value(measure, t), measured.value(**other, t)))
        };
        assert_eq!(
            measure.equal_to(),
            Measure::ALL[..i].iter().find(is_equal).copied(),
            "{measure}"
        );
    }
}

#[test]
fn inverted_and_flat_triangles_are_as_in_verdict() {
    use Measure::*;
    let inverted = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]];
    let flat = [[0.0, 0.0], [1.0, 0.0], [4.0, 0.0]];
    let two_corners_in_one = [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]];
    let point = [[2.0, 3.0]; 3];
    let no_number = [[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]];
    let infinity = f64::INFINITY;
    let rows = [
        (MinAngle, [45.0, 0.0, 0.0, 0.0, 0.0]),
        (MaxAngle, [90.0, 180.0, 180.0, 180.0, 180.0]),
        (EdgeRatio, [2f64.sqrt(), 4.0, infinity, infinity, infinity]),
        (AspectRatio, [value(AspectRatio, inverted), infinity, infinity, infinity, infinity]),
        (RadiusRatio, [value(RadiusRatio, inverted), infinity, infinity, infinity, infinity]),
        (ScaledJacobian, [-(2f64 / 3.0).sqrt(), 0.0, 0.0, 0.0, 0.0]),
        (Condition, [infinity; 5]),
        (Shape, [0.0; 5]),
        (Skewness, [0.25, 1.0, 1.0, 1.0, 1.0]),
        (SchismSkewness, [value(SchismSkewness, inverted), infinity, infinity, infinity, infinity]),
        (Metric(gpu_smooth::Metric::Imr), [infinity; 5]),
        (Metric(gpu_smooth::Metric::Edge), [2f64.sqrt(), 4.0, infinity, infinity, infinity]),
    ];
    for (measure, expected) in rows {
        let cases = [inverted, flat, two_corners_in_one, point, no_number];
        for (points, expected) in cases.into_iter().zip(expected) {
            assert_close(
                value_as_wound(measure, points),
                expected,
                &format!("{measure} of {points:?}"),
            );
        }
    }
    // An inversion smaller than the rounding of a plain determinant.
    let flipped = [[0.0, 0.0], [1.0, 1.0], [0.1 + 0.2, 0.3]];
    assert!(value_as_wound(ScaledJacobian, flipped) < 0.0);
    assert_eq!(value_as_wound(Condition, flipped), infinity);
    assert_eq!(value_as_wound(Metric(gpu_smooth::Metric::Imr), flipped), infinity);
    let kept = [flipped[1], flipped[0], flipped[2]];
    assert!(value_as_wound(Condition, kept) > 1e15 && value_as_wound(Condition, kept).is_finite());
}

/// Returns a mesh, and positions with random shapes, an inverted triangle and a distant flat one. The topology belongs
/// to the valid mesh.
fn tangled() -> (Mesh, Vec<[f64; 2]>) {
    let mesh = support::perturb_random(&support::lattice(90, 70), 0.9, 3);
    let mut points = mesh.points.clone();
    let outer = support::boundary(&mesh);
    let inner: Vec<usize> = (0..points.len()).filter(|&v| !outer[v]).collect();
    let ring = Topology::new(&mesh).unwrap().ring(inner[100] as u32);
    points[inner[100]] = points[ring[0] as usize];
    points[inner[3000]] = points[inner[2500]];
    (mesh, points)
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// Compares statistics with a sorted list of the values and with plain sums.
#[track_caller]
fn assert_statistics(found: &Statistics, values: &[(usize, f64)]) {
    let measure = found.measure;
    let n = values.len() as f64;
    let in_order = sorted(values.iter().map(|v| v.1).collect());
    assert_eq!(
        (found.count, found.min, found.max),
        (values.len(), in_order[0], in_order[values.len() - 1])
    );
    for (share, quantile) in QUANTILES.into_iter().zip(found.quantiles) {
        // The quantile: the smallest value that a fraction `share` of all values does not exceed.
        let expected = (0..in_order.len()).find(|&i| (i + 1) as f64 >= share * n).unwrap();
        let expected = in_order[expected];
        assert_eq!(quantile, f64::from(expected as f32), "{measure} at {share}");
    }
    let extreme = if measure.definition().better == Better::Higher { found.min } else { found.max };
    let worst = values.iter().find(|v| v.1 == extreme).unwrap().0;
    assert_eq!(found.worst, worst, "{measure}");
    let mean = values.iter().map(|v| v.1).sum::<f64>() / n;
    let deviation = (values.iter().map(|v| (v.1 - mean).powi(2)).sum::<f64>() / n).sqrt();
    if mean.is_finite() {
        assert_close(found.mean / mean.max(1e-300), 1.0, measure.name());
        assert_close(found.deviation, deviation, measure.name());
    } else {
        assert_eq!((found.mean, found.deviation), (f64::INFINITY, f64::INFINITY));
    }
}

#[test]
fn statistics_are_those_of_the_values() {
    let (mesh, points) = tangled();
    let topology = Topology::new(&mesh).unwrap();
    let regions: Vec<u32> = (0..mesh.triangles.len()).map(|t| [0, 0, 0, 1, 2][t % 5]).collect();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let measured = Measured::new(&points, &topology).unwrap();
            let all = measured.statistics(Measure::ALL);
            let by_region = measured.statistics_by_region(Measure::ALL, &regions, 2);
            let values: Vec<_> = Measure::ALL.iter().map(|&m| measured.values(m)).collect();
            (all, by_region, values)
        })
    };
    let (all, by_region, values) = run(1);
    assert!(mesh.triangles.len() > 1 << 13, "only the path for few triangles is tried");
    for (i, values) in values.iter().enumerate() {
        let values: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
        assert_statistics(&all[i], &values);
        for (region, statistics) in by_region.iter().enumerate() {
            let own = values
                .iter()
                .copied()
                .filter(|v| regions[v.0] == region as u32)
                .collect::<Vec<_>>();
            assert_statistics(&statistics[i], &own);
        }
    }
    for threads in 2..=3 {
        assert!(
            run(threads) == (all.clone(), by_region.clone(), values.clone()),
            "{threads} threads"
        );
    }
}

#[test]
fn size_ratios_are_those_of_a_search_through_all_pairs() {
    let mesh = support::perturb_random(&support::lattice(9, 7), 0.9, 3);
    let topology = Topology::new(&mesh).unwrap();
    let values = Measured::new(&mesh.points, &topology).unwrap().values(Measure::SizeRatio);
    let area = |t: usize| {
        let [a, b, c] = mesh.triangles[t].map(|v| mesh.points[v as usize]);
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
    };
    let common = |s: usize, t: usize| {
        mesh.triangles[s].iter().filter(|v| mesh.triangles[t].contains(v)).count()
    };
    for (t, &value) in values.iter().enumerate() {
        let neighbors = (0..values.len()).filter(|&s| common(s, t) == 2);
        let expected =
            neighbors.map(|s| (area(s) / area(t)).max(area(t) / area(s))).fold(1.0, f64::max);
        assert_close(value, expected, "size-ratio");
        assert!(expected > 1.0);
    }
}

#[test]
fn histograms_worst_triangles_and_counts_are_those_of_the_values() {
    let (mesh, points) = tangled();
    let topology = Topology::new(&mesh).unwrap();
    let measured = Measured::new(&points, &topology).unwrap();
    for measure in [Measure::MinAngle, Measure::Condition] {
        let values = measured.values(measure);
        let edges = [1.0, 10.0, 30.0, f64::INFINITY];
        let inside = |i: usize, x: f64| edges[i] <= x && (x < edges[i + 1] || i == 2);
        let expected = [0, 1, 2].map(|i| values.iter().filter(|&&x| inside(i, x)).count());
        assert_eq!(measured.histogram(measure, &edges), expected);
        assert!(expected[..2].iter().all(|&n| n > 0));

        let mut order: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
        order.sort_by(|a, b| match measure {
            Measure::MinAngle => a.1.total_cmp(&b.1),
            _ => b.1.total_cmp(&a.1),
        });
        for most in [0, 1, 7, 5000, values.len(), values.len() + 1] {
            assert_eq!(measured.worst(measure, most), order[..most.min(order.len())]);
        }

        let below = |x: f64| x < 12.5;
        let expected = values.iter().filter(|&&x| below(x)).count();
        let first = values.iter().position(|&x| below(x));
        assert_eq!(measured.count_where(measure, below), (expected, first));
    }
    assert_eq!(measured.histogram(Measure::Shape, &[]), Vec::<usize>::new());
    assert!(measured.value(Measure::Shape, mesh.triangles.len()).is_nan());
}

/// Returns the text of a document in the repository, without carriage returns.
fn document(name: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name);
    std::fs::read_to_string(path).unwrap().replace("\r\n", "\n")
}

/// Returns the rows of the table whose first row begins with `head`.
fn table<'d>(document: &'d str, head: &str) -> Vec<&'d str> {
    let (_, rest) =
        document.split_once(&format!("\n{head}")).unwrap_or_else(|| panic!("no {head}"));
    rest.lines().skip(2).take_while(|line| line.starts_with('|')).collect()
}

/// Formats a number like the documents, without digits that are only rounding errors.
fn shown(number: f64) -> String {
    if number.is_infinite() { "∞".to_owned() } else { format!("{}", number as f32) }
}

/// The table of docs/quality.md has exactly one row for each measure, with the text of its definition.
#[test]
fn the_document_has_the_definitions() {
    let document = document("docs/quality.md");
    let found = table(&document, "| measure | ");
    let row = |measure: &Measure| {
        let Definition { name, formula, range, ideal, better, source, .. } = measure.definition();
        let formula = formula.replace('|', "\\|");
        let better = if better == Better::Higher { "higher" } else { "lower" };
        let source = if source.contains("SAND2007-1751") { "Verdict" } else { source };
        let ([least, most], ideal) = (range.map(shown), shown(ideal));
        format!(
            "| `{name}` | {formula} | {least} to {most} | {ideal}, {better} is better | {source} |"
        )
    };
    let expected: Vec<String> = Measure::ALL.iter().map(row).collect();
    for (i, expected) in expected.iter().enumerate() {
        let line = i + 1;
        let is_there = found.get(i).is_some_and(|found| found == expected);
        assert!(
            is_there,
            "row {line} of the table of measures in docs/quality.md must be:\n{expected}"
        );
    }
    assert_eq!(found[expected.len()..], [""; 0], "docs/quality.md has rows that no measure has");
}

/// The table of quadrilaterals in docs/quality.md has exactly one row for each measure that quadrilaterals have, except for metrics.
#[test]
fn the_document_has_the_definitions_for_quadrilaterals() {
    let document = document("docs/quality.md");
    let (_, section) = document.split_once("\n### Quadrilaterals\n").unwrap();
    let is_metric = |measure: &Measure| matches!(measure, Measure::Metric(_));
    let row = |measure: &Measure| {
        let own = measure.definition().quadrilateral?;
        let [least, most] = own.range.map(shown);
        let ideal = shown(own.ideal);
        Some(format!("| `{measure}` | {} | {least} to {most} | {ideal} |", own.formula))
    };
    let own = Measure::ALL.iter().filter(|measure| !is_metric(measure));
    let expected: Vec<String> = own.filter_map(row).collect();
    assert_eq!(
        table(section, "| measure | "),
        expected,
        "the table of quadrilaterals in docs/quality.md"
    );
}

/// Returns the code-quoted names in a text, in order.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

fn sorted_names<'n>(names: impl IntoIterator<Item = &'n str>) -> Vec<&'n str> {
    let mut names: Vec<_> = names.into_iter().collect();
    names.sort_unstable();
    names
}

/// Returns the sorted names of the metrics for which `is_wanted` is true.
fn names_of(is_wanted: impl Fn(&Metric) -> bool) -> Vec<&'static str> {
    let wanted = Metric::ALL.iter().copied().filter(|metric| is_wanted(metric));
    sorted_names(wanted.map(|metric| metric.name()))
}

#[test]
fn the_guide_has_a_row_for_each_metric() {
    let document = document("docs/guide.md");
    let rows = table(&document, "| name | q | good for |");
    let first = |row: &'_ str| row.split('|').nth(1).unwrap().to_owned();
    let cells: Vec<String> = rows.iter().map(|row| first(row)).collect();
    let found = sorted_names(cells.iter().flat_map(|cell| quoted(cell)));
    for metric in Metric::ALL {
        let row = metric.properties();
        let line =
            format!("| `{}` | {} | {} |", row.name, row.formula.replace('|', "\\|"), row.purpose);
        assert!(
            found.contains(&row.name),
            "the table of metrics in docs/guide.md needs a row such as\n{line}"
        );
    }
    assert_eq!(found, names_of(|_| true), "docs/guide.md has rows that no metric has");
}

#[test]
fn the_guide_names_the_metrics_without_a_barrier() {
    let document = document("docs/guide.md");
    let (_, rest) = document.split_once("**Barriers.** All metrics but ").unwrap();
    let (sentence, _) = rest.split_once(" grow without bound").unwrap();
    let expected = names_of(|metric| !metric.properties().barrier);
    let told =
        "the paragraph **Barriers.** of docs/guide.md must name the metrics without a barrier";
    assert_eq!(sorted_names(quoted(sentence)), expected, "{told}");
}

#[test]
fn the_page_of_targets_has_a_row_for_each_metric_of_sizes_with_a_barrier() {
    let document = document("docs/targets.md");
    let rows = table(&document, "| name | q² | sizes weigh |");
    let found = sorted_names(rows.iter().map(|row| quoted(row)[0]));
    let sees_sizes =
        |metric: &Metric| !metric.properties().scale_invariant && metric.properties().barrier;
    let told =
        "the table of metrics that see sizes in docs/targets.md needs a row for each of these";
    assert_eq!(found, names_of(sees_sizes), "{told}");
}

/// Documents must not state the number of metrics, which nobody would update.
#[test]
fn documents_do_not_count_metrics() {
    const NUMBERS: [&str; 8] = ["five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"];
    for name in [
        "README.md",
        "ARCHITECTURE.md",
        "docs/design.md",
        "docs/guide.md",
        "docs/quality.md",
        "docs/targets.md",
    ] {
        let text = document(name).to_lowercase();
        let words: Vec<&str> = text.split_whitespace().collect();
        let counts = words.windows(2).filter(|pair| {
            let is_number = NUMBERS.contains(&pair[0]) || pair[0].parse::<u32>().is_ok();
            is_number && pair[1].starts_with("metrics")
        });
        let found: Vec<_> = counts.collect();
        assert!(found.is_empty(), "{name} counts metrics, which are more with each row: {found:?}");
    }
}

#[test]
fn duplicate_and_unused_vertices_are_found() {
    let mut mesh = support::perturb_random(&support::lattice(40, 30), 0.9, 3);
    let count = mesh.points.len() as u32;
    // Zeros of either sign, a duplicate vertex, and two unused vertices, one of them at a separate position.
    mesh.points[0] = [0.0, 0.0];
    mesh.points.extend([[-0.0, 0.0], mesh.points[700], mesh.points[700], [0.5, 99.0]]);
    mesh.points[20] = mesh.points[19];
    let topology = Topology::new(&mesh).unwrap();
    let measured = Measured::new(&mesh.points, &topology).unwrap();
    assert_eq!(measured.duplicate_vertices(), [20, count, count + 1, count + 2]);
    assert_eq!(measured.unused_vertices(), [count, count + 1, count + 2, count + 3]);
}

#[test]
fn points_of_another_number_are_an_error() {
    let mesh = support::lattice(2, 2);
    let topology = Topology::new(&mesh).unwrap();
    assert!(Measured::new(&mesh.points[1..], &topology).is_err());
}
