//! How the coordinates stand in a file.

use crate::file::binary::Order;
use crate::mesh::Precision;
use std::ops::Range;

/// How the coordinates of a vertex stand in its file, from where its x starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Numbers {
    /// As text, y the token after x. What reads the file may know only single precision.
    Text { precision: Precision },
    /// In binary, y so many bytes after x.
    Binary { order: Order, precision: Precision, y_after: usize },
}

impl Numbers {
    /// Text with all digits.
    pub(crate) const TEXT: Numbers = Numbers::Text { precision: Precision::Double };

    /// Numbers in binary, y next to x.
    pub(crate) fn adjacent(order: Order, precision: Precision) -> Numbers {
        Numbers::Binary { order, precision, y_after: precision.bytes() }
    }

    pub(crate) fn precision(self) -> Precision {
        match self {
            Numbers::Text { precision } | Numbers::Binary { precision, .. } => precision,
        }
    }
}

/// How a single number stands in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// As a token of text. What reads the file may know only single precision.
    Text(Precision),
    /// In binary.
    Binary(Order, Precision),
}

impl Form {
    pub(crate) fn precision(self) -> Precision {
        match self {
            Form::Text(precision) | Form::Binary(_, precision) => precision,
        }
    }
}

impl From<Numbers> for Form {
    fn from(numbers: Numbers) -> Form {
        match numbers {
            Numbers::Text { precision } => Form::Text(precision),
            Numbers::Binary { order, precision, .. } => Form::Binary(order, precision),
        }
    }
}

/// Where the numbers of an array start, ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Places {
    /// Each by itself.
    List(Vec<usize>),
    /// One every so many bytes.
    Regular { start: usize, stride: usize },
}

impl Places {
    /// Where the number of this index starts.
    #[inline]
    pub(crate) fn at(&self, index: usize) -> usize {
        match self {
            Places::List(list) => list[index],
            Places::Regular { start, stride } => start + index * stride,
        }
    }
}

/// Places of numbers as they are found. They take memory only once they are not at equal steps.
#[derive(Default)]
pub(crate) struct FoundPlaces {
    start: usize,
    stride: usize,
    count: usize,
    /// All of them, if they are not at equal steps.
    list: Vec<usize>,
    /// About how many there will be.
    expected: usize,
}

impl FoundPlaces {
    pub(crate) fn expect(&mut self, more: usize) {
        self.expected = self.count + more;
    }

    #[inline]
    pub(crate) fn push(&mut self, at: usize) {
        if !self.list.is_empty() {
            self.list.push(at);
        } else if self.count > 1 && at == self.start + self.count * self.stride {
            self.count += 1;
        } else {
            self.extend(at, 0, 1);
        }
    }

    /// Adds so many places at equal steps.
    pub(crate) fn extend(&mut self, start: usize, stride: usize, count: usize) {
        let follows = match (self.count, count) {
            (_, 0) => return,
            (0, _) => {
                (self.start, self.stride) = (start, stride);
                true
            }
            (1, 1) if start > self.start => {
                self.stride = start - self.start;
                true
            }
            (own, more) => {
                self.list.is_empty()
                    && start == self.start + own * self.stride
                    && (more == 1 || stride == self.stride)
            }
        };
        if !follows {
            if self.list.is_empty() {
                self.list.reserve_exact(self.expected.max(self.count + count));
                self.list.extend((0..self.count).map(|index| self.start + index * self.stride));
            }
            self.list.extend((0..count).map(|index| start + index * stride));
        }
        self.count += count;
    }

    /// The place of this index.
    pub(crate) fn at(&self, index: usize) -> usize {
        match self.list.is_empty() {
            true => self.start + index * self.stride,
            false => self.list[index],
        }
    }

    pub(crate) fn finish(self) -> Places {
        match self.list.is_empty() {
            true => Places::Regular { start: self.start, stride: self.stride },
            false => Places::List(self.list),
        }
    }
}

/// Bytes that replace a range of a file.
#[derive(Clone)]
pub(crate) struct Splice {
    pub(crate) range: Range<usize>,
    pub(crate) bytes: Vec<u8>,
}

/// Where a file says how far from their beginning an array stands in the data at its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Offset {
    pub(crate) value: usize,
    /// Where the array starts in the file.
    pub(crate) array_at: usize,
    /// Where the file has the value.
    pub(crate) place: Range<usize>,
}

/// Arrays of numbers that a file has in another form than as numbers in place: in base64, or compressed.
pub(crate) trait Encoded: Send + Sync {
    /// The numbers in binary, as they were read.
    fn bytes(&self) -> &[u8];
    /// Where they stand in the file.
    fn ranges(&self) -> Vec<Range<usize>>;
    /// What of the file is replaced if these become the numbers. `end` is where the file ends, with what was put behind it so far; what
    /// is put there is a splice at its end as it was read.
    fn splices(&self, file: &[u8], new: &[u8], end: &mut usize) -> Vec<Splice>;
    /// What else is replaced in a file, once all is known that its arrays replace and where it ends then. What several arrays say
    /// of one range is the same.
    fn follow(&self, file: &[u8], splices: &[Splice], end: usize) -> Vec<Splice>;
    /// Where that may be in a file of which nothing changes before this byte.
    fn followers(&self, first: usize) -> Vec<Range<usize>>;
    /// Whether everything else stays at its place in the file, whatever the lengths of the arrays.
    fn keeps_places(&self) -> bool;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn found_places_are_those_that_were_added() {
        type Run = (usize, usize, usize);
        let cases: [(&[Run], bool); 8] = [
            (&[], true),
            (&[(7, 0, 1)], true),
            (&[(7, 0, 1), (10, 0, 1), (13, 0, 1), (16, 3, 4)], true),
            (&[(7, 3, 4), (19, 0, 1), (22, 3, 2)], true),
            (&[(7, 3, 4), (20, 0, 1), (21, 0, 1)], false),
            (&[(7, 3, 4), (19, 4, 3)], false),
            (&[(7, 0, 1), (10, 4, 3)], false),
            (&[(7, 0, 1), (10, 0, 1), (14, 0, 1), (18, 5, 3), (40, 0, 0)], false),
        ];
        for (runs, is_regular) in cases {
            let mut found = FoundPlaces::default();
            let mut expected = Vec::new();
            for &(start, stride, count) in runs {
                match count {
                    1 => found.push(start),
                    _ => found.extend(start, stride, count),
                }
                expected.extend((0..count).map(|index| start + index * stride));
            }
            let all: Vec<usize> = (0..expected.len()).map(|index| found.at(index)).collect();
            assert_eq!(all, expected, "{runs:?}");
            let places = found.finish();
            assert_eq!(matches!(places, Places::Regular { .. }), is_regular, "{runs:?}");
            let all: Vec<usize> = (0..expected.len()).map(|index| places.at(index)).collect();
            assert_eq!(all, expected, "{runs:?}");
        }
    }
}
