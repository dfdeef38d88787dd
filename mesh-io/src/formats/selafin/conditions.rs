//! The list of boundary conditions beside a SELAFIN: `NAME.cli`.
//!
//! The format: TELEMAC-2D's user manual, section on the file of boundary conditions. A row has 13 numbers: the types of the
//! depth and of the two velocities (LIHBOR, LIUBOR, LIVBOR), four values, the type and three values of a tracer, the number of a
//! boundary point, and the place of the point along the boundary. A depth of type 2 is a wall. A side of the mesh is open if
//! neither of its ends is a wall.

use super::write::{boundary_numbers, triangles};
use crate::binary::number_field::NumberField;
use crate::compress::file::Compression;
use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::formats::boundary_codes::{self, BoundaryCodes};
use crate::formats::chains::chains;
use crate::text::cursor::Cursor;
use crate::text::syntax::Syntax;
use crate::visit::items::GroupScope;
use crate::visit::visitor::MeshVisitor;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The three types of a boundary without flow, as one number.
const WALL: u64 = 222;
/// The three types of an open boundary whose depth is prescribed, as one number.
const DEPTH: u64 = 544;

/// Returns the path of the list beside the mesh at `path`, whether or not the list exists.
pub(crate) fn path_beside(path: &Path) -> PathBuf {
    match Compression::of(path) {
        Some(_) => path.with_extension("").with_extension("cli"),
        None => path.with_extension("cli"),
    }
}

/// Loads the list beside the mesh at `path`. `None` without a list, or if the list cannot be read.
pub(super) fn load(path: &Path) -> Option<Box<Source>> {
    let list = path_beside(path);
    let is_list = list != path && list.is_file();
    is_list.then(|| Source::load(&list).ok().map(Box::new))?
}

/// The faces of a mesh, and the x of its points.
pub(super) struct Faces<'a> {
    /// The numbers of the corners of all faces, from 1.
    pub(super) corners: NumberField<'a>,
    pub(super) count: usize,
    pub(super) corners_of_face: usize,
    pub(super) x: NumberField<'a>,
    pub(super) points: usize,
}

/// A boundary point in the list.
struct BoundaryPoint {
    /// The place in the list.
    place: usize,
    /// The types of depth and velocities as a number of three digits.
    types: u64,
}

/// Visits the boundaries as lines: `open1` and so on in the order of the list, with types besides [`DEPTH`] behind the name, and
/// `land1` or `island1` for walls. A list that does not fit the mesh is left out, as the mesh does not depend on the list.
pub(super) fn visit(
    list: &Source,
    cursor: &Cursor<'_>,
    faces: &Faces<'_>,
    visitor: &mut dyn MeshVisitor,
) {
    let Some((points, has_values)) = boundary_points(list, faces.points) else {
        visitor.unsupported("a list of boundary conditions (.cli), which does not fit the mesh");
        return;
    };
    if has_values {
        visitor.unsupported("values and types of walls in boundary conditions (.cli)");
    }
    let numbers = faces.corners.whole(0..faces.count * faces.corners_of_face);
    let corners: Vec<u32> = numbers.map(|number| (number as u32).wrapping_sub(1)).collect();
    let mut edges = boundary_codes::boundary_edges(corners.chunks_exact(faces.corners_of_face));
    let place = |vertex: u32| points.get(&vertex).map_or(usize::MAX, |point| point.place);
    edges.sort_by_key(|&[a, b]| (place(a).min(place(b)), place(a).max(place(b))));
    let mut by_types: BTreeMap<u64, Vec<[u32; 2]>> = BTreeMap::new();
    for edge in edges {
        let [Some(a), Some(b)] = edge.map(|vertex| points.get(&vertex)) else { continue };
        let is_wall = is_wall(a.types) || is_wall(b.types);
        let types = if is_wall { WALL } else { a.types.max(b.types) };
        by_types.entry(types).or_default().push(edge);
    }
    let land = chains(&by_types.remove(&WALL).unwrap_or_default());
    let of_types = |(types, edges): (u64, Vec<[u32; 2]>)| {
        chains(&edges).into_iter().map(move |chain| (types, chain))
    };
    let mut open: Vec<(u64, Vec<u32>)> = by_types.into_iter().flat_map(of_types).collect();
    open.sort_by_key(|(_, chain)| chain.iter().map(|&vertex| place(vertex)).min());
    let x = |vertex: u32| faces.x.real(vertex as usize..vertex as usize + 1).next().unwrap_or(0.0);
    let words = boundary_codes::words_of_land(&land, !open.is_empty(), x);
    let names = (1..).zip(&open).map(|(index, (types, _))| open_name(index, *types));
    let names = names.chain((1..).zip(words).map(|(index, word)| format!("{word}{index}")));
    let open = open.iter().map(|(_, chain)| chain);
    for (name, chain) in names.zip(open.chain(&land)) {
        let (kind, label) = (boundary_codes::KIND, GroupLabel::Name(name));
        visitor.group_scopes(&[GroupScope { kind, label, dimension: Some(1) }]);
        let ids: Vec<u64> = chain.iter().map(|&vertex| u64::from(vertex) + 1).collect();
        // All points of the list are points of the mesh.
        _ = visitor.polyline(cursor, 0, [0; 2], &ids);
    }
    visitor.group_scopes(&[]);
}

