//! Reads a long list on all threads, as far as its rows are plain.
//!
//! It stops before the first row that is not: one that is damaged or has a number that is not expected. A reader that
//! takes row after row goes on from there, and is the only one that returns errors.

use crate::error::ReadError;
use crate::file::text::Cursor;
use crate::parallel::map_parts;

/// How many bytes of text one thread reads at a time.
const CHUNK: usize = 1 << 17;
/// Lists with fewer rows are read as fast on one thread.
const LONG: u64 = 1 << 14;

/// Reads rows by `read`, each on a cursor that stands at its first token, and hands them to `take` in their order,
/// until one cannot be read, `take` refuses one, or `count` are taken. Returns how many were.
///
/// The next row of the cursor is then the first one not taken. After all `count` it stands on the last one taken.
pub(crate) fn take_rows<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    count: u64,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError> + Sync,
    take: impl FnMut(T) -> bool,
) -> u64 {
    if count < LONG {
        return 0;
    }
    take_chunks(cursor, count, CHUNK, read, take)
}

fn take_chunks<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    count: u64,
    size: usize,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError> + Sync,
    mut take: impl FnMut(T) -> bool,
) -> u64 {
    let mut buffers: Vec<Vec<T>> = Vec::new();
    buffers.resize_with(4 * rayon::current_num_threads(), Vec::new);
    let mut done = 0;
    while done < count {
        let left = count - done;
        let mut parts = cursor.parts(size, buffers.len());
        if parts.is_empty() {
            break;
        }
        let each = parts.iter_mut().zip(&mut buffers);
        let damaged = map_parts(each, |_, (part, rows)| {
            rows.clear();
            while (rows.len() as u64) < left && part.next_row() {
                match read(part) {
                    Ok(row) => rows.push(row),
                    Err(_) => return true,
                }
            }
            false
        });
        for ((part, rows), damaged) in parts.iter().zip(&mut buffers).zip(damaged) {
            let found = rows.len();
            let mut taken = 0;
            for row in rows.drain(..) {
                if done == count || !take(row) {
                    break;
                }
                taken += 1;
                done += 1;
            }
            if done == count || taken < found || damaged {
                for _ in 0..taken {
                    cursor.next_row();
                }
                return done;
            }
            cursor.skip(part);
        }
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Location;
    use crate::file::source::Source;

    /// Rows taken; the line that the cursor then stands on, if all were taken; line and tokens of the rows that follow.
    type Seen = (Vec<(u64, u64)>, Option<Location>, Vec<(Location, Vec<u8>)>);

    fn seen(source: &Source, count: u64, size: Option<usize>) -> Seen {
        let read = |cursor: &mut Cursor<'_>| Ok((cursor.integer("a")?, cursor.integer("b")?));
        let mut rows = Vec::new();
        // As a reader refuses a number that is not consecutive.
        let mut take = |row: (u64, u64)| {
            let takes = row.0 != 13;
            if takes {
                rows.push(row);
            }
            takes
        };
        let cursor = &mut Cursor::new(source);
        cursor.next_row();
        match size {
            Some(size) => {
                let done = take_chunks(cursor, count, size, read, &mut take);
                assert_eq!(done, rows.len() as u64);
            }
            // Row after row, another cursor one row ahead, so that this one stands on the last row taken.
            None => {
                let mut ahead = Cursor::new(source);
                ahead.next_row();
                for _ in 0..count {
                    if !ahead.next_row() || !read(&mut ahead).is_ok_and(&mut take) {
                        break;
                    }
                    cursor.next_row();
                }
            }
        }
        let line = (rows.len() as u64 == count).then(|| cursor.location());
        let mut rest = Vec::new();
        while cursor.next_row() {
            let line = cursor.location();
            rest.push((line, std::iter::from_fn(|| cursor.token()).flatten().copied().collect()));
        }
        rest.push((cursor.location(), Vec::new()));
        (rows, line, rest)
    }

    #[test]
    fn chunks_give_what_row_after_row_gives() {
        let mut state = 1_u64;
        let mut random = move |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) % below
        };
        let (mut stopped, mut whole) = (0, 0);
        for _ in 0..3000 {
            let mut text = b"# head\n8 2\n".to_vec();
            let end: &[u8] = if random(2) == 0 { b"\n" } else { b"\r\n" };
            for _ in 0..random(40) {
                match random(60) {
                    0..=5 => {}
                    6..=9 => text.extend_from_slice(b"# 1 2"),
                    10 => text.extend_from_slice(b"$End"),
                    11 => text.extend_from_slice(b"1"),
                    12 => text.extend_from_slice(b"\t 2 x"),
                    13..=18 => text.extend_from_slice(b"  3 4 # 5"),
                    n => text.extend_from_slice(format!("{n} {}", random(1000)).as_bytes()),
                }
                text.extend_from_slice(end);
            }
            if random(3) == 0 {
                text.truncate(text.len() - random(4).min(text.len() as u64 - 11) as usize);
            }
            let source = Source { path: "m.txt".into(), bytes: text, packed: None, welds: false };
            for count in [0, 1, random(40), 40] {
                let plain = seen(&source, count, None);
                for size in [1, 7, 40, 1 << 10] {
                    let text = String::from_utf8_lossy(&source.bytes);
                    assert_eq!(
                        seen(&source, count, Some(size)),
                        plain,
                        "{count} by {size} of {text:?}"
                    );
                }
                *if plain.2.len() == 1 { &mut whole } else { &mut stopped } += 1;
            }
        }
        assert!(whole > 500 && stopped > 500, "{whole} whole lists, {stopped} stopped");
    }
}
