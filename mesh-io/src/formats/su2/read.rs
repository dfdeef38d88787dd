//! SU2's `.su2`.
//!
//! The format: <https://su2code.github.io/docs_v7/Mesh-File/>. The number of a point is its 0-based position in the
//! list. An index at the end of a point's row is ignored. Each zone of a multi-zone mesh has its own points and point
//! numbers.

use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::su2::motions::Motions;
use crate::formats::vtk::types;
use crate::text::cursor::{CORRECT, CUT_OFF, Cursor};
use crate::text::parallel_rows::take_rows;
use crate::text::syntax::Syntax;
use crate::text::token::{integer, key_value, quoted};
use crate::visit::items::{CellKind, Element, GroupScope, RegionAttribute};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, end_of_list, nodes, volume};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use std::ops::Range;

pub(crate) struct Su2;

/// A list of elements. The list may precede the points.
struct List<'a> {
    cursor: Cursor<'a>,
    /// The leading elements that were read on all threads.
    ahead: Vec<Small>,
    count: u64,
    zone: usize,
    /// The name of the elements' marker; `None` for elements of the domain.
    marker: Option<&'a [u8]>,
}

/// An element with its nodes. Most node numbers fit 32 bits, so lists read ahead need less memory.
type Small = (CellKind, [u32; 4]);

impl FormatReader for Su2 {
    const VERTICES: &'static str = "NPOIN";
    const NAMES_OTHER_LINES: bool = false;

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source).with_syntax(Syntax::PERCENT);
        let mut lists: Vec<List<'_>> = Vec::new();
        // The number of points before each zone, and the number of all points.
        let (mut zones, mut points) = (vec![0], 0_u64);
        let mut has_points = false;
        let (mut marker, mut motions) = (None, None::<Motions>);
        // The number of markers that each zone announces, and the number of zones.
        let (mut announced, mut all_zones) = (Vec::new(), 0);
        while cursor.next_row() {
            let (key, all) = key_and_values(cursor);
            let value = first(all);
            match key {
                b"NDIME" => match integer(value) {
                    Some(2) => {}
                    Some(3) => return Err(volume(cursor, "three dimensions (NDIME= 3)")),
                    _ => return Err(wrong(cursor, "NDIME", value)),
                },
                b"IZONE" if points > zones[zones.len() - 1] => zones.push(points),
                b"NPOIN" => {
                    let count = number(cursor, "NPOIN", value)?;
                    cursor.check_vertex_count(points.saturating_add(count))?;
                    visitor.expect_nodes(cursor.capacity(count, "0 0\n".len()));
                    let first = points;
                    each_row(
                        cursor,
                        count,
                        "points",
                        visitor,
                        point,
                        |cursor, visitor, done, (x_at, at)| {
                            visitor.node(cursor, first + done, 2, x_at, at);
                            Ok(())
                        },
                    )?;
                    end_of_list(cursor, count, "points", point)?;
                    points += count;
                    has_points = true;
                }
                b"MARKER_TAG" => marker = Some(all),
                b"NELEM" | b"MARKER_ELEMS" => {
                    let name = if key == b"NELEM" { "NELEM" } else { "MARKER_ELEMS" };
                    let count = number(cursor, name, value)?;
                    let zone = zones.len() - 1;
                    let marker = if key == b"NELEM" { None } else { marker };
                    skip_send_to(cursor);
                    let start = cursor.clone();
                    let ahead = read_ahead(cursor, count, visitor);
                    // A list that ends too early is no error here: the list is read again below, which makes a better
                    // error.
                    for _ in ahead.len() as u64..count {
                        if !cursor.next_row() {
                            break;
                        }
                    }
                    end_of_list(cursor, count, "elements", element)?;
                    lists.push(List { cursor: start, ahead, count, zone, marker });
                }
                // The first periodic entry is no motion.
                b"NPERIODIC"
                    if !visitor.asks_for_data()
                        && integer(value).is_some_and(|count| count > 1) =>
                {
                    motions.get_or_insert_default();
                }
                b"PERIODIC_CENTER" | b"PERIODIC_ROTATION" | b"PERIODIC_TRANSLATION"
                    if !visitor.asks_for_data() =>
                {
                    motions.as_mut().into_iter().for_each(|motions| motions.read(key, all));
                }
                b"NMARK" => {
                    announced.resize(zones.len(), None);
                    announced[zones.len() - 1] = Some(number(cursor, "NMARK", value)?);
                }
                b"NZONE" => all_zones = number(cursor, "NZONE", value)?,
                b"IZONE" => {}
                // Counts of other lists, and boxes for free-form deformation.
                _ if visitor.asks_for_data() && !value.is_empty() => {
                    visitor.unsupported(&format!("what {}= is", quoted(key)));
                }
                _ => {}
            }
        }
        if !has_points && !lists.is_empty() {
            return Err(cursor.error("the file ends before its points (NPOIN)", CUT_OFF));
        }
        check_markers(cursor, &announced, &lists)?;
        let found = zones.len() as u64;
        if all_zones > found {
            let problem = format!("the file ends after {found} of {all_zones} zones");
            return Err(cursor.error(problem, CUT_OFF));
        }
        visitor.end_nodes(cursor)?;
        if let Some(motions) = motions {
            visitor.periodic_pairs(motions.finish());
        }
        if zones.len() > 1 {
            let label = |zone| Some(GroupLabel::Tag(zone + 1));
            visitor.region_attributes(vec![RegionAttribute {
                kind: "zone".into(),
                from_dimension: 2,
                label,
            }]);
        }
        for List { mut cursor, ahead, count, zone, marker } in lists {
            let within = |name| GroupScope {
                kind: "marker",
                label: GroupLabel::name(name),
                dimension: None,
            };
            visitor.group_scopes(marker.map(within).as_slice());
            let last = zones.get(zone + 1).copied().unwrap_or(points);
            elements(&mut cursor, &ahead, count, zone, zones[zone]..last, visitor)?;
        }
        Ok(CoordinateStorage::in_place(Format::Su2, CoordinateEncoding::TEXT))
    }
}

