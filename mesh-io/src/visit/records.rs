//! Reads lists of binary records of equal size on all threads.
//!
//! Threads read chunks of a list, up to the first chunk with an unusual record. The reader then passes the remaining
//! records to the visitor one by one, and alone returns errors.

use crate::binary::number_field::NumberField;
use crate::content::id_index::{IdIndex, IdList};
use crate::edit::numbers::OffsetsBuilder;
use crate::parallel::{map_parts, map_ranges};
use std::ops::Range;

/// Number of records that one thread reads at a time.
const CHUNK_RECORDS: usize = 1 << 13;
/// Smallest number of records that are read on several threads. Shorter lists are read as fast on one thread.
pub(crate) const MIN_PARALLEL_RECORDS: usize = 1 << 14;

/// The ids of the nodes of a binary list.
#[derive(Clone, Copy)]
pub(crate) enum NodeIds<'a> {
    /// Consecutive ids from the given id on.
    Consecutive(u64),
    Field(NumberField<'a>),
}

impl NodeIds<'_> {
    /// Returns the id of the node with a 0-based index, which the field must hold.
    pub(super) fn of(self, index: usize) -> u64 {
        match self {
            NodeIds::Consecutive(first) => first + index as u64,
            NodeIds::Field(field) => field.order.whole(field.at(index)),
        }
    }
}

/// Binary list of nodes.
pub(crate) struct NodeRecords<'a> {
    pub(crate) count: usize,
    /// Field of x. The fields of x and y are both 4 bytes wide (single precision) or both 8 (double).
    pub(crate) x: NumberField<'a>,
    pub(crate) y: NumberField<'a>,
    /// Byte offset of the first node's x in the file, or in the decoded bytes of encoded points.
    pub(crate) x_offset: usize,
    pub(crate) ids: NodeIds<'a>,
}

impl NodeRecords<'_> {
    /// Appends nodes from the start of the list, up to the first chunk with an infinite or NaN coordinate or a negative
    /// id. Returns the number of appended nodes. Lists below [`MIN_PARALLEL_RECORDS`], and fields of unusual width or
    /// insufficient length, return 0.
    pub(crate) fn read(
        &self,
        points: &mut Vec<[f64; 2]>,
        ids: &mut IdList,
        places: &mut OffsetsBuilder,
    ) -> usize {
        let &NodeRecords { count, x, y, .. } = self;
        let fits = x.has_records(count, 1)
            && y.has_records(count, 1)
            && matches!((x.width, y.width), (4, 4) | (8, 8));
        let has_ids = match self.ids {
            NodeIds::Consecutive(_) => true,
            NodeIds::Field(field) => field.has_records(count, 1),
        };
        if count < MIN_PARALLEL_RECORDS || !fits || !has_ids {
            return 0;
        }
        let (taken, _) = append(points, count, |records, points| {
            let coordinates = x.real(records.clone()).zip(y.real(records.clone()));
            let mut is_finite = true;
            for (point, (x, y)) in points.iter_mut().zip(coordinates) {
                is_finite &= x.is_finite() && y.is_finite();
                *point = [x, y];
            }
            let is_plain = match self.ids {
                NodeIds::Consecutive(_) => true,
                NodeIds::Field(field) => field.whole(records).all(|id| id <= field.max()),
            };
            (is_finite && is_plain).then_some(())
        });
        places.extend(self.x_offset, x.stride, taken);
        match self.ids {
            NodeIds::Consecutive(first) => ids.extend(first, taken as u64),
            NodeIds::Field(field) => add_tags(field, taken, ids),
        }
        taken
    }
}

fn add_tags(field: NumberField<'_>, count: usize, ids: &mut IdList) {
    let first = field.whole(0..count.min(1)).next().unwrap_or(0);
    let are_consecutive = |records: Range<usize>| {
        let expected = records.clone().map(|record| first.checked_add(record as u64));
        field.whole(records).map(Some).eq(expected)
    };
    match map_ranges(count, CHUNK_RECORDS, are_consecutive).into_iter().all(|are| are) {
        true => ids.extend(first, count as u64),
        false => field.whole(0..count).for_each(|id| ids.push(id)),
    }
}

/// Condition on an integer of each record of a binary list, by which plain triangles are recognized.
#[derive(Clone, Copy)]
pub(crate) enum FieldRule {
    /// Not negative.
    Natural,
    /// This number in each record.
    Is(u64),
    /// Arithmetic sequence: `first` in the first record, `step` more in every following record.
    Steps { first: u64, step: u64 },
}

/// Source of one of the two integers that identify the region of a triangle.
#[derive(Clone, Copy)]
pub(crate) enum Region<'a> {
    /// Equal integer for all triangles.
    Same(i64),
    Field(NumberField<'a>),
    /// An integer for each triangle; 0 for triangles beyond the end of the list.
    List(&'a [i64]),
}

impl Region<'_> {
    /// Returns the integer of a record, which the field must hold.
    pub(super) fn of(self, record: usize) -> i64 {
        match self {
            Region::Same(region) => region,
            Region::Field(field) => field.order.signed(field.at(record)),
            Region::List(list) => list.get(record).copied().unwrap_or(0),
        }
    }
}

