//! Comparison of two files of a mesh apart from coordinates. Files are written without this code, which can therefore
//! verify them.

use crate::edit::numbers::{CoordinateEncoding, EncodedArrays, NumberEncoding, Offsets};
use crate::error::Location;
use crate::mesh_file::locate::SourceLocation;
use crate::mesh_file::mesh::MeshFile;
use crate::text::token::quoted;
use crate::visit::field::PointField;
use crate::visit::storage::{ArrayLocation, ByteSpace};
use std::ops::Range;

/// First difference between two files of a mesh, apart from coordinates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Location of the difference in the first file, with the id 0.
    pub location: SourceLocation,
    /// Location of the difference in the second file, with the id 0.
    pub other_location: SourceLocation,
    /// A description of the difference.
    pub description: String,
}

impl MeshFile {
    /// Returns the first difference to another file of the mesh, apart from coordinates. `None` if both files have
    /// equal formats, equal triangles, and equal bytes outside of coordinates.
    ///
    /// If the points are encoded, as in a `.vtu`, their decoded bytes are compared instead of the encoded bytes, and
    /// the offsets of later arrays are ignored. In HDF5, a rewrite may move compressed chunks to the end of the file.
    /// Bytes at the old and new places of the chunks, and the addresses of the chunks, are ignored.
    pub fn difference(&self, other: &MeshFile) -> Option<Difference> {
        self.difference_ignoring(other, [&[], &[]])
    }

    /// Returns the first difference to a file of the mesh in another format, or in another encoding. `None` if both files
    /// have equally many vertices, the same triangles and the same quadrilaterals. Coordinates and the order of elements may
    /// differ. Quadrilaterals of four different vertices count, and none if one of the formats
    /// [holds](MeshFile::holds_quadrilaterals) none.
    pub fn difference_of_elements(&self, other: &MeshFile) -> Option<Difference> {
        let [mine, theirs] = [self, other].map(MeshFile::triangles);
        let counts = [self, other].map(|file| file.points().len());
        let holds = [self, other].into_iter().all(MeshFile::holds_quadrilaterals);
        let have_equal_quadrilaterals =
            || !holds || ascending_quadrilaterals(self) == ascending_quadrilaterals(other);
        let description = if counts[0] != counts[1] {
            format!("{} vertices and {}", counts[0], counts[1])
        } else if mine != theirs && ascending(mine) != ascending(theirs) {
            "the triangles are not the same".to_owned()
        } else if have_equal_quadrilaterals() {
            return None;
        } else {
            "the quadrilaterals are not the same".to_owned()
        };
        let [location, other_location] = [self, other].map(|file| SourceLocation {
            path: file.path().to_owned(),
            location: Location::Line(1),
            id: 0,
        });
        Some(Difference { location, other_location, description })
    }

