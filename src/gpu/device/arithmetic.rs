//! Checks the arithmetic of kernels as the adapter's compiler translates it.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, zeroed};
use crate::gpu::device::pending::{Pending, Waiting};
use crate::gpu::device::readback;
use crate::gpu::kernels::form::Positions;
use crate::gpu::kernels::layouts::ArithmeticBindings;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{
    ArithmeticInput, ArithmeticResult, Params, WORKGROUP, pair, unpair,
};
use crate::gpu::scope::scoped;

impl Gpu {
    /// Checks the arithmetic of the adapter. The check is made once; later calls return the first result.
    ///
    /// The kernels hold positions in pairs of floats. A compiler that reorders sums, as WGSL permits, may drop the
    /// second float of each. The kernels guard against reordered sums; this call runs one tiny kernel and compares its
    /// results with exact ones. [`Gpu::open`] and the runs of [`Smoother`](crate::Smoother) check the arithmetic
    /// themselves. An application that encodes sweeps on its own device ([`Gpu::new`]) should call this method when it
    /// starts. Any thread may call this method, which waits until all submitted work is done.
    ///
    /// # Errors
    /// [`GpuError::Arithmetic`] if digits are lost, or another [`GpuError`] if the device fails.
    pub fn check_arithmetic(&self) -> Pending<'_, ()> {
        Pending::new(|waiting| Box::pin(self.arithmetic_checked(waiting)))
    }

    pub(crate) async fn arithmetic_checked(&self, waiting: Waiting) -> Result<(), GpuError> {
        let fault = match self.arithmetic.get() {
            Some(&known) => known,
            None => {
                let found = fault(self, Kernel::CheckArithmetic.wgsl(), waiting).await?;
                *self.arithmetic.get_or_init(|| found)
            }
        };
        match fault {
            None => Ok(()),
            Some(operation) => {
                let adapter = self.adapter().name.clone();
                Err(GpuError::Arithmetic { adapter, operation })
            }
        }
    }
}

/// Runs the kernel with this source and names the first operation whose result is wrong.
async fn fault(
    gpu: &Gpu,
    wgsl: String,
    waiting: Waiting,
) -> Result<Option<&'static str>, GpuError> {
    let cases = cases();
    let inputs: Vec<_> = cases.iter().map(|case| case.input).collect();
    let (kernel, positions) = (Kernel::CheckArithmetic, Positions::Whole);
    let label = Some("gpu-smooth check_arithmetic");
    let results = scoped(&gpu.device, || {
        let params = [Params::outside_runs(0)];
        let params = filled(gpu, "params of check_arithmetic", &params, Usage::UNIFORM);
        let inputs = filled(gpu, "inputs of check_arithmetic", &inputs, Usage::STORAGE);
        let bytes = (cases.len() * size_of::<ArithmeticResult>()) as u64;
        let usage = Usage::STORAGE | Usage::COPY_SRC;
        let results = zeroed(gpu, "results of check_arithmetic", bytes, usage);
        // Needed only once, so it is not kept with the pipelines of runs.
        let pipeline = gpu.pipelines.compile(&gpu.device, &kernel, positions, wgsl);
        let bindings = ArithmeticBindings {
            params: params.as_entire_binding(),
            inputs: inputs.as_entire_binding(),
            results: results.as_entire_binding(),
        };
        let bound = gpu.pipelines.bind(&gpu.device, positions, bindings);
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        {
            let descriptor = wgpu::ComputePassDescriptor { label, timestamp_writes: None };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bound, &[]);
            gpu.device.counters().add_dispatch(false);
            pass.dispatch_workgroups((cases.len() as u32).div_ceil(WORKGROUP), 1, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        results
    })?;
    let results = readback::read(gpu, &results, cases.len(), waiting).await?;
    Ok(cases.iter().zip(&results).find_map(|(case, result)| case.fault(result)))
}

/// Input of one invocation of the kernel, with the property of the result to check.
struct Case {
    input: ArithmeticInput,
    expected: Expected,
}

enum Expected {
    /// Check the digits of sums and differences.
    Digits,
    /// Check whether the area counts as positive.
    Positive(bool),
}

