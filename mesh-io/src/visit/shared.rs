//! Bytes of a file that belong to several arrays.

use std::ops::Range;

/// The bytes of an array that are also bytes of other arrays. A rewrite of one array would change the others.
#[derive(Clone, Debug)]
pub(crate) struct SharedBytes {
    /// Range of the array in its file. Arrays with all bytes in common have equal ranges.
    pub(crate) range: Range<usize>,
    /// Number of other arrays that share bytes with this array, directly or over further arrays.
    pub(crate) others: usize,
    /// One of the other arrays in messages, such as `the points` or `'depth'`.
    pub(crate) other: String,
}

/// Returns the shared bytes of each array; `None` for an array that shares none. `ranges` holds the index of the file
/// and the range of each array; `None` for an array without a range. `name` returns the text for an array in messages.
pub(crate) fn shared_bytes(
    ranges: &[Option<(usize, Range<usize>)>],
    name: impl Fn(usize) -> String,
) -> Vec<Option<SharedBytes>> {
    let mut sorted: Vec<(usize, &(usize, Range<usize>))> =
        ranges.iter().enumerate().filter_map(|(array, own)| Some((array, own.as_ref()?))).collect();
    sorted.retain(|(_, (_, range))| !range.is_empty());
    sorted.sort_by_key(|(array, (file, range))| (*file, range.start, *array));
    let mut shared = vec![None; ranges.len()];
    let mut rest = &sorted[..];
    while let Some((_, (file, first))) = rest.first() {
        // The group ends before the first array that starts behind all bytes of the arrays before.
        let (mut end, mut count) = (first.end, 1);
        for (_, (other, range)) in &rest[1..] {
            if other != file || range.start >= end {
                break;
            }
            (end, count) = (end.max(range.end), count + 1);
        }
        let (group, after) = rest.split_at(count);
        if let [(one, _), (two, _), ..] = group {
            for (array, (_, range)) in group {
                let other = name(if array == one { *two } else { *one });
                let (range, others) = (range.clone(), group.len() - 1);
                shared[*array] = Some(SharedBytes { range, others, other });
            }
        }
        rest = after;
    }
    shared
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_with_common_bytes_are_grouped_by_file() {
        let ranges = [
            Some((0, 10..20)),
            Some((1, 10..20)),
            None,
            // Inside of the long array that starts before, and behind a short array.
            Some((0, 30..60)),
            Some((0, 30..40)),
            Some((0, 50..55)),
            Some((0, 60..70)),
            // No bytes.
            Some((0, 15..15)),
            Some((2, 5..6)),
            Some((2, 5..6)),
        ];
        let shared = shared_bytes(&ranges, |array| array.to_string());
        let found: Vec<_> = shared
            .iter()
            .map(|own| own.as_ref().map(|own| (own.range.clone(), own.others, &own.other[..])))
            .collect();
        let (two, three) = (Some((5..6, 1, "9")), |range, other| Some((range, 2, other)));
        let expected = [
            None,
            None,
            None,
            three(30..60, "4"),
            three(30..40, "3"),
            three(50..55, "3"),
            None,
            None,
            two,
            Some((5..6, 1, "8")),
        ];
        assert_eq!(found, expected);
    }
}
