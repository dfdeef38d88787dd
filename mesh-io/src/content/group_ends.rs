//! The vertices at which groups of a mesh end along lines and along the boundary.

use crate::content::curve_edges::CurveEdges;
use crate::content::group::{Group, Groups};
use crate::content::numbering::is_nearly_all;

/// Least number of places at which the numbers of groups are compared. At fewer places, numbers always denote groups.
const MIN_PLACES: usize = 6;

/// Returns the vertices at which groups end, ascending.
///
/// A group of lines ends at each of its vertices at which other than two of its edges meet. Edges that are no edges of
/// the mesh are not counted. A group of vertices ends at each of its vertices on a curve from which a curve edge leads
/// to a vertex outside the group. Formats that label lines and vertices by the same kind of number give the vertex
/// between two lines one number of the two: a line of the group's own number leads to no vertex outside.
///
/// Groups of a kind whose numbers differ at nearly every vertex of the lines, or along nearly every edge between the
/// vertices, have no ends: such numbers count lines or vertices.
pub(crate) fn group_ends(groups: &Groups, edges: &CurveEdges) -> Vec<u32> {
    let CurveEdges { of_groups, all } = edges;
    let lines = chosen(groups, |group| !group.edges.is_empty(), are_counted_lines);
    let vertices = chosen(groups, Group::is_of_vertices, |own| are_counted_vertices(own, all));
    let mut ends = Vec::new();
    for group in &lines {
        ends.extend(ends_of_lines(group, of_groups));
    }
    for group in vertices {
        ends.extend(ends_of_vertices(group, all, &lines));
    }
    ends.sort_unstable();
    ends.dedup();
    ends
}

/// Returns the groups that `is_meant` selects, without the numbered groups of each kind for which `is_counted` returns
/// true.
fn chosen(
    groups: &Groups,
    is_meant: impl Fn(&Group) -> bool,
    is_counted: impl Fn(&[&Group]) -> bool,
) -> Vec<&Group> {
    let is_numbered = |group: &&Group| group.name.is_none() && group.tag.is_some();
    let mut kinds: Vec<&str> = Vec::new();
    let mut all = Vec::new();
    for group in groups.iter().filter(|group| is_meant(group)) {
        if !is_numbered(&group) {
            all.push(group);
        } else if !kinds.contains(&group.kind.as_str()) {
            kinds.push(&group.kind);
        }
    }
    for kind in kinds {
        let of_kind = groups.iter().filter(|group| is_meant(group) && group.kind == kind);
        let numbered: Vec<&Group> = of_kind.filter(is_numbered).collect();
        if !is_counted(&numbered) {
            all.extend(numbered);
        }
    }
    all
}

/// Returns whether numbers count their members: nearly all of `places` differ, and there are nearly as many `groups` as
/// `members`.
fn is_numbering(places: usize, differing: usize, groups: usize, members: usize) -> bool {
    places >= MIN_PLACES && is_nearly_all(differing, places) && is_nearly_all(groups, members)
}

/// Returns whether the numbers of groups of lines count edges.
fn are_counted_lines(groups: &[&Group]) -> bool {
    let mut at: Vec<(u32, usize)> = Vec::new();
    let mut members = 0;
    for (number, group) in groups.iter().enumerate() {
        members += group.edges.len();
        at.extend(group.edges.as_flattened().iter().map(|&vertex| (vertex, number)));
    }
    at.sort_unstable();
    let (mut places, mut differing) = (0, 0);
    for meeting in at.chunk_by(|a, b| a.0 == b.0).filter(|meeting| meeting.len() > 1) {
        places += 1;
        differing += usize::from(meeting.iter().any(|(_, number)| *number != meeting[0].1));
    }
    is_numbering(places, differing, groups.len(), members)
}

/// Returns whether the numbers of groups of vertices count the vertices on curves.
fn are_counted_vertices(groups: &[&Group], curves: &[[u32; 2]]) -> bool {
    let mut of: Vec<(u32, usize)> = Vec::new();
    for (number, group) in groups.iter().enumerate() {
        of.extend(group.vertices.iter().map(|&vertex| (vertex, number)));
    }
    of.sort_unstable();
    let numbers = |vertex: u32| {
        let start = of.partition_point(|&(other, _)| other < vertex);
        of[start..].iter().take_while(move |(other, _)| *other == vertex).map(|(_, number)| *number)
    };
    let (mut places, mut differing, mut members) = (0, 0, 0);
    let mut used = vec![false; groups.len()];
    for from in curves.chunk_by(|a, b| a[0] == b[0]) {
        members += usize::from(numbers(from[0][0]).next().is_some());
        numbers(from[0][0]).for_each(|number| used[number] = true);
        for &[a, b] in from.iter().filter(|[a, b]| a < b) {
            if numbers(a).next().is_some() && numbers(b).next().is_some() {
                places += 1;
                differing += usize::from(numbers(a).all(|one| numbers(b).all(|own| own != one)));
            }
        }
    }
    is_numbering(places, differing, used.into_iter().filter(|used| *used).count(), members)
}

/// Returns the ends of a group of lines. `of_mesh` lists the edges of the mesh among the edges of all groups.
fn ends_of_lines(group: &Group, of_mesh: &[[u32; 2]]) -> Vec<u32> {
    let mut at: Vec<(u32, bool)> = Vec::with_capacity(2 * group.edges.len());
    for edge in &group.edges {
        let is_of_mesh = of_mesh.binary_search(edge).is_ok();
        at.extend(edge.map(|vertex| (vertex, is_of_mesh)));
    }
    at.sort_unstable();
    let meetings = at.chunk_by(|a, b| a.0 == b.0);
    let is_end = |meeting: &&[(u32, bool)]| meeting.iter().filter(|at| at.1).count() != 2;
    meetings.filter(is_end).map(|meeting| meeting[0].0).collect()
}

/// Returns the ends of a group of vertices on curves. `lines` are the groups of lines.
fn ends_of_vertices(group: &Group, curves: &[[u32; 2]], lines: &[&Group]) -> Vec<u32> {
    let is_own = |line: &&&Group| line.kind == group.kind && line.tag == group.tag;
    let own = lines.iter().find(|line| group.tag.is_some() && is_own(line));
    let has_edge = |[a, b]: [u32; 2]| {
        own.is_some_and(|line| line.edges.binary_search(&[a.min(b), a.max(b)]).is_ok())
    };
    let leads_out =
        |edge: &[u32; 2]| group.vertices.binary_search(&edge[1]).is_err() && !has_edge(*edge);
    let is_end = |&vertex: &u32| {
        let start = curves.partition_point(|edge| edge[0] < vertex);
        curves[start..].iter().take_while(|edge| edge[0] == vertex).any(leads_out)
    };
    group.vertices.iter().copied().filter(is_end).collect()
}