/// Returns the inputs: positions up to a million edges from the origin, where an edge is in the low parts alone, and
/// edge vectors that span areas of all kinds.
fn cases() -> Vec<Case> {
    let digits = (0..24).map(|i| {
        let n = f64::from(i);
        let size = [0.01, 1.0, 1e3, 1e6][i as usize % 4];
        let a = [size * (2.0 + n).sqrt(), -size * (3.0 + 2.0 * n).sqrt()];
        // The first 16 are near each other, the others far apart.
        let b = if i < 16 {
            [a[0] + 0.37 / (1.0 + n).sqrt(), a[1] - 0.21 * (5.0 + n).sqrt()]
        } else {
            [-0.3 * (7.0 + n).sqrt(), 0.7 * size * (11.0 + n).sqrt()]
        };
        let input = ArithmeticInput { a: position(a), b: position(b) };
        Case { input, expected: Expected::Digits }
    });
    let (nan, infinity) = (f32::NAN, f32::INFINITY);
    let areas = [
        ([1.0, 0.0], [0.0, 1.0], true),
        ([1e-9, 0.0], [0.0, 1e-9], true),
        ([0.0, 1.0], [1.0, 0.0], false),
        ([1.0, 2.0], [2.0, 4.0], false),
        ([nan, 1.0], [1.0, 1.0], false),
        ([1.0, 1.0], [1.0, nan], false),
        // The area becomes infinity minus infinity, or infinity times zero.
        ([infinity, infinity], [1.0, 1.0], false),
        ([infinity, 0.0], [1.0, 0.0], false),
        ([3e38, 0.0], [0.0, 3e38], false),
    ];
    let areas = areas.map(|([ax, ay], [bx, by], positive)| Case {
        input: ArithmeticInput { a: [ax, ay, 0.0, 0.0], b: [bx, by, 0.0, 0.0] },
        expected: Expected::Positive(positive),
    });
    digits.chain(areas).collect()
}

/// A position as kernels store it: the high parts, then the low parts.
fn position([x, y]: [f64; 2]) -> [f32; 4] {
    let ([x, x_low], [y, y_low]) = (pair(x), pair(y));
    [x, y, x_low, y_low]
}

/// Relative error allowed in a pair of floats: 2⁻⁴⁰, as a pair has 48 bits and some roundings are allowed for.
const PAIR: f64 = 1.0 / (1u64 << 40) as f64;
/// Relative error allowed in a float: 2⁻²⁰, as a float has 24 bits and some roundings are allowed for.
const FLOAT: f64 = 1.0 / (1u64 << 20) as f64;

impl Case {
    /// Returns the first operation with a wrong result; `None` if all results are right. Comparisons are written so
    /// that NaN counts as wrong.
    fn fault(&self, result: &ArithmeticResult) -> Option<&'static str> {
        if let Expected::Positive(positive) = self.expected {
            let found = result.is_positive != 0.0;
            return (found != positive).then_some(if positive {
                "a positive area passes for inverted"
            } else {
                "an area that is inverted, flat or not a number passes for positive"
            });
        }
        let ArithmeticInput { a, b } = self.input;
        let pairs = |[x, y, x_low, y_low]: [f32; 4]| [[x, x_low], [y, y_low]];
        let ([ax, ay], [bx, by]) = (pairs(a).map(unpair), pairs(b).map(unpair));
        let is_sum = |found: [f32; 2], x: f64, y: f64| {
            let normalized = found[1].abs() <= found[0].abs() * f32::EPSILON;
            normalized && (unpair(found) - (x + y)).abs() <= PAIR * x.abs().max(y.abs())
        };
        let is_difference = |found: f32, x: f64, y: f64| {
            let lost = FLOAT * (x - y).abs() + PAIR * x.abs().max(y.abs());
            (f64::from(found) - (x - y)).abs() <= lost
        };
        let [moved_x, moved_y] = pairs(result.advanced);
        let checks = [
            (
                is_sum(result.two_sum, a[0].into(), b[0].into()),
                "the rounding error of a sum of two floats is lost",
            ),
            (is_sum(result.pair_add, ax, bx), "the sum of two pairs of floats loses digits"),
            (
                is_sum(moved_x, ax, b[0].into()) && is_sum(moved_y, ay, b[1].into()),
                "a position that is moved loses digits",
            ),
            (
                is_difference(result.edge[0], bx, ax) && is_difference(result.edge[1], by, ay),
                "the edge between two positions loses digits",
            ),
            (
                is_difference(result.difference, ax, bx),
                "the difference of two pairs of floats loses digits",
            ),
        ];
        checks.into_iter().find(|&(is_right, _)| !is_right).map(|(_, operation)| operation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the fault that is found after these replacements in the kernel's source.
    fn fault_after(gpu: &Gpu, replacements: &[(&str, &str)]) -> Option<&'static str> {
        let mut wgsl = Kernel::CheckArithmetic.wgsl();
        for (right, wrong) in replacements {
            assert_eq!(wgsl.matches(right).count(), 1, "{right}");
            wgsl = wgsl.replace(right, wrong);
        }
        pollster::block_on(fault(gpu, wgsl, Waiting::Block)).unwrap()
    }

