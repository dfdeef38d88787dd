//! Parallel loops, sorting and futures, shared by several modules.

pub(crate) mod counting_sort;
pub(crate) mod pace;
pub(crate) mod paced;
mod tasks;

use std::pin::Pin;

pub(crate) use tasks::{collect, for_each_chunk, for_each_part, map_parts, map_ranges, ranges};

/// A future of an awaited call. The future is `Send`, except in a browser.
#[cfg(not(target_family = "wasm"))]
pub(crate) type BoxedFuture<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;
#[cfg(target_family = "wasm")]
pub(crate) type BoxedFuture<'a, T> = Pin<Box<dyn Future<Output = T> + 'a>>;
