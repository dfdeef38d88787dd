//! Command encoders: kernels in one pass, or timed in a pass each.

mod passes;
mod timestamps;

pub use passes::{Encoder, Timed};
pub(crate) use passes::{Passes, sealed};
pub use timestamps::{Span, Spans, Timestamps};
