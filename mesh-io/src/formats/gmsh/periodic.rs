//! Pairs of periodic nodes, from the section `$Periodic`.

use super::encoding::{FileEncoding, Version};
use crate::binary::byte_order::ByteOrder;
use crate::content::constraints::Affine;
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::text::token::{float, integer};
use crate::visit::items::PeriodicNodes;

/// Number of entries of an affine motion: a 4 × 4 matrix, row by row.
const AFFINE: usize = 16;

/// Reads a section after its first line. The cursor does not move. `None` if the section differs from gmsh's own
/// layout, as the mesh does not depend on periodic pairs.
pub(super) fn read(
    cursor: &Cursor<'_>,
    FileEncoding { version, order }: FileEncoding,
) -> Option<Vec<PeriodicNodes>> {
    let cursor = &mut cursor.clone();
    let found = match (version, order) {
        // Binary files of version 2.2 have this section as text, too.
        (Version::V2, _) | (_, None) => text(cursor, version)?,
        (_, Some(order)) => binary(cursor, version, order)?,
    };
    let is_end = cursor.next_row() && cursor.token() == Some(b"$EndPeriodic");
    is_end.then_some(found)
}

/// Returns the part of an affine motion in the plane of x and y. `None` if the matrix does not have 16 entries.
fn in_plane(numbers: &[f64]) -> Option<Affine> {
    let all: &[f64; AFFINE] = numbers.try_into().ok()?;
    Some([[all[0], all[1], all[3]], [all[4], all[5], all[7]]])
}

/// Combines pairs of nodes with their entities and their motion; `None` without pairs.
fn pairs(
    entities: (u8, [i64; 2]),
    motion: Option<Affine>,
    nodes: Vec<[u64; 2]>,
) -> Option<PeriodicNodes> {
    let entities = Some(entities);
    (!nodes.is_empty()).then_some(PeriodicNodes { entities, motion, nodes })
}

/// Returns the matrix in space of a motion of the plane, row by row.
pub(super) fn matrix([[a, b, x], [c, d, y]]: Affine) -> [f64; AFFINE] {
    [a, b, 0.0, x, c, d, 0.0, y, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
}

fn text(cursor: &mut Cursor<'_>, version: Version) -> Option<Vec<PeriodicNodes>> {
    fn number(cursor: &mut Cursor<'_>) -> Option<u64> {
        integer(cursor.token()?)
    }
    cursor.next_row().then_some(())?;
    let links = number(cursor)?;
    let mut found = Vec::new();
    for _ in 0..links {
        // The row has the dimension and the tags of both entities.
        (cursor.next_row() && !cursor.is_at(b'$')).then_some(())?;
        let dimension = u8::try_from(number(cursor)?).ok()?;
        let mut tag = || str::from_utf8(cursor.token()?).ok()?.parse().ok();
        let entities = (dimension, [tag()?, tag()?]);
        cursor.next_row().then_some(())?;
        let first = cursor.token()?;
        // In 4.1, a row has the entry count of the motion and the entries. In earlier versions, the row starts with
        // `Affine` or is missing.
        let has_row = version == Version::V41 || first == b"Affine";
        let mut numbers = Vec::new();
        if has_row {
            while let Some(token) = cursor.token() {
                numbers.push(float(token)?);
            }
            cursor.next_row().then_some(())?;
        }
        let count = if has_row { number(cursor)? } else { integer(first)? };
        let mut nodes = Vec::with_capacity(cursor.capacity(count, "1 2\n".len()));
        for _ in 0..count {
            (cursor.next_row() && !cursor.is_at(b'$')).then_some(())?;
            let (image, of) = (number(cursor)?, number(cursor)?);
            nodes.push([of, image]);
        }
        found.extend(pairs(entities, in_plane(&numbers), nodes));
    }
    Some(found)
}

/// Takes `count` items of `size` bytes from the file; `None` if the file ends first.
fn take<'a>(cursor: &mut Cursor<'a>, count: u64, size: usize) -> Option<&'a [u8]> {
    cursor.take(usize::try_from(count).ok()?.checked_mul(size)?)
}