/// Checks that each zone with `NMARK` has as many markers as `NMARK` announces. `cursor` is at the end of the file.
///
/// # Errors
/// If a zone has fewer markers, as in a file that is cut off between two markers, or if further markers follow, which SU2
/// does not read. Copies of vertices in other processes (`SEND_RECEIVE`) may follow.
fn check_markers(
    cursor: &Cursor<'_>,
    announced: &[Option<u64>],
    lists: &[List<'_>],
) -> Result<(), ReadError> {
    for (zone, &count) in announced.iter().enumerate() {
        let Some(count) = count else { continue };
        let of_zone = lists.iter().filter(|list| list.zone == zone && list.marker.is_some());
        let found = of_zone.clone().count() as u64;
        if found < count {
            let end = if zone + 1 < announced.len() { "zone" } else { "file" };
            let problem = format!("the {end} ends after {found} of {count} markers (NMARK)");
            return Err(cursor.error(problem, CUT_OFF));
        }
        let mut of_boundary = of_zone.filter(|list| list.marker != Some(b"SEND_RECEIVE"));
        let further = usize::try_from(count).ok().and_then(|count| of_boundary.nth(count));
        if let Some(further) = further {
            let problem = format!("further markers follow the {count} that NMARK announces");
            return Err(further.cursor.error(problem, "Correct NMARK, or write the mesh again"));
        }
    }
    Ok(())
}

/// Visits the elements of a list, whose nodes are numbered within a zone. The range has the zone's points, counted over
/// all zones.
fn elements(
    cursor: &mut Cursor<'_>,
    ahead: &[Small],
    count: u64,
    zone: usize,
    Range { start: first, end: last }: Range<u64>,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    visitor.expect_elements(cursor.capacity(count, "5 0 1 2\n".len()));
    let mut take = |cursor: &Cursor<'_>, done: u64, (kind, nodes): (CellKind, [u64; 4])| {
        let listed = &nodes[..kind.nodes()];
        if let Some(point) = listed.iter().find(|&&point| point >= last - first) {
            let kind = kind.name();
            let problem = format!("{kind} {done} has node {point}, which NPOIN does not list");
            return Err(cursor.error(problem, CORRECT));
        }
        let nodes = nodes.map(|node| node.saturating_add(first));
        visitor.element(cursor, &Element { id: done, kind, region: [zone as i64, 0], nodes })
    };
    let mut done = 0;
    // Errors are dropped here, as reading row by row meets them again.
    let nowhere = &Cursor::new(cursor.source);
    for &(kind, nodes) in ahead {
        if take(nowhere, done, (kind, nodes.map(u64::from))).is_err() {
            break;
        }
        done += 1;
    }
    if done < count {
        (0..done).for_each(|_| _ = cursor.next_row());
    }
    while done < count {
        cursor.row(done, count, "elements")?;
        let read = element(cursor)?;
        take(cursor, done, read)?;
        done += 1;
    }
    Ok(())
}