    #[test]
    fn an_adapter_that_keeps_all_digits_passes() {
        let gpu = Gpu::open(None).block().unwrap();
        assert_eq!(fault_after(&gpu, &[]), None);
        gpu.check_arithmetic().block().unwrap();
    }

    /// Each row: a sum as written in the kernels, a form to which a compiler could simplify the sum, and the fault that
    /// the check must report for this form.
    const FOLDED: [(&str, &str, &str); 6] = [
        (
            "opaque(a - aa) + opaque(b - bb)",
            "(a + b) - bb - aa",
            "the rounding error of a sum of two floats is lost",
        ),
        (
            "opaque(a - aa) + opaque(b - bb)",
            "0.0",
            "the rounding error of a sum of two floats is lost",
        ),
        (
            "two_sum(s.x, s.y + (a.y + b.y))",
            "vec2(s.x + (s.y + (a.y + b.y)), 0.0)",
            "the sum of two pairs of floats loses digits",
        ),
        (
            "opaque2(head.xy - tail.xy) + opaque2(head.zw - tail.zw)",
            "head.xy - (tail.xy + tail.zw) + head.zw",
            "the edge between two positions loses digits",
        ),
        (
            "opaque(a.x - b.x) + opaque(a.y - b.y)",
            "(a.x + a.y) - (b.x + b.y)",
            "the difference of two pairs of floats loses digits",
        ),
        (
            "pair_add(at.xz, vec2(d.x, 0.0))",
            "vec2(at.x + (d.x + at.z), 0.0)",
            "a position that is moved loses digits",
        ),
    ];

    #[test]
    fn sums_folded_by_fast_math_are_found() {
        let gpu = Gpu::open(None).block().unwrap();
        for (right, wrong, operation) in FOLDED {
            assert_eq!(fault_after(&gpu, &[(right, wrong)]), Some(operation), "{wrong}");
        }
    }

    #[test]
    fn a_nan_area_that_passes_for_positive_is_found() {
        let gpu = Gpu::open(None).block().unwrap();
        // `x > 0` in a form that a compiler may choose if it assumes that there are no NaNs.
        let careless = [("opaque_bits(x) - 1u < 0x7f7fffffu", "!(x <= 0.0)")];
        let operation = "an area that is inverted, flat or not a number passes for positive";
        assert_eq!(fault_after(&gpu, &careless), Some(operation));
        let refusing = [("opaque_bits(x) - 1u < 0x7f7fffffu", "x < 0.0")];
        assert_eq!(fault_after(&gpu, &refusing), Some("a positive area passes for inverted"));
    }

    #[test]
    fn an_adapter_that_drops_digits_is_named_with_the_fault() {
        let gpu = Gpu::open(None).block().unwrap();
        let opened = Gpu::new(gpu.device().clone(), gpu.queue().clone()).unwrap();
        let found = fault_after(&opened, &[(FOLDED[1].0, FOLDED[1].1)]);
        opened.arithmetic.set(found).unwrap();
        let error = opened.check_arithmetic().block().unwrap_err();
        assert!(matches!(error, GpuError::Arithmetic { .. }));
        let text = error.to_string();
        for part in [&gpu.adapter().name, "the rounding error"] {
            assert!(text.contains(part), "{part} is not in: {text}");
        }
    }

    #[test]
    fn runs_refuse_an_adapter_that_drops_digits() {
        use crate::{Backend, Mesh, Options, SmoothError, Smoother};
        use std::ops::ControlFlow;

        let gpu = Gpu::open(None).block().unwrap();
        let opened = Gpu::new(gpu.device().clone(), gpu.queue().clone()).unwrap();
        opened.arithmetic.set(Some("digits are lost")).unwrap();
        let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.4]];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = Mesh { points, triangles, ..Mesh::default() };
        let smoother = Smoother::new(&mesh).unwrap();
        let observe = &mut |_: &_| ControlFlow::Continue(());
        let backend = Backend::Gpu(opened);
        let error =
            smoother.run(&Options::default()).on(&backend).observe(observe).block().unwrap_err();
        assert!(matches!(error, SmoothError::Gpu(GpuError::Arithmetic { .. })), "{error}");
    }
}
