//! Boundaries by codes of nodes, as in MIKE, and as lines, as in ADCIRC and SMS.

use crate::content::group_label::GroupLabel;
use crate::export::content::{Content, ContentGroup};
use crate::formats::write_grids::chains;
use crate::visit::items::CellKind;
use std::collections::{BTreeMap, HashMap};

/// Lists the edges of a single face, in the direction and the order of the faces.
pub(super) fn boundary_edges(content: &Content) -> Vec<[u32; 2]> {
    let mut uses: HashMap<[u32; 2], u32> = HashMap::new();
    let mut edges = Vec::new();
    for cell in 0..content.cells.len() {
        if content.cells.kinds[cell].dimension() < 2 {
            continue;
        }
        let own = content.cells.of(cell);
        for (&a, &b) in own.iter().zip(own.iter().cycle().skip(1)) {
            *uses.entry([a.min(b), a.max(b)]).or_default() += 1;
            edges.push([a, b]);
        }
    }
    edges.retain(|&[a, b]| uses[&[a.min(b), a.max(b)]] == 1);
    edges
}

/// Replaces codes of nodes by lines of boundaries, which have the names that ADCIRC's reader gives them. An edge of the
/// boundary with an end of code 1 is land, and other edges are open: `open1` for code 2, and so on. An edge between two open
/// codes has the larger. Closed boundaries of land are islands, except the longest in x. Codes inside the mesh, and of a
/// mesh with a boundary node of code 0, stay groups of vertices.
pub(crate) fn to_lines(content: &mut Content) {
    let mut codes: Vec<i64> = vec![0; content.points.len()];
    for (group, vertices) in &content.vertex_groups {
        if let GroupLabel::Tag(tag) = group.label {
            vertices.iter().for_each(|&vertex| codes[vertex as usize] = tag);
        }
    }
    let edges = boundary_edges(content);
    let mut is_on_boundary = vec![false; codes.len()];
    edges.iter().flatten().for_each(|&vertex| is_on_boundary[vertex as usize] = true);
    if codes.iter().zip(&is_on_boundary).any(|(&code, &is)| (code > 0) != is || code < 0) {
        return;
    }
    let mut by_code: BTreeMap<i64, Vec<[u32; 2]>> = BTreeMap::new();
    for edge in edges {
        let [a, b] = edge.map(|vertex| codes[vertex as usize]);
        let code = if a == 1 || b == 1 { 1 } else { a.max(b) };
        by_code.entry(code).or_default().push(edge);
    }
    content.vertex_groups.clear();
    let land = chains(&by_code.remove(&1).unwrap_or_default());
    for (code, lines) in by_code {
        chains(&lines)
            .into_iter()
            .for_each(|chain| add(content, &format!("open{}", code - 1), &chain));
    }
    let width = |chain: &[u32]| {
        let xs = || chain.iter().map(|&vertex| content.points[vertex as usize][0]);
        xs().fold(f64::MIN, f64::max) - xs().fold(f64::MAX, f64::min)
    };
    let is_closed = |chain: &[u32]| chain.first() == chain.last();
    let widths: Vec<f64> = land.iter().map(|chain| width(chain)).collect();
    // If an outer boundary is all land, it is the longest. Otherwise it has open parts, and no closed chain is outer.
    let has_open = content.groups.iter().any(|group| group.kind == KIND);
    let outer =
        (0..land.len()).max_by(|&a, &b| widths[a].total_cmp(&widths[b])).filter(|_| !has_open);
    for (index, chain) in land.iter().enumerate() {
        let is_island = is_closed(chain) && Some(index) != outer;
        let word = if is_island { "island" } else { "land" };
        add(content, &format!("{word}{}", index + 1), chain);
    }
}

/// The kind of groups of ADCIRC's boundaries.
const KIND: &str = "boundary";

/// Adds the lines of a chain of vertices to the group of a name, which is made if it does not exist.
fn add(content: &mut Content, name: &str, chain: &[u32]) {
    let label = GroupLabel::Name(name.to_owned());
    let is_own = |group: &ContentGroup| group.kind == KIND && group.label == label;
    let group = content.groups.iter().position(is_own).unwrap_or_else(|| {
        let kind = KIND.to_owned();
        content.groups.push(ContentGroup { kind, dimension: 1, label: label.clone(), name: None });
        content.groups.len() - 1
    });
    let own = vec![group as u32];
    let set = content.sets.iter().position(|set| *set == own).unwrap_or_else(|| {
        content.sets.push(own);
        content.sets.len() - 1
    });
    for ends in chain.windows(2) {
        content.cells.push(CellKind::Line, ends, set as u32, 0);
    }
}
