//! Rust mirrors of the WGSL structs. Tests compare their offsets with naga's.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use crate::metric::{Metric, Smoothing};

/// Number of evaluations that the device stores. The host reads them before they are overwritten.
pub(crate) const HISTORY: u32 = 256;
/// Number of invocations in a workgroup of most kernels. Exceptions are `finish`, `find_share`, `sum_along_correction`,
/// `sum_secants`, `publish`, and those that need only one invocation: `reopen`, `resume`, `regularize`, `begin_search`
/// and `judge_trial`.
pub(crate) const WORKGROUP: u32 = 64;
/// Number of invocations in a workgroup of `finish`, `find_share`, `sum_along_correction` and `sum_secants`.
pub(crate) const FINISH_WORKGROUP: u32 = 256;

/// Number of values stored for an evaluation: the sum of q² - ideal² for every metric, the number of inverted
/// triangles, and the largest imr² - 1.
pub(crate) const SLOTS: usize = Metric::ALL.len() + 2;
/// The slot of the number of inverted triangles.
pub(crate) const INVERTED: u32 = Metric::ALL.len() as u32;
/// The slot of the largest imr² - 1.
pub(crate) const WORST: u32 = INVERTED + 1;
/// The bits of the least float that is neither zero nor denormal.
pub(crate) const LEAST_NORMAL: u32 = 0x0080_0000;
/// The bit that is set in the ring start of a free vertex that the application holds in place. Ring starts themselves
/// are smaller.
pub(crate) const HELD: u32 = 1 << 31;
/// The shape guard of steps without one: larger than any inverse mean ratio, and finite in single precision.
pub(crate) const NO_GUARD: f64 = 1e38;

/// Number of lengths tried along each correction that an application encodes.
pub(crate) const SEARCH_TRIALS: u32 = 3;
/// Number of entries in front of the partial sums in the vectors of the levels: the totals, and the state of a line
/// search on the device, as in shaders/search/places.wgsl.
pub(crate) const SEARCH_STATE: u32 = 7;

/// `Params` in shaders/params.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Params {
    pub(crate) zero: u32,
    pub(crate) triangles: u32,
    pub(crate) partials: u32,
    pub(crate) inner: u32,
    pub(crate) base: u32,
    pub(crate) window: u32,
    pub(crate) max_sweeps: u32,
    pub(crate) has_target: u32,
    pub(crate) target_sum: [f32; 2],
    pub(crate) ideal_sum: f32,
    pub(crate) tolerance: f32,
    pub(crate) mean_area: [f32; 2],
    pub(crate) targets: u32,
    pub(crate) padding: u32,
}

/// `Part` in shaders/common.wgsl.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Part {
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) omega: f32,
    pub(crate) sharpness: u32,
    pub(crate) shape_guard: f32,
    pub(crate) ring_base: u32,
    pub(crate) longest: f32,
    pub(crate) over_guard: f32,
}

/// `LevelOp` in shaders/levels/common.wgsl.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LevelOp {
    pub(crate) rows: u32,
    pub(crate) first: u32,
    pub(crate) free: u32,
    pub(crate) ring_base: u32,
    pub(crate) starts: u32,
    pub(crate) columns: u32,
    pub(crate) entries: u32,
    pub(crate) diagonal: u32,
    pub(crate) x: u32,
    pub(crate) right: u32,
    pub(crate) step: u32,
    pub(crate) out: u32,
    pub(crate) a: f32,
    pub(crate) b: f32,
    pub(crate) shape_guard: f32,
    pub(crate) sharpness: u32,
}

impl LevelOp {
    /// The same by a metric that is made smooth so.
    pub(crate) fn smoothed(self, smoothing: Smoothing) -> Self {
        let Smoothing { sharpness, penalized } = smoothing;
        Self { sharpness, b: penalized.recip() as f32, ..self }
    }
}