fn binary(
    cursor: &mut Cursor<'_>,
    version: Version,
    order: ByteOrder,
) -> Option<Vec<PeriodicNodes>> {
    let is_40 = version == Version::V40;
    let size = |cursor: &mut Cursor<'_>| Some(order.whole(cursor.take(8)?));
    let links = match is_40 {
        true => order.whole(cursor.take(4)?),
        false => size(cursor)?,
    };
    let mut found = Vec::new();
    for _ in 0..links {
        let ints = take(cursor, 3, 4)?;
        let int = |at: usize| order.signed(&ints[4 * at..4 * at + 4]);
        let entities = (u8::try_from(int(0)).ok()?, [int(1), int(2)]);
        let mut count = size(cursor)?;
        let mut numbers = Vec::new();
        // In 4.1, `count` is the entry count of the motion. In 4.0, a negative `count` announces a motion of 16
        // entries.
        if !is_40 || count > i64::MAX as u64 {
            let has = if is_40 { AFFINE as u64 } else { count };
            let real = |bytes: &[u8]| order.real(Precision::Double, bytes);
            numbers = take(cursor, has, 8)?.chunks_exact(8).map(real).collect();
            count = size(cursor)?;
        }
        let width = if is_40 { 4 } else { 8 };
        let nodes = take(cursor, count, 2 * width)?.chunks_exact(2 * width);
        let pair = |bytes: &[u8]| {
            let (image, of) = bytes.split_at(width);
            [order.whole(of), order.whole(image)]
        };
        found.extend(pairs(entities, in_plane(&numbers), nodes.map(pair).collect()));
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disk::source::Source;

    fn read_as(
        version: Version,
        order: Option<ByteOrder>,
        bytes: &[u8],
    ) -> Option<Vec<PeriodicNodes>> {
        let source = Source::new("m.msh".as_ref(), bytes.to_vec()).unwrap();
        let mut cursor = Cursor::new(&source);
        assert!(cursor.next_row());
        read(&cursor, FileEncoding { version, order })
    }

    /// Version 4.0 in binary has narrower integers than 4.1, and announces a motion by a negative count.
    #[test]
    fn binary_of_version_4_0_is_read_in_both_byte_orders() {
        for order in [ByteOrder::Little, ByteOrder::Big] {
            let turned = |mut bytes: Vec<u8>| {
                if order == ByteOrder::Big {
                    bytes.reverse();
                }
                bytes
            };
            let int = |x: i32| turned(x.to_le_bytes().to_vec());
            let long = |x: i64| turned(x.to_le_bytes().to_vec());
            let mut file = b"$Periodic\n".to_vec();
            file.extend([2, 1, 2, 4].map(int).concat());
            file.extend(long(-16));
            let numbers = (0..16).map(f64::from).map(|x| turned(x.to_le_bytes().to_vec()));
            file.extend(numbers.flatten());
            file.extend(long(2));
            file.extend([9, 1, 18, 10].map(int).concat());
            file.extend([1, 3, 5].map(int).concat());
            file.extend(long(1));
            file.extend([7, 8].map(int).concat());
            let cut = file.clone();
            file.extend(b"\n$EndPeriodic\n");
            let found = read_as(Version::V40, Some(order), &file).unwrap();
            let motion = Some([[0.0, 1.0, 3.0], [4.0, 5.0, 7.0]]);
            let entities = Some((1, [2, 4]));
            assert_eq!(found[0], PeriodicNodes { entities, motion, nodes: vec![[1, 9], [10, 18]] });
            let entities = Some((1, [3, 5]));
            assert_eq!(found[1], PeriodicNodes { entities, motion: None, nodes: vec![[8, 7]] });
            for length in 10..cut.len() {
                assert_eq!(read_as(Version::V40, Some(order), &cut[..length]), None);
            }
        }
    }

    #[test]
    fn text_that_is_not_of_pairs_is_not_read() {
        let whole = "$Periodic\n1\n1 2 4\n2\n9 1\n18 10\n$EndPeriodic\n";
        let entities = Some((1, [2, 4]));
        let pairs = vec![PeriodicNodes { entities, motion: None, nodes: vec![[1, 9], [10, 18]] }];
        assert_eq!(read_as(Version::V2, None, whole.as_bytes()), Some(pairs));
        for (part, other) in [
            ("1\n1 2", "x\n1 2"),
            ("4\n2\n", "4\n3\n"),
            ("4\n2\n", "4\n1\n"),
            ("18 10", "18"),
            ("18 10", "18 -1"),
            ("1\n1 2 4", "99999999999999999\n1 2 4"),
            ("4\n2\n", "4\n99999999999999999\n"),
            ("$End", "$"),
        ] {
            let spoiled = whole.replacen(part, other, 1);
            assert_eq!(read_as(Version::V2, None, spoiled.as_bytes()), None, "{other}");
        }
    }
}
