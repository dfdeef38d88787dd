//! Reasons for the choice of a backend.

use std::fmt;

use crate::adapter::AdapterSummary;
use crate::error::GpuError;

/// The reason for which [`Backend::auto`](crate::Backend::auto) chose a backend. Displays as an English phrase.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum BackendReason {
    /// The library was built without its GPU engine, the feature `gpu`.
    OnlyCpu,
    /// The options allow no sweep, so no engine would be faster than another.
    NoSweeps,
    /// The CPU is estimated to finish before a GPU.
    CpuIsFaster {
        /// The GPU that was found. `None` if no driver was started, as the mesh is too small for any GPU to be faster.
        adapter: Option<AdapterSummary>,
        /// Mesh size, in vertices, from which the GPU is estimated to be faster; `None` if the CPU always is.
        pays_from: Option<usize>,
    },
    /// Every adapter is a software driver, and the CPU engine is faster than these.
    OnlySoftware(AdapterSummary),
    /// No GPU was found, its driver failed, or the mesh does not fit the GPU.
    GpuFails(GpuError),
    /// The GPU is estimated to finish before the CPU.
    GpuIsFaster {
        /// Mesh size, in vertices, from which the GPU is estimated to be faster.
        pays_from: usize,
    },
}

impl fmt::Display for BackendReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OnlyCpu => write!(f, "built without the GPU engine"),
            Self::NoSweeps => write!(f, "no sweep is to be made"),
            Self::CpuIsFaster { pays_from: Some(least), adapter: None } => {
                write!(f, "fewer than {} vertices", grouped(*least))
            }
            Self::CpuIsFaster { pays_from: Some(least), adapter: Some(adapter) } => {
                write!(f, "fewer than {} vertices for {}", grouped(*least), adapter.name)
            }
            Self::CpuIsFaster { pays_from: None, adapter } => {
                let gpu = adapter.as_ref().map_or("a GPU", |adapter| &adapter.name);
                write!(f, "so many cores are estimated to be faster than {gpu}")
            }
            Self::OnlySoftware(adapter) => {
                write!(f, "only a software adapter ({})", adapter.name)
            }
            Self::GpuFails(error) => write!(f, "{error}"),
            Self::GpuIsFaster { pays_from } => {
                write!(f, "{} vertices or more", grouped(*pays_from))
            }
        }
    }
}

/// Returns a number in decimal, with commas between groups of three digits.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_in_groups_of_three() {
        assert_eq!(
            [7, 1234, 500_000, 1_200_000].map(grouped),
            ["7", "1,234", "500,000", "1,200,000"]
        );
    }
}
