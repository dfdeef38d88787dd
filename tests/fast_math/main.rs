//! Pairs of floats must keep their digits under compilers that treat floats as real numbers, like Metal's by default:
//! such compilers reorder sums, cancel terms and fuse products with additions.

#[allow(dead_code, unreachable_pub)]
mod compiler;

use compiler::Program;
use gpu_smooth::{Metric, gpu::Kernel, options::Derivatives};
use support::SplitMix64;

/// Values of a function's arguments, by name.
type Inputs = Vec<(&'static str, f32)>;

/// A function that computes the error of results in units of the allowed rounding error. The parameters are a lookup of
/// arguments by name, and the results.
type ErrorOf = fn(&dyn Fn(&str) -> f64, &[f64]) -> f64;

/// A test case: a kernel's function, random inputs, and the error of its results.
struct Case {
    function: &'static str,
    kernel: Kernel,
    inputs: fn(&mut SplitMix64) -> Inputs,
    error: ErrorOf,
}

/// Half a unit in the last place of a float close to 1, with a margin for several roundings.
const FLOAT: f64 = 1.0 / (1u64 << 21) as f64;
/// Half a unit in the last place of a pair of floats close to 1, with a margin for several roundings.
const PAIR: f64 = 1.0 / (1u64 << 44) as f64;

fn split(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

/// Returns a number with random sign and digits, and a magnitude from `size` / 2 to 2 `size`.
fn number(rng: &mut SplitMix64, size: f64) -> f64 {
    let sign = if rng.below(2) == 0 { 1.0 } else { -1.0 };
    sign * size * rng.range(0.5, 2.0)
}

fn two_floats(rng: &mut SplitMix64) -> Inputs {
    let size = 2f64.powi(rng.below(31) as i32 - 15);
    vec![("x", number(rng, 1.0) as f32), ("y", number(rng, size) as f32)]
}

fn two_pairs(rng: &mut SplitMix64) -> Inputs {
    let ([a, a_low], [b, b_low]) = near_pairs(rng);
    vec![("a.x", a), ("a.y", a_low), ("b.x", b), ("b.y", b_low)]
}

/// Returns two pairs whose difference is a millionth, a thousandth, or all of their size.
fn near_pairs(rng: &mut SplitMix64) -> ([f32; 2], [f32; 2]) {
    let a = number(rng, 1.0);
    let apart = [1e-6, 1e-3, 1.0][rng.below(3)];
    (split(a), split(a + number(rng, apart)))
}

/// Returns random values for the arguments of two positions, named by `tail` and `head`.
fn positions(rng: &mut SplitMix64, [tail, head]: [[&'static str; 4]; 2]) -> Inputs {
    let ([ax, ax_low], [bx, bx_low]) = near_pairs(rng);
    let ([ay, ay_low], [by, by_low]) = near_pairs(rng);
    let tail = tail.into_iter().zip([ax, ay, ax_low, ay_low]);
    tail.chain(head.into_iter().zip([bx, by, bx_low, by_low])).collect()
}

/// Returns the difference in units of `lost`; infinite for NaN.
fn error(found: f64, exact: f64, lost: f64) -> f64 {
    let error = (found - exact).abs() / lost;
    if error.is_nan() { f64::INFINITY } else { error }
}

fn sum_error(found: &[f64], a: f64, b: f64) -> f64 {
    let normalized = found[1].abs() <= found[0].abs() * f64::from(f32::EPSILON);
    let lost = error(found[0] + found[1], a + b, PAIR * a.abs().max(b.abs()));
    if normalized { lost } else { f64::INFINITY }
}

fn difference_error(found: f64, a: f64, b: f64) -> f64 {
    error(found, a - b, FLOAT * (a - b).abs() + PAIR * a.abs().max(b.abs()))
}

fn cases() -> Vec<Case> {
    let sweep = || Kernel::Sweep(Metric::Imr, Derivatives::Analytic);
    vec![
        Case {
            function: "two_sum",
            kernel: sweep(),
            inputs: two_floats,
            error: |x, found| sum_error(found, x("x"), x("y")),
        },
        Case {
            function: "pair_add",
            kernel: sweep(),
            inputs: two_pairs,
            error: |x, found| sum_error(found, x("a.x") + x("a.y"), x("b.x") + x("b.y")),
        },
        Case {
            function: "pair_times",
            kernel: Kernel::Import,
            inputs: |rng| {
                let [high, low] = split(number(rng, 1e3));
                vec![("a.x", high), ("a.y", low), ("y", number(rng, 1.0) as f32)]
            },
            error: |x, found| sum_error(found, (x("a.x") + x("a.y")) * x("y"), 0.0),
        },
        Case {
            function: "pair_accumulate",
            kernel: sweep(),
            inputs: |rng| {
                let [high, low] = split(number(rng, 1.0));
                vec![("sum.x", high), ("sum.y", low), ("term", number(rng, 1e-3) as f32)]
            },
            error: |x, found| {
                let (sum, term) = (x("sum.x") + x("sum.y"), x("term"));
                error(found[0] + found[1], sum + term, PAIR * sum.abs().max(term.abs()))
            },
        },
        Case {
            function: "pair_difference",
            kernel: sweep(),
            inputs: two_pairs,
            error: |x, found| difference_error(found[0], x("a.x") + x("a.y"), x("b.x") + x("b.y")),
        },
        Case {
            function: "gain",
            kernel: Kernel::Finish(vec![Metric::Imr]),
            inputs: |rng| {
                let ([a, a_low], [b, b_low]) = near_pairs(rng);
                vec![("earlier.x", a), ("earlier.y", a_low), ("later.x", b), ("later.y", b_low)]
            },
            error: |x, found| {
                let (a, b) = (x("earlier.x") + x("earlier.y"), x("later.x") + x("later.y"));
                difference_error(found[0], a, b)
            },
        },
        Case {
            function: "advanced",
            kernel: sweep(),
            inputs: |rng| {
                let names = [["at.x", "at.y", "at.z", "at.w"], ["", "", "", ""]];
                let mut inputs = positions(rng, names);
                inputs.truncate(4);
                let step = 10f64.powi(-(rng.below(7) as i32));
                inputs.extend(["d.x", "d.y"].map(|name| (name, number(rng, step) as f32)));
                inputs
            },
            error: |x, found| {
                let along_x = sum_error(&[found[0], found[2]], x("at.x") + x("at.z"), x("d.x"));
                let along_y = sum_error(&[found[1], found[3]], x("at.y") + x("at.w"), x("d.y"));
                along_x.max(along_y)
            },
        },
        Case {
            function: "edge",
            kernel: sweep(),
            inputs: |rng| {
                let tail = ["tail.x", "tail.y", "tail.z", "tail.w"];
                positions(rng, [tail, ["head.x", "head.y", "head.z", "head.w"]])
            },
            error: |x, found| {
                let [tail_x, head_x] = ["tail.x", "head.x"].map(x);
                let [tail_y, head_y] = ["tail.y", "head.y"].map(x);
                difference_error(found[0], head_x + x("head.z"), tail_x + x("tail.z"))
                    .max(difference_error(found[1], head_y + x("head.w"), tail_y + x("tail.w")))
            },
        },
        Case {
            // A short edge between vertices that a correction moves far.
            function: "moved_edge",
            kernel: Kernel::ObjectiveAlongCorrection(Metric::Imr),
            inputs: |rng| {
                let far = number(rng, 1.0);
                let names = ["tail_displacement.x", "head_displacement.x"];
                let names_y = ["tail_displacement.y", "head_displacement.y"];
                let near = |name, rng: &mut SplitMix64| (name, (far + number(rng, 1e-6)) as f32);
                let mut inputs =
                    vec![("e.x", number(rng, 1e-6) as f32), ("e.y", number(rng, 1e-6) as f32)];
                inputs.extend(names.into_iter().chain(names_y).map(|name| near(name, rng)));
                inputs
            },
            error: |x, found| {
                let along = |e: f64, tail: f64, head: f64, found: f64| {
                    let lost = FLOAT * (e.abs() + (head - tail).abs());
                    error(found, e + (head - tail), lost)
                };
                let tail = ["tail_displacement.x", "tail_displacement.y"].map(x);
                let head = ["head_displacement.x", "head_displacement.y"].map(x);
                along(x("e.x"), tail[0], head[0], found[0]).max(along(
                    x("e.y"),
                    tail[1],
                    head[1],
                    found[1],
                ))
            },
        },
        Case {
            // A mesh far from the origin, whose normalized position is small relative to the center.
            function: "imported",
            kernel: Kernel::Import,
            inputs: |rng| {
                let center = number(rng, 1e6);
                let [high, low] = split(center);
                let x = (center + number(rng, 100.0)) as f32;
                vec![("x", x), ("center.x", high), ("center.y", low), ("exchange.scale", 8.0)]
            },
            error: |x, found| {
                let center = x("center.x") + x("center.y");
                sum_error(&[found[0] / 8.0, found[1] / 8.0], x("x"), -center)
            },
        },
        Case {
            function: "exported",
            kernel: Kernel::Export,
            inputs: |rng| {
                let names = [
                    [
                        "exchange.center.x",
                        "exchange.center.y",
                        "exchange.center.z",
                        "exchange.center.w",
                    ],
                    ["p.x", "p.y", "p.z", "p.w"],
                ];
                // The position nearly cancels the center.
                let mut inputs = positions(rng, names);
                inputs[4..].iter_mut().for_each(|(_, p)| *p *= -8.0);
                inputs.push(("exchange.inverse_scale", 0.125));
                inputs
            },
            error: |x, found| {
                let along = |center: f64, p: f64, found: f64| {
                    let exact = center + 0.125 * p;
                    error(found, exact, FLOAT * exact.abs() + PAIR * center.abs())
                };
                let center = |high, low| x(high) + x(low);
                along(
                    center("exchange.center.x", "exchange.center.z"),
                    x("p.x") + x("p.z"),
                    found[0],
                )
                .max(along(
                    center("exchange.center.y", "exchange.center.w"),
                    x("p.y") + x("p.w"),
                    found[1],
                ))
            },
        },
    ]
}

/// Returns the largest error of a function, over random inputs and orders of evaluation.
fn worst(case: &Case, wgsl: &str) -> f64 {
    let program = Program::new(wgsl, case.function);
    let mut rng = SplitMix64::new(51);
    let mut worst = 0f64;
    for _ in 0..2000 {
        let inputs = (case.inputs)(&mut rng);
        let input = |name: &str| {
            // Sums of the history are identified by the argument in their index (`earlier` or `later`) and the part,
            // `.x` or `.y`.
            let of_history = ["earlier", "later"]
                .into_iter()
                .find(|argument| name.starts_with("control.") && name.contains(argument))
                .map(|argument| format!("{argument}{}", &name[name.len() - 2..]));
            let name = of_history.as_deref().unwrap_or(name);
            let known = inputs.iter().find(|(known, _)| *known == name);
            known.unwrap_or_else(|| panic!("no input '{name}'")).1
        };
        let found = program.evaluate(&input, &mut rng);
        let found: Vec<f64> = found.into_iter().map(f64::from).collect();
        worst = worst.max((case.error)(&|name| input(name).into(), &found));
    }
    worst
}

#[test]
fn no_order_of_evaluation_loses_digits() {
    for case in cases() {
        let worst = worst(&case, &case.kernel.wgsl());
        assert!(worst <= 1.0, "{}: {worst:.1} times what may be lost", case.function);
    }
}

/// Guards to remove from the source, and the functions that lose digits without the guard.
const UNGUARDED: [(&str, &str, &[&str]); 8] = [
    // The former state of shaders/pairs.wgsl and shaders/patch.wgsl, without this guard.
    (
        "opaque(a - aa) + opaque(b - bb)",
        "(a - aa) + (b - bb)",
        &["two_sum", "pair_add", "advanced"],
    ),
    (
        "opaque2(head.xy - tail.xy) + opaque2(head.zw - tail.zw)",
        "(head.xy - tail.xy) + (head.zw - tail.zw)",
        &["edge"],
    ),
    (
        "opaque(a.x - b.x) + opaque(a.y - b.y)",
        "(a.x - b.x) + (a.y - b.y)",
        &["pair_difference", "gain"],
    ),
    (
        "opaque2(head_displacement - tail_displacement)",
        "(head_displacement - tail_displacement)",
        &["moved_edge"],
    ),
    ("let product = opaque(x * y);", "let product = x * y;", &["pair_times"]),
    ("let s = opaque(a + b);", "let s = a + b;", &["two_sum", "imported"]),
    ("let bb = opaque(s - a);", "let bb = s - a;", &["two_sum"]),
    ("let aa = opaque(s - bb);", "let aa = s - bb;", &["two_sum"]),
];

#[test]
fn sums_without_their_guards_lose_digits() {
    for (guarded, unguarded, functions) in UNGUARDED {
        for function in functions {
            let case = cases().into_iter().find(|case| case.function == *function).unwrap();
            let wgsl = case.kernel.wgsl();
            assert_eq!(wgsl.matches(guarded).count(), 1, "{guarded}");
            let worst = worst(&case, &wgsl.replace(guarded, unguarded));
            assert!(worst > 100.0, "{function}, {unguarded}: {worst:.1}");
        }
    }
}

#[test]
fn an_exclusive_or_with_a_known_zero_hides_nothing() {
    for case in cases() {
        let wgsl = case.kernel.wgsl();
        let seen_through =
            wgsl.replace("return bitcast<f32>(opaque_bits(x));", "return x;").replace(
                "return bitcast<vec2<f32>>(bitcast<vec2<u32>>(v) ^ vec2(runtime_zero()));",
                "return v;",
            );
        assert_ne!(wgsl, seen_through);
        let worst = worst(&case, &seen_through);
        assert!(worst > 100.0, "{}: {worst:.1}", case.function);
    }
}