/// `SecantOp` in shaders/secants/common.wgsl.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SecantOp {
    pub(crate) free: u32,
    pub(crate) newer: u32,
    pub(crate) older: u32,
    pub(crate) pairs: u32,
    pub(crate) partials: u32,
    pub(crate) is_after: u32,
    pub(crate) padding: [u32; 2],
}

/// `Control` in shaders/control.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Control {
    pub(crate) done: u32,
    pub(crate) evaluated: u32,
    pub(crate) improved: u32,
    pub(crate) best_sweep: u32,
    pub(crate) best_sum: [f32; 2],
    pub(crate) changes: u32,
    pub(crate) padding: u32,
    pub(crate) history: [[[f32; 2]; SLOTS]; HISTORY as usize],
}

/// `Exchange` in shaders/exchange.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Exchange {
    pub(crate) zero: u32,
    pub(crate) vertices: u32,
    pub(crate) offset: u32,
    pub(crate) stride: u32,
    pub(crate) center: [f32; 4],
    pub(crate) scale: f32,
    pub(crate) inverse_scale: f32,
    pub(crate) padding: [u32; 2],
}

/// `Restore` in shaders/restore.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Restore {
    pub(crate) zero: u32,
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) padding: u32,
}

/// `Mask` in shaders/mask.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Mask {
    pub(crate) vertices: u32,
    pub(crate) offset: u32,
    pub(crate) padding: [u32; 2],
}

/// `Movement` in shaders/clamp/common.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Movement {
    pub(crate) zero: u32,
    pub(crate) vertices: u32,
    pub(crate) triangles: u32,
    pub(crate) worst_imr: f32,
    pub(crate) offset: u32,
    pub(crate) stride: u32,
    pub(crate) share: u32,
    pub(crate) scale: f32,
    pub(crate) center: [f32; 4],
}

/// `UntanglePart` in shaders/untangle/common.wgsl.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct UntanglePart {
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) ring_base: u32,
    pub(crate) free: u32,
    pub(crate) begins: u32,
    pub(crate) padding: [u32; 3],
}

/// `Tangle` in shaders/untangle/common.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Tangle {
    pub(crate) valid: u32,
    pub(crate) inverted: u32,
    pub(crate) depth: u32,
    pub(crate) epsilon: f32,
    pub(crate) sweep: u32,
    pub(crate) since: u32,
}

/// `TangledVertex` in shaders/untangle/common.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct TangledVertex {
    pub(crate) area: f32,
    pub(crate) reached: u32,
}

/// `Publish` in shaders/publish.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Publish {
    pub(crate) offset: u32,
    pub(crate) triangles: u32,
    pub(crate) judged: u32,
    pub(crate) padding: u32,
    pub(crate) ideal_squared: [[f32; 4]; SLOTS.div_ceil(4)],
}

/// `ArithmeticInput` in shaders/check_arithmetic.wgsl: two positions as pairs of floats.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ArithmeticInput {
    pub(crate) a: [f32; 4],
    pub(crate) b: [f32; 4],
}

/// `ArithmeticResult` in shaders/check_arithmetic.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ArithmeticResult {
    pub(crate) two_sum: [f32; 2],
    pub(crate) pair_add: [f32; 2],
    pub(crate) edge: [f32; 2],
    pub(crate) difference: f32,
    pub(crate) is_positive: f32,
    pub(crate) advanced: [f32; 4],
}