/// Binary list of triangles.
pub(crate) struct TriangleRecords<'a> {
    pub(crate) count: usize,
    /// Field of three adjacent node numbers for each triangle. Numbers must be below `node_end`.
    pub(crate) nodes: NumberField<'a>,
    /// Id of the node with number 0: the id of a node is its number plus `min_node`.
    pub(crate) min_node: u64,
    pub(crate) node_end: u64,
    pub(crate) regions: [Region<'a>; 2],
    /// Conditions on further fields, which the record of a triangle meets.
    pub(crate) required_fields: &'a [(NumberField<'a>, FieldRule)],
}

impl TriangleRecords<'_> {
    /// Appends triangles from the start of the list, up to the first chunk with a record that breaks a condition or has
    /// an unknown or repeated node. Calls `region` with each region and the length of a run of triangles in the region.
    /// Returns the number of appended triangles.
    pub(crate) fn read(
        &self,
        map: &IdIndex,
        triangles: &mut Vec<[u32; 3]>,
        mut region: impl FnMut([i64; 2], usize),
    ) -> usize {
        let &TriangleRecords { count, nodes: corners, .. } = self;
        let mut fields = self.required_fields.iter().map(|&(field, _)| field);
        let has_regions = self.regions.iter().all(|region| match region {
            Region::Field(field) => field.has_records(count, 1),
            _ => true,
        });
        let fits = corners.has_records(count, 3) && fields.all(|field| field.has_records(count, 1));
        // If the first chunk breaks a condition, the list is left to the reader without further tests.
        if count < MIN_PARALLEL_RECORDS
            || !fits
            || !has_regions
            || !self.is_expected(0..CHUNK_RECORDS)
        {
            return 0;
        }
        let (taken, same) = append(triangles, count, |records, triangles| {
            let is_plain = match *map {
                IdIndex::Run { first, count } => self.fill(records.clone(), triangles, |id| {
                    id.checked_sub(first).filter(|&index| index < count).map(|index| index as u32)
                }),
                _ => self.fill(records.clone(), triangles, |id| map.index(id)),
            };
            (is_plain && self.is_expected(records.clone())).then(|| self.same_region(records))
        });
        for (records, same) in same {
            match same {
                Some(same) => region(same, records.len()),
                None => records.for_each(|record| {
                    region(self.regions.map(|region| region.of(record)), 1);
                }),
            }
        }
        taken
    }

    /// Writes the vertex indices of the triangles. Returns false if a node number is out of range or unknown, or a
    /// triangle repeats a node.
    fn fill(
        &self,
        records: Range<usize>,
        triangles: &mut [[u32; 3]],
        index: impl Fn(u64) -> Option<u32>,
    ) -> bool {
        let (most, width) =
            (self.nodes.max().min(self.node_end.saturating_sub(1)), self.nodes.width);
        for (triangle, bytes) in triangles.iter_mut().zip(self.nodes.of(records)) {
            for (corner, bytes) in triangle.iter_mut().zip(bytes.chunks_exact(width)) {
                let id = self.nodes.order.whole(bytes);
                if id > most {
                    return false;
                }
                let Some(index) = id.checked_add(self.min_node).and_then(&index) else {
                    return false;
                };
                *corner = index;
            }
            let [a, b, c] = *triangle;
            if a == b || b == c || c == a {
                return false;
            }
        }
        true
    }

    fn is_expected(&self, records: Range<usize>) -> bool {
        self.required_fields.iter().all(|&(field, expected)| {
            let mut numbers = field.whole(records.clone());
            match expected {
                FieldRule::Natural => numbers.all(|number| number <= field.max()),
                FieldRule::Is(one) => numbers.all(|number| number == one),
                FieldRule::Steps { first, step } => {
                    let more = |record: usize| first.checked_add(step.checked_mul(record as u64)?);
                    numbers.map(Some).eq(records.clone().map(more))
                }
            }
        })
    }

    /// Returns the common region of some triangles; `None` if the triangles have different regions.
    fn same_region(&self, mut records: Range<usize>) -> Option<[i64; 2]> {
        let of = |record| self.regions.map(|region| region.of(record));
        let first = of(records.start);
        let is_same = self.regions.iter().all(|region| matches!(region, Region::Same(_)))
            || records.all(|record| of(record) == first);
        is_same.then_some(first)
    }
}

/// Appends `count` items to a list. `fill` writes chunks of items on all threads; the first chunk for which `fill`
/// returns `None` is dropped with all later chunks. Returns the number of items kept, and the range and result of each
/// chunk.
fn append<T: Copy + Default + Send, R: Send, const N: usize>(
    list: &mut Vec<[T; N]>,
    count: usize,
    fill: impl Fn(Range<usize>, &mut [[T; N]]) -> Option<R> + Sync,
) -> (usize, Vec<(Range<usize>, R)>) {
    let before = list.len();
    match before {
        // The system provides new memory filled with zeros, which saves writing each item twice.
        0 => {
            *list = vec![[T::default(); N]; list.capacity().max(count)];
            list.truncate(count);
        }
        _ => list.resize(before + count, [T::default(); N]),
    }
    let filled = map_parts(list[before..].chunks_mut(CHUNK_RECORDS), |index, chunk| {
        let start = index * CHUNK_RECORDS;
        let records = start..start + chunk.len();
        fill(records.clone(), chunk).map(|made| (records, made))
    });
    let plain: Vec<_> = filled.into_iter().map_while(|made| made).collect();
    let taken = plain.last().map_or(0, |(records, _)| records.end);
    list.truncate(before + taken);
    (taken, plain)
}