    /// Returns the first difference as [`difference`](Self::difference) does, but also ignores the numbers of `fields`:
    /// fields of this file, and the corresponding fields of the other file.
    pub fn difference_ignoring(
        &self,
        other: &MeshFile,
        fields: [&[PointField]; 2],
    ) -> Option<Difference> {
        let (mine, theirs) = (self.files(), other.files());
        let place = |file: &MeshFile, file_index: usize, at: usize| {
            let source = file.files()[file_index];
            let location = match file.is_text(file_index) {
                true => Location::Line(source.line_of(at)),
                false => Location::Byte(at),
            };
            SourceLocation { path: source.path.clone(), location, id: 0 }
        };
        let differ = |file_index: usize, at: [usize; 2], what: String| {
            let (place, other_place) =
                (place(self, file_index, at[0]), place(other, file_index, at[1]));
            Some(Difference { location: place, other_location: other_place, description: what })
        };
        if self.format() != other.format() {
            let what = format!("the formats are {} and {}", self.format(), other.format());
            return differ(0, [0; 2], what);
        }
        if mine.len() != theirs.len() {
            let what = format!("a mesh of {} files and one of {}", mine.len(), theirs.len());
            return differ(0, [0; 2], what);
        }
        let counts = [self, other].map(|file| file.points().len());
        if counts[0] != counts[1] {
            return differ(0, [0; 2], format!("{} vertices and {}", counts[0], counts[1]));
        }
        if self.triangles() != other.triangles() {
            return differ(0, [0; 2], "the triangles are not the same".into());
        }
        let encoded = [self, other].map(|file| file.encoded_points().map(EncodedArrays::bytes));
        if let [Some(mine), Some(theirs)] = encoded {
            let ranges = [0, 1].map(|side| {
                let (file, bytes) = ([self, other][side], [mine, theirs][side]);
                merged(file.coordinates(), number_ranges(bytes, fields[side], is_beside_points))
            });
            if let Some([at, _]) = unequal([mine, theirs], ranges) {
                let vertex = self.vertex_before(at);
                let [place, other_place] = [self, other].map(|file| file.vertex_location(vertex));
                let what =
                    format!("third coordinates are not the same, first of vertex {}", place.id);
                let unlabeled = |place| SourceLocation { id: 0, ..place };
                let (place, other_place) = (unlabeled(place), unlabeled(other_place));
                return Some(Difference {
                    location: place,
                    other_location: other_place,
                    description: what,
                });
            }
        }
        for (file_index, (mine, theirs)) in mine.iter().zip(&theirs).enumerate() {
            let bytes = [mine, theirs].map(|source| source.bytes.as_slice());
            let mut ranges =
                [0, 1].map(|side| [self, other][side].changeable(file_index, fields[side]));
            if [0, 1]
                .iter()
                .any(|&side| [self, other][side].preserves_offsets(file_index, fields[side]))
            {
                ranges = in_either(bytes, ranges);
            }
            if let Some(at) = unequal(bytes, ranges) {
                let text = |side: usize| match self.is_text(file_index) {
                    _ if at[side] >= bytes[side].len() => "the end of the file".to_owned(),
                    true => {
                        let start = memchr::memrchr(b'\n', &bytes[side][..at[side]]);
                        let start = start.map_or(0, |start| start + 1);
                        format!("`{}`", excerpt(line_at(bytes[side], start), at[side] - start))
                    }
                    false => format!("the byte {}", bytes[side][at[side]]),
                };
                return differ(file_index, at, format!("{} and {}", text(0), text(1)));
            }
        }
        None
    }

    /// Returns the vertex whose x has the largest offset up to `at`, in the bytes with the coordinates.
    fn vertex_before(&self, at: usize) -> u32 {
        let owners = self.offset_vertices();
        let count = owners.map_or(self.points().len(), <[u32]>::len);
        let x_at = self.x_offsets();
        let before = (0..count).filter(|&index| x_at.at(index) <= at);
        let index = before.max_by_key(|&index| x_at.at(index)).unwrap_or(0);
        owners.map_or(index as u32, |owners| owners[index])
    }

    /// Returns the byte ranges of all coordinates, ascending. If the points are encoded, the ranges refer to the
    /// decoded bytes.
    fn coordinates(&self) -> Vec<Range<usize>> {
        let x_at = self.x_offsets();
        // Number of coordinate pairs in the file, repeated vertices included.
        let count = self.offset_vertices().map_or(self.points().len(), <[u32]>::len);
        let mut ranges = Vec::with_capacity(2 * count);
        let places = (0..count).map(|index| x_at.at(index));
        match self.encoding() {
            CoordinateEncoding::Text { .. } | CoordinateEncoding::Fields { .. } => {
                let (bytes, encoding) =
                    (&self.files()[self.file_index()].bytes, NumberEncoding::from(self.encoding()));
                for x in places {
                    let (x_end, _) = encoding.extent(bytes, x);
                    let y = encoding.next(bytes, x_end);
                    ranges.extend([x..x_end, y..encoding.extent(bytes, y).0]);
                }
            }
            CoordinateEncoding::Binary { precision, y_after, .. } => {
                let size = precision.bytes();
                ranges.extend(
                    places.flat_map(|x| {
                        [x, x.saturating_add_signed(y_after)].map(|at| at..at + size)
                    }),
                );
                ranges.sort_unstable_by_key(|range| range.start);
            }
        }
        ranges
    }

