//! Arrays of bits and of texts, which both formats of VTK may have among their data.

use crate::text::token::quoted;

/// Returns the first `count` bits of packed bits as numbers. The first bit of a byte is the most significant one. `None`
/// if there are fewer bits.
pub(crate) fn bits(bytes: &[u8], count: u64) -> Option<Vec<f64>> {
    let count = usize::try_from(count).ok().filter(|count| count.div_ceil(8) <= bytes.len())?;
    let bit = |index: usize| f64::from(bytes[index / 8] >> (7 - index % 8) & 1);
    Some((0..count).map(bit).collect())
}

/// Returns the words for a lost array of texts. `owners` are the vertices or elements whose texts they are.
pub(crate) fn lost_text(owners: &str, name: &[u8]) -> String {
    format!("data of {owners} that are text: {}", quoted(name))
}