/// Reads the leading elements of a long list on all threads, until a row is not plain. Returns no elements if the
/// visitor does not allow threads.
fn read_ahead(cursor: &mut Cursor<'_>, count: u64, visitor: &dyn MeshVisitor) -> Vec<Small> {
    let mut ahead = Vec::new();
    if visitor.allows_parallel() {
        ahead.reserve(cursor.capacity(count, "5 0 1 2\n".len()));
        let read = |cursor: &mut Cursor<'_>| -> Result<Option<Small>, ReadError> {
            let (kind, nodes) = element(cursor)?;
            let small = |node: u64| u32::try_from(node).ok();
            let [Some(a), Some(b), Some(c), Some(d)] = nodes.map(small) else { return Ok(None) };
            Ok(Some((kind, [a, b, c, d])))
        };
        take_rows(cursor, count, read, |small| {
            ahead.extend(small);
            small.is_some()
        });
    }
    ahead
}

/// Skips the row `SEND_TO` between the count of a marker's elements and the elements. `SEND_TO` concerns copies of the
/// marker in other processes.
fn skip_send_to(cursor: &mut Cursor<'_>) {
    let mut next = cursor.clone();
    if next.next_row() && key_and_values(&mut next).0 == b"SEND_TO" {
        *cursor = next;
    }
}

/// Returns the two sides of the equals sign of a row, without comments. If there is no equals sign, returns the row and
/// an empty value.
fn key_and_values<'a>(cursor: &mut Cursor<'a>) -> (&'a [u8], &'a [u8]) {
    let (key, values) = key_value(cursor.rest());
    (key, values.split(|&byte| byte == b'%').next().unwrap_or_default().trim_ascii())
}

/// Returns the first of several values, up to a blank.
fn first(values: &[u8]) -> &[u8] {
    let end = values.iter().position(|&byte| byte <= b' ').unwrap_or(values.len());
    &values[..end]
}

fn number(cursor: &Cursor<'_>, name: &str, value: &[u8]) -> Result<u64, ReadError> {
    integer(value).ok_or_else(|| wrong(cursor, name, value))
}

#[cold]
fn wrong(cursor: &Cursor<'_>, name: &str, value: &[u8]) -> ReadError {
    cursor.error(format!("{name} is `{}`", quoted(value)), CORRECT)
}

/// Reads the row of an element, which starts with VTK's number of its type.
#[inline]
fn point(cursor: &mut Cursor<'_>) -> Result<(usize, [f64; 2]), ReadError> {
    cursor.point("a point")
}

fn element(cursor: &mut Cursor<'_>) -> Result<(CellKind, [u64; 4]), ReadError> {
    let number = cursor.integer("the type of an element")?;
    match types::kind_of(number) {
        Some(kind) => Ok((kind, nodes(cursor, kind)?)),
        None => Err(not_read(cursor, number)),
    }
}

#[cold]
fn not_read(cursor: &Cursor<'_>, number: u64) -> ReadError {
    if let types::TETRA..=types::PYRAMID = number {
        return volume(cursor, "elements of a volume");
    }
    let problem = format!("element type {number} is not known");
    cursor.error(problem, "Lines (3), triangles (5) and quadrilaterals (9) are read")
}