    /// Returns whether locations in a file are lines, not bytes. A file without coordinates is text if it has no zero
    /// byte.
    fn is_text(&self, file_index: usize) -> bool {
        match self.encoding() {
            CoordinateEncoding::Text { .. } | CoordinateEncoding::Fields { .. }
                if file_index == self.file_index() =>
            {
                true
            }
            CoordinateEncoding::Binary { .. } if file_index == self.file_index() => false,
            _ => memchr::memchr(0, &self.files()[file_index].bytes).is_none(),
        }
    }

    /// Returns whether unchanged bytes keep their offsets for any lengths of encoded arrays, as in HDF5.
    fn preserves_offsets(&self, file_index: usize, fields: &[PointField]) -> bool {
        let of = |field: &PointField| match field.location()? {
            ArrayLocation { space: ByteSpace::Encoded(array), file_index: own, .. } => {
                Some(*own == file_index && array.preserves_offsets())
            }
            _ => None,
        };
        (file_index == self.file_index()
            && self.encoded_points().is_some_and(EncodedArrays::preserves_offsets))
            || fields.iter().filter_map(of).any(|keeps| keeps)
    }

    /// Returns the byte ranges of a file that depend on coordinates and on the values of `fields`, ascending.
    fn changeable(&self, file_index: usize, fields: &[PointField]) -> Vec<Range<usize>> {
        let bytes = &self.files()[file_index].bytes;
        let encoded = self.encoded_points().filter(|_| file_index == self.file_index());
        let mut ranges = match encoded {
            None if file_index == self.file_index() => self.coordinates(),
            None => Vec::new(),
            Some(points) => points.ranges(),
        };
        if file_index == 0 {
            // The names of companions may change.
            let named_at = self.source().companions.iter().flat_map(|own| &own.named_at);
            ranges.extend(named_at.cloned());
        }
        let own = |field: &&PointField| {
            field.location().is_some_and(|stored| stored.file_index == file_index)
        };
        let homes = || fields.iter().filter(own).filter_map(|field| Some(&field.location()?.space));
        let arrays = homes().filter_map(|home| match home {
            ByteSpace::Encoded(array) => Some(&**array),
            _ => None,
        });
        ranges.extend(arrays.clone().flat_map(EncodedArrays::ranges));
        // Offsets, addresses and checksums that depend on the lengths of arrays.
        let encoded = || encoded.into_iter().chain(arrays.clone());
        let first = encoded().flat_map(EncodedArrays::ranges).map(|range| range.end).min();
        if let (Some(first), Some(array)) = (first, encoded().next()) {
            ranges.extend(array.dependent_ranges(first));
        }
        let in_file = |stored: &ArrayLocation| {
            stored.file_index == file_index && matches!(stored.space, ByteSpace::File)
        };
        merged(ranges, number_ranges(bytes, fields, in_file))
    }
}

/// Returns the union of the ranges of two files, clipped to the length of each file. Bytes outside of the ranges must
/// have equal offsets in both files. The bytes beyond the end of the shorter file belong to present or former chunks,
/// and are added to the union.
fn in_either(bytes: [&[u8]; 2], ranges: [Vec<Range<usize>>; 2]) -> [Vec<Range<usize>>; 2] {
    let [mine, theirs] = ranges;
    let [a, b] = bytes.map(<[u8]>::len);
    let behind = a.min(b)..a.max(b);
    let mut joined: Vec<Range<usize>> = Vec::new();
    for range in merged(merged(mine, theirs), vec![behind]) {
        match joined.last_mut() {
            Some(last) if last.end >= range.start => last.end = last.end.max(range.end),
            _ => joined.push(range),
        }
    }
    bytes.map(|bytes| {
        let inside =
            |range: &Range<usize>| range.start.min(bytes.len())..range.end.min(bytes.len());
        joined.iter().map(inside).collect()
    })
}

/// Sorts triangles, each of which starts at its smallest vertex and keeps its winding.
fn ascending(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let turned = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    let mut all: Vec<[u32; 3]> = triangles.iter().filter_map(turned).collect();
    all.sort_unstable();
    all
}

