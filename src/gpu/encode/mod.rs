//! Encodes kernels into one pass, or each kernel into a timed pass.

mod passes;
mod timestamps;

pub use passes::{Encoder, Timed};
pub(crate) use passes::{Passes, sealed};
pub use timestamps::{Span, Spans, Timestamps};