fn is_wall(types: u64) -> bool {
    types / 100 == 2
}

/// Reads the points of a list by their vertices, and whether the list has values besides 0 or types of walls besides [`WALL`].
/// `None` if the list is damaged or empty, or has a number that no point of the mesh has.
fn boundary_points(list: &Source, count: usize) -> Option<(HashMap<u32, BoundaryPoint>, bool)> {
    let cursor = &mut Cursor::new(list).with_syntax(Syntax::FORTRAN);
    let (mut points, mut has_values) = (HashMap::new(), false);
    while cursor.next_row() {
        let mut types = 0;
        for _ in 0..3 {
            types = 10 * types + cursor.integer("a type").ok().filter(|&digit| digit < 10)?;
        }
        let mut values = [0.0; 7];
        for (index, value) in values.iter_mut().enumerate() {
            if index == 4 {
                cursor.integer("the type of a tracer").ok()?;
            }
            *value = cursor.real("a value").ok()?;
        }
        has_values |= values.iter().any(|&value| value != 0.0) || (is_wall(types) && types != WALL);
        let number = cursor.integer("the number of a point").ok()?;
        let vertex = usize::try_from(number).ok()?.checked_sub(1).filter(|&own| own < count)?;
        let place = points.len();
        points.entry(vertex as u32).or_insert(BoundaryPoint { place, types });
    }
    (!points.is_empty()).then_some((points, has_values))
}

fn open_name(index: usize, types: u64) -> String {
    match types {
        DEPTH => format!("open{index}"),
        types => format!("open{index}_{types:03}"),
    }
}

/// Returns the types behind the name of an open boundary, as [`open_name`] writes them, else [`DEPTH`].
fn open_types(name: &str) -> u64 {
    let types = name.rsplit_once('_').map(|(_, types)| types);
    let types = types.filter(|types| types.len() == 3 && types.bytes().all(|b| b.is_ascii_digit()));
    let types = types.and_then(|types| types.parse().ok());
    types.filter(|&types| !is_wall(types)).unwrap_or(DEPTH)
}

/// Returns the list of a mesh; `None` without groups of lines that are boundaries by their names.
pub(crate) fn write_conditions(input: &WriterInput<'_>) -> Option<String> {
    let content = input.content;
    let BoundaryCodes { codes, open, groups } = BoundaryCodes::new(content);
    if groups.is_empty() {
        return None;
    }
    let types_of: Vec<u64> = open
        .iter()
        .map(|&group| open_types(content.groups[group as usize].name().unwrap_or_default()))
        .collect();
    let places = boundary_numbers(&content.points, &triangles(input));
    let mut points: Vec<(i32, usize)> = places.into_iter().zip(0..).collect();
    points.retain(|&(place, _)| place > 0);
    points.sort_unstable();
    let mut out = String::new();
    for (place, vertex) in points {
        let code = usize::try_from(codes[vertex]).unwrap_or(0);
        let types = code.checked_sub(2).map_or(WALL, |code| types_of[code]);
        let [depth, u, v] = [types / 100, types / 10 % 10, types % 10];
        let values = "0.000 0.000 0.000 0.000  2  0.000 0.000 0.000";
        put!(out, "{depth} {u} {v}  {values} {:>9} {place:>9}\n", vertex + 1);
    }
    Some(out)
}
