//! Encodes kernels: all in one pass, or each in a pass that is timed.

mod passes;
mod timestamps;

pub use passes::{Encoder, Timed};
pub(crate) use passes::{Passes, sealed};
pub use timestamps::{Span, Spans, Timestamps};