/// Sorts the quadrilaterals of four different vertices, each of which starts at its smallest vertex and goes on to the smaller
/// one of its neighbors.
fn ascending_quadrilaterals(file: &MeshFile) -> Vec<[u32; 4]> {
    let turned = |&[a, b, c, d]: &[u32; 4]| {
        let turns = [[a, b, c, d], [b, c, d, a], [c, d, a, b], [d, a, b, c]];
        turns.into_iter().flat_map(|[a, b, c, d]| [[a, b, c, d], [a, d, c, b]]).min()
    };
    let mut all: Vec<[u32; 4]> =
        file.proper_quadrilaterals().filter_map(|(_, own)| turned(own)).collect();
    all.sort_unstable();
    all
}

/// Returns the line from `start` on, without its line break.
fn line_at(bytes: &[u8], start: usize) -> &[u8] {
    bytes[start..].split(|&byte| byte == b'\n').next().unwrap_or_default()
}

/// Shortens a line for a message of one line. A long line begins with the token that has the byte `at`, or that ends
/// there.
fn excerpt(line: &[u8], at: usize) -> String {
    const WHOLE: usize = 40;
    let at = at.min(line.len());
    let blank = line[..at].iter().rposition(u8::is_ascii_whitespace);
    match blank.map(|blank| blank + 1) {
        Some(token) if line.trim_ascii().len() > WHOLE => {
            format!("...{}", quoted(line[token..].trim_ascii()))
        }
        _ => quoted(line.trim_ascii()),
    }
}

fn is_beside_points(stored: &ArrayLocation) -> bool {
    matches!(stored.space, ByteSpace::Points)
}

/// Returns the byte ranges of the numbers of all fields whose location passes `in_these`.
fn number_ranges(
    bytes: &[u8],
    fields: &[PointField],
    in_these: impl Fn(&ArrayLocation) -> bool,
) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    for field in fields {
        let Some(stored @ ArrayLocation { offsets: places, encoding, .. }) = field.location()
        else {
            continue;
        };
        if !in_these(stored) {
            continue;
        }
        let range = |at: usize| at..encoding.extent(bytes, at).0;
        match places {
            Offsets::List(list) => ranges.extend(list.iter().map(|&at| range(at))),
            Offsets::Regular { start, stride } => {
                let count = field.numbers();
                ranges.extend((0..count).map(|index| range(start + index * stride)));
            }
        }
    }
    ranges
}

/// Returns the ranges of both lists, sorted by start. Ranges of several arrays with the same bytes are listed once.
fn merged(mut ranges: Vec<Range<usize>>, more: Vec<Range<usize>>) -> Vec<Range<usize>> {
    ranges.extend(more);
    ranges.sort_unstable_by_key(|range| (range.start, range.end));
    ranges.dedup();
    ranges
}

/// Returns the offsets in both files of the first difference outside of `ranges`; `None` without a difference. Equal
/// files must have equally many ranges.
fn unequal(bytes: [&[u8]; 2], ranges: [Vec<Range<usize>>; 2]) -> Option<[usize; 2]> {
    let [a, b] = bytes;
    let mut at = [0, 0];
    let ends = [a.len()..a.len(), b.len()..b.len()];
    let [mine, theirs] = ranges.map(Vec::into_iter);
    for (mine, theirs) in mine.zip(theirs).chain([ends.into()]) {
        let (Some(mine_before), Some(theirs_before)) =
            (a.get(at[0]..mine.start), b.get(at[1]..theirs.start))
        else {
            return Some(at);
        };
        if mine_before != theirs_before {
            let same = mine_before.iter().zip(theirs_before).take_while(|(a, b)| a == b).count();
            return Some(at.map(|at| at + same));
        }
        at = [mine.end, theirs.end];
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_outside_the_ranges_of_coordinates_are_compared() {
        let (x, y) = (vec![2..3, 4..5], vec![2..4, 5..6]);
        let find = |a: &[u8], b: &[u8]| unequal([a, b], [x.clone(), y.clone()]);
        assert_eq!(find(b"v 1 2 z", b"v 10 2 z"), None);
        assert_eq!(find(b"v 1 2 z", b"v 10 2 zz"), Some([7, 8]));
        assert_eq!(find(b"v 1\t2 z", b"v 10 2 z"), Some([3, 4]));
        assert_eq!(find(b"w 1 2 z", b"v 10 2 z"), Some([0, 0]));
        assert_eq!(find(b"v 1 2", b"v 10 2"), None);
    }
}
