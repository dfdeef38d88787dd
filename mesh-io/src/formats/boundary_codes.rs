//! Boundaries by codes of nodes, as in MIKE and TELEMAC, and as lines, as in ADCIRC and SMS.

use crate::content::group_label::GroupLabel;
use crate::export::content::{Content, ContentGroup};
use crate::formats::chains::chains;
use crate::visit::items::CellKind;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Lists the edges of a single face, in the direction and the order of the faces.
pub(super) fn boundary_edges<'f>(faces: impl Iterator<Item = &'f [u32]>) -> Vec<[u32; 2]> {
    let mut uses: HashMap<[u32; 2], u32> = HashMap::new();
    let mut edges = Vec::new();
    for own in faces {
        for (&a, &b) in own.iter().zip(own.iter().cycle().skip(1)) {
            *uses.entry([a.min(b), a.max(b)]).or_default() += 1;
            edges.push([a, b]);
        }
    }
    edges.retain(|&[a, b]| uses[&[a.min(b), a.max(b)]] == 1);
    edges
}

/// Lists the vertices of each face of a mesh.
fn faces(content: &Content) -> impl Iterator<Item = &[u32]> {
    let cells = &content.cells;
    let is_face = |&cell: &usize| cells.kinds[cell].dimension() == 2;
    (0..cells.len()).filter(is_face).map(|cell| cells.of(cell))
}

/// Boundaries of a mesh as codes of its vertices.
pub(crate) struct BoundaryCodes {
    /// The code of each vertex: 0 inside of the mesh, 1 on land, and from 2 on at open boundaries.
    pub(crate) codes: Vec<i64>,
    /// The group of each code from 2 on, as an index of [`Content::groups`].
    pub(crate) open: Vec<u32>,
    /// The groups of lines that the codes determine: open boundaries, land and islands.
    pub(crate) groups: Vec<u32>,
}

impl BoundaryCodes {
    /// Gives codes from 2 on to the groups of lines whose names start with `open`, and code 1 to the rest of the boundary.
    /// The ends of an open boundary have its code, as a side of MIKE is open if both of its ends are.
    pub(crate) fn new(content: &Content) -> BoundaryCodes {
        let edges = boundary_edges(faces(content));
        let mut codes = vec![0; content.points.len()];
        edges.iter().flatten().for_each(|&vertex| codes[vertex as usize] = 1);
        let groups = || 0..content.groups.len() as u32;
        let starts = |group: u32, word: &str| {
            let group = &content.groups[group as usize];
            group.dimension == 1 && group.name().is_some_and(|name| name.starts_with(word))
        };
        let open: Vec<u32> = groups().filter(|&group| starts(group, "open")).collect();
        let mut code_of: HashMap<u32, i64> = open.iter().copied().zip(2..).collect();
        let lines = || {
            let sets =
                content.cells.all(CellKind::Line).map(|cell| (cell, content.cells.sets[cell]));
            sets.map(|(cell, set)| (content.cells.of(cell), &content.sets[set as usize]))
        };
        let is_edge: HashSet<[u32; 2]> = edges.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
        let sorted = |ends: &[u32]| [ends[0].min(ends[1]), ends[0].max(ends[1])];
        for (ends, groups) in lines() {
            if let Some(&code) = groups.iter().find_map(|group| code_of.get(group)) {
                ends.iter().for_each(|&vertex| codes[vertex as usize] = code);
            }
        }
        let land =
            groups().filter(|&group| ["land", "island"].iter().any(|word| starts(group, word)));
        code_of.extend(land.map(|group| (group, 1)));
        let mut lost: HashSet<u32> = HashSet::new();
        for (ends, groups) in lines() {
            let ends = sorted(ends);
            let code = code_of_edge(ends.map(|vertex| codes[vertex as usize]));
            let is_kept = |group| code_of.get(group) == Some(&code) && is_edge.contains(&ends);
            lost.extend(groups.iter().filter(|group| !is_kept(group)));
        }
        let groups = groups().filter(|group| code_of.contains_key(group) && !lost.contains(group));
        BoundaryCodes { groups: groups.collect(), codes, open }
    }
}

/// Returns the code of an edge of the boundary by the codes of its ends: land with an end on land, else the larger code.
fn code_of_edge([a, b]: [i64; 2]) -> i64 {
    if a == 1 || b == 1 { 1 } else { a.max(b) }
}

/// Returns whether each chain of land is an island or a part of an outer boundary. `x` returns the x of a vertex. Closed
/// chains are islands. If the mesh has no open boundary, the longest chain in x is an outer boundary.
pub(super) fn words_of_land(
    chains: &[Vec<u32>],
    has_open: bool,
    x: impl Fn(u32) -> f64,
) -> Vec<&'static str> {
    let width = |chain: &Vec<u32>| {
        let xs = || chain.iter().map(|&vertex| x(vertex));
        xs().fold(f64::MIN, f64::max) - xs().fold(f64::MAX, f64::min)
    };
    let widths: Vec<f64> = chains.iter().map(width).collect();
    // If an outer boundary is all land, it is the longest. Otherwise it has open parts, and no closed chain is outer.
    let outer =
        (0..chains.len()).max_by(|&a, &b| widths[a].total_cmp(&widths[b])).filter(|_| !has_open);
    let is_island =
        |(index, chain): (usize, &Vec<u32>)| chain.first() == chain.last() && Some(index) != outer;
    chains.iter().enumerate().map(|own| if is_island(own) { "island" } else { "land" }).collect()
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
    let edges = boundary_edges(faces(content));
    let mut is_on_boundary = vec![false; codes.len()];
    edges.iter().flatten().for_each(|&vertex| is_on_boundary[vertex as usize] = true);
    if codes.iter().zip(&is_on_boundary).any(|(&code, &is)| (code > 0) != is || code < 0) {
        return;
    }
    let mut by_code: BTreeMap<i64, Vec<[u32; 2]>> = BTreeMap::new();
    for edge in edges {
        let code = code_of_edge(edge.map(|vertex| codes[vertex as usize]));
        by_code.entry(code).or_default().push(edge);
    }
    content.vertex_groups.clear();
    let land = chains(&by_code.remove(&1).unwrap_or_default());
    for (code, lines) in by_code {
        chains(&lines)
            .into_iter()
            .for_each(|chain| add(content, &format!("open{}", code - 1), &chain));
    }
    let has_open = content.groups.iter().any(|group| group.kind == KIND);
    let words = words_of_land(&land, has_open, |vertex| content.points[vertex as usize][0]);
    for (index, (chain, word)) in land.iter().zip(words).enumerate() {
        add(content, &format!("{word}{}", index + 1), chain);
    }
}

/// The kind of the groups of boundaries.
pub(super) const KIND: &str = "boundary";

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
