//! The choice of instructions: code in lanes is compiled for several instruction sets, and the best that the processor has is run.

use fearless_simd::Level;

/// The vector instructions for which code is compiled: AVX2 on x86, Neon on 64-bit ARM, and `simd128` in WebAssembly.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
type Vectors = fearless_simd::Avx2;
#[cfg(target_arch = "aarch64")]
type Vectors = fearless_simd::Neon;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
type Vectors = fearless_simd::WasmSimd128;
#[cfg(not(any(
    target_arch = "x86",
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128")
)))]
type Vectors = fearless_simd::Fallback;

/// The vector instructions of older processors, for which one copy of the code is compiled: SSE4.2 on x86.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
type OlderVectors = fearless_simd::Sse4_2;
#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
type OlderVectors = fearless_simd::Fallback;

/// Whether code is compiled for [`Vectors`].
pub(crate) const HAS_VECTORS: bool = cfg!(any(
    target_arch = "x86",
    target_arch = "x86_64",
    target_arch = "aarch64",
    target_feature = "simd128"
));

/// Whether code is compiled for [`OlderVectors`].
pub(crate) const HAS_OLDER_VECTORS: bool = cfg!(any(target_arch = "x86", target_arch = "x86_64"));

/// Returns the vector instructions of this processor. `None` on a processor without them, and on threads of a test that leaves
/// them out.
#[inline(always)]
pub(crate) fn vectors() -> Option<Vectors> {
    #[cfg(test)]
    if LEFT_OUT.get() > 0 {
        return None;
    }
    let level = Level::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    return level.as_avx2();
    #[cfg(target_arch = "aarch64")]
    return level.as_neon();
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    return level.as_wasm_simd128();
    #[allow(unreachable_code)]
    {
        let _ = level;
        None
    }
}

/// Returns the vector instructions of this processor if it is older. `None` on a processor without them.
#[inline(always)]
pub(crate) fn older_vectors() -> Option<OlderVectors> {
    #[cfg(test)]
    if LEFT_OUT.get() > 1 {
        return None;
    }
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    return Level::new().as_sse4_2();
    #[allow(unreachable_code)]
    None
}

/// Evaluates an expression with `$f` bound to the formulas of a metric, `$width` to the [`Width`](crate::patch::lanes::Width) of this processor, and the constant
/// `$general` to whether the copy of the code serves target maps and bounds.
///
/// Each copy of a sweep takes seconds to compile. So only usual cases have a copy of their own, with vector instructions: each usual
/// metric on meshes without targets and bounds, and on x86 soft-size on meshes with targets, where its copy takes half the time of the
/// copy for all metrics. The copy for all metrics serves all other cases. It looks up the metric for each triangle, which costs imr
/// nothing measurable, and gives meshes without targets identity maps.
macro_rules! with_lanes {
    ($maps:expr, $bounded:expr, $metric:expr, $width:ident, $f:ident, $general:ident => $body:expr) => {
        'done: {
            if $crate::patch::instructions::HAS_VECTORS
                && let (Some($width), None, false) =
                    ($crate::patch::instructions::vectors(), $maps, $bounded)
            {
                #[allow(dead_code)]
                const $general: bool = false;
                $crate::metric::with_each_metric!($metric, $f => break 'done (
                    $crate::patch::lanes::Width::compiled(
                        $width,
                        #[inline(always)]
                        || $body,
                    )
                ))
            }
            const $general: bool = true;
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            if let (Some($width), Some(_), $crate::metric::Metric::SoftSize) =
                ($crate::patch::instructions::vectors(), $maps, $metric)
            {
                #[allow(non_upper_case_globals)]
                const $f: $crate::metric::OfInvariants = $crate::metric::OfInvariants::SoftSize;
                break 'done $crate::patch::lanes::Width::compiled(
                    $width,
                    #[inline(always)]
                    || $body,
                );
            }
            let $f = $metric.formulas();
            $crate::patch::instructions::with_instructions!($width => $body)
        }
    };
}
pub(crate) use with_lanes;

/// Evaluates an expression with `$width` bound to the vector instructions of this processor, or to those of older processors. On a
/// processor without either, evaluates the expression `$alone`, or the same expression with `$width` bound to [`Alone`].
///
/// [`Alone`]: crate::patch::lanes::Alone
macro_rules! with_instructions {
    ($width:ident => $body:expr, alone => $alone:expr) => {
        // The first conditions are decided at compile time, so code for vectors that a target lacks is left out.
        if $crate::patch::instructions::HAS_VECTORS
            && let Some($width) = $crate::patch::instructions::vectors()
        {
            $crate::patch::lanes::Width::compiled(
                $width,
                #[inline(always)]
                || $body,
            )
        } else if $crate::patch::instructions::HAS_OLDER_VECTORS
            && let Some($width) = $crate::patch::instructions::older_vectors()
        {
            $crate::patch::lanes::Width::compiled(
                $width,
                #[inline(always)]
                || $body,
            )
        } else {
            $alone
        }
    };
    ($width:ident => $body:expr) => {
        $crate::patch::instructions::with_instructions!($width => $body, alone => {
            let $width = $crate::patch::lanes::Alone;
            $body
        })
    };
}
pub(crate) use with_instructions;

#[cfg(test)]
thread_local! {
    /// How many kinds of vector instructions are left out, the newest first.
    static LEFT_OUT: std::cell::Cell<u32> = const { std::cell::Cell::new(0) };
}

/// Calls a function three times, on threads of its own: with the vector instructions of this processor, with those of older
/// processors, and without. Without optimization, runs in lanes take more stack than threads usually have.
#[cfg(test)]
pub(crate) fn with_each_width<R: Send>(of: impl Fn() -> R + Send + Sync) -> [R; 3] {
    [0, 1, 2].map(|left_out| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .stack_size(1 << 26)
            .start_handler(move |_| LEFT_OUT.set(left_out))
            .build();
        pool.unwrap().install(&of)
    })
}