/// A double as the sum of two floats.
pub(crate) fn pair(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

/// The value of a pair of floats.
pub(crate) fn unpair([high, low]: [f32; 2]) -> f64 {
    f64::from(high) + f64::from(low)
}

/// A point as pairs of floats, laid out xy + zw.
pub(crate) fn split(p: DVec2) -> [f32; 4] {
    let ([x, x_low], [y, y_low]) = (pair(p.x), pair(p.y));
    [x, y, x_low, y_low]
}

/// The point that pairs of floats represent: the inverse of [`split`].
pub(crate) fn join([x, y, x_low, y_low]: [f32; 4]) -> DVec2 {
    DVec2::new(unpair([x, x_low]), unpair([y, y_low]))
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;
    use crate::gpu::Kernel;

    /// Returns the size of a struct as naga lays it out, and the name and offset of each member except padding.
    fn reflected(kernel: &Kernel, name: &str) -> (usize, Vec<(String, usize)>) {
        let module = naga::front::wgsl::parse_str(&kernel.wgsl()).unwrap();
        let (_, ty) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap();
        let naga::TypeInner::Struct { members, span } = &ty.inner else {
            panic!("{name} is no struct");
        };
        let named = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize));
        (*span as usize, named.filter(|(name, _)| name != "padding").collect())
    }

    macro_rules! mirrors {
        ($kernel:expr, $mirror:ident { $($field:ident),* $(,)? }) => {
            let offsets = vec![$((stringify!($field).to_owned(), offset_of!($mirror, $field))),*];
            let expected = (size_of::<$mirror>(), offsets);
            assert_eq!(reflected($kernel, stringify!($mirror)), expected);
        };
    }

    #[test]
    fn structs_are_laid_out_as_in_wgsl() {
        let run = &Kernel::KeepBest;
        mirrors!(
            run,
            Params {
                zero,
                triangles,
                partials,
                inner,
                base,
                window,
                max_sweeps,
                has_target,
                target_sum,
                ideal_sum,
                tolerance,
                mean_area,
                targets,
            }
        );
        mirrors!(
            run,
            Part { first, count, omega, sharpness, shape_guard, ring_base, longest, over_guard }
        );
        mirrors!(
            &Kernel::MatrixVector,
            LevelOp {
                rows,
                first,
                free,
                ring_base,
                starts,
                columns,
                entries,
                diagonal,
                x,
                right,
                step,
                out,
                a,
                b,
                shape_guard,
                sharpness
            }
        );
        let secants = &Kernel::OpenSecant;
        mirrors!(secants, SecantOp { free, newer, older, pairs, partials, is_after });
        for kernel in [run, &Kernel::Publish, &Kernel::Reopen] {
            mirrors!(
                kernel,
                Control { done, evaluated, improved, best_sweep, best_sum, changes, history }
            );
        }
        mirrors!(
            &Kernel::Import,
            Exchange { zero, vertices, offset, stride, center, scale, inverse_scale }
        );
        mirrors!(&Kernel::RestoreLastValid, Restore { zero, first, count });
        mirrors!(&Kernel::HoldByMask, Mask { vertices, offset });
        mirrors!(
            &Kernel::FindShare,
            Movement { zero, vertices, triangles, worst_imr, offset, stride, share, scale, center }
        );
        let check = &Kernel::CheckArithmetic;
        mirrors!(check, ArithmeticInput { a, b });
        mirrors!(
            check,
            ArithmeticResult { two_sum, pair_add, edge, difference, is_positive, advanced }
        );
        let untangle = &Kernel::Untangle;
        mirrors!(untangle, UntanglePart { first, count, ring_base, free, begins });
        mirrors!(untangle, Tangle { valid, inverted, depth, epsilon, sweep, since });
        mirrors!(untangle, TangledVertex { area, reached });
        mirrors!(&Kernel::Publish, Publish { offset, triangles, judged, ideal_squared });
    }

    #[test]
    fn a_uniform_holds_only_what_16_byte_rows_allow() {
        // In a uniform an array's elements must be multiples of 16 bytes apart.
        assert_eq!(offset_of!(Publish, ideal_squared) % 16, 0);
        assert!(size_of::<Part>() <= 256, "within the least dynamic offset alignment");
    }

    #[test]
    fn pairs_of_floats_keep_48_bits() {
        for x in [1.0, -std::f64::consts::PI, 1e-3, 4_000_000.123_456_789, -1.0 / 3.0] {
            let [high, low] = pair(x);
            assert_eq!(high, x as f32);
            assert!((unpair([high, low]) - x).abs() <= x.abs() * 2f64.powi(-48), "{x}");
        }
    }
}
