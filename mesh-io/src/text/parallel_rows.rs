//! Parallel reading of the rows of a long list, up to the first unusual row.
//!
//! Parallel reading stops before the first row with damage or an unexpected number. The reader continues row by row
//! from the stopping point, and alone returns errors.

use crate::error::ReadError;
use crate::parallel::{map_parts, run_both};
use crate::text::cursor::Cursor;

/// Bytes of text that one thread reads at a time.
const CHUNK_BYTES: usize = 1 << 17;
/// Smallest number of rows that are read on several threads. Shorter lists are read as fast on one thread.
const MIN_PARALLEL_ROWS: u64 = 1 << 14;

/// Parses up to `count` rows by `read`, which gets a cursor at the first token of a row, and passes the rows to `take`
/// in file order. Stops at the first row that `read` cannot parse or `take` refuses. Returns the number of rows taken,
/// 0 for lists below [`MIN_PARALLEL_ROWS`].
///
/// Afterwards, the cursor's next row is the first row that `take` has not accepted. After all `count` rows, the cursor
/// is on the last row.
pub(crate) fn take_rows<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    count: u64,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError> + Sync,
    take: impl FnMut(T) -> bool,
) -> u64 {
    if count < MIN_PARALLEL_ROWS || !cursor.is_between_rows() {
        return 0;
    }
    take_chunks(cursor, count, CHUNK_BYTES, read, take)
}

fn take_chunks<'a, T: Send>(
    cursor: &mut Cursor<'a>,
    count: u64,
    size: usize,
    read: impl Fn(&mut Cursor<'a>) -> Result<T, ReadError> + Sync,
    mut take: impl FnMut(T) -> bool,
) -> u64 {
    // No other thread has work while the last batch is taken, so batches are small.
    let at_once = 2 * rayon::current_num_threads();
    let mut batch = Batch::new(cursor.parts(size, at_once), Vec::new());
    let mut spare = Vec::new();
    batch.read(count, &read);
    let mut done = 0;
    while done < count && !batch.parts.is_empty() {
        // While this thread takes rows, other threads parse the next batch.
        let found: u64 = batch.rows.iter().map(|rows| rows.len() as u64).sum();
        let parts = match done + found < count {
            true => cursor.parts_after(batch.parts.last(), size, at_once),
            false => Vec::new(),
        };
        let mut next = Batch::new(parts, std::mem::take(&mut spare));
        let mut is_plain = true;
        run_both(&mut || next.read(count, &read), &mut || {
            is_plain = batch.take(cursor, count, &mut done, &mut take);
        });
        if !is_plain {
            break;
        }
        spare = std::mem::replace(&mut batch, next).rows;
    }
    done
}

/// Consecutive parts of a list, each with its parsed rows.
struct Batch<'a, T> {
    parts: Vec<Cursor<'a>>,
    rows: Vec<Vec<T>>,
    /// Whether an unreadable row follows the parsed rows, for each part.
    damaged: Vec<bool>,
}

impl<'a, T: Send> Batch<'a, T> {
    /// Makes a batch without rows. `rows` are empty lists, whose memory is reused.
    fn new(parts: Vec<Cursor<'a>>, mut rows: Vec<Vec<T>>) -> Batch<'a, T> {
        rows.resize_with(parts.len(), Vec::new);
        Batch { parts, rows, damaged: Vec::new() }
    }

    /// Parses up to `most` rows of each part, using all threads.
    fn read(
        &mut self,
        most: u64,
        read: &(impl Fn(&mut Cursor<'a>) -> Result<T, ReadError> + Sync),
    ) {
        let each = self.parts.iter_mut().zip(&mut self.rows);
        self.damaged = map_parts(each, |_, (part, rows)| {
            while (rows.len() as u64) < most && part.next_row() {
                match read(part) {
                    Ok(row) if part.is_between_rows() => rows.push(row),
                    _ => return true,
                }
            }
            false
        });
    }

    /// Passes rows to `take` until `done` reaches `count`, and moves the cursor past accepted rows. Returns false at
    /// the first row not accepted, and when `done` has reached `count`.
    fn take(
        &mut self,
        cursor: &mut Cursor<'a>,
        count: u64,
        done: &mut u64,
        take: &mut impl FnMut(T) -> bool,
    ) -> bool {
        for ((part, rows), &damaged) in self.parts.iter().zip(&mut self.rows).zip(&self.damaged) {
            let found = rows.len();
            let mut taken = 0;
            for row in rows.drain(..) {
                if *done == count || !take(row) {
                    break;
                }
                taken += 1;
                *done += 1;
            }
            if *done == count || taken < found || damaged {
                for _ in 0..taken {
                    cursor.next_row();
                }
                return false;
            }
            cursor.skip(part);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disk::source::Source;
    use crate::error::Location;

    /// The rows taken; the cursor's location, `None` unless all rows were taken; location and tokens of each remaining
    /// row.
    type Seen = (Vec<(u64, u64)>, Option<Location>, Vec<(Location, Vec<u8>)>);

    fn seen(source: &Source, count: u64, size: Option<usize>) -> Seen {
        let read = |cursor: &mut Cursor<'_>| Ok((cursor.integer("a")?, cursor.integer("b")?));
        let mut rows = Vec::new();
        // A reader may refuse a row, such as one whose number is not consecutive.
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
            // The rows are read one by one. Another cursor is a row ahead, so that this one stays on the last row
            // taken.
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
            let source = Source::new("m.txt".as_ref(), text).expect("it is not compressed");
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
