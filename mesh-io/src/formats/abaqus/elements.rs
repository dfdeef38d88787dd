//! Visits the elements of the mesh, with the sections, sets and surfaces that contain each element.

use super::blocks::Block;
use super::deck::{ASSEMBLY, Deck};
use super::lists::List;
use super::sets::{IdPositions, Key, Sets, WorkBudget};
use super::{rows, types};
use crate::content::decoded::decoded;
use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::token::quoted;
use crate::visit::items::{CellKind, Element, GroupScope};
use crate::visit::visitor::MeshVisitor;
use std::collections::{BTreeSet, HashMap, HashSet};

/// The sections, sets and surfaces of the elements, found before the elements are visited. Elements are numbered from 0
/// over all lists with a kind of cell. Lists that this reading does not need are empty.
#[derive(Default)]
pub(super) struct ElementGroups {
    /// The number of each element's section, counted from 1. Where `*ELSET` sets define regions, each combination of
    /// sets has a number instead. 0 marks elements without section or set. Empty if element lists define the regions.
    sections: Vec<u32>,
    /// The names of the element sets that are visited as groups.
    names: Vec<Vec<u8>>,
    /// Pairs of an element and the index in `names` of a set that contains the element, ascending.
    within: Vec<(u32, u32)>,
    /// The name of each surface, with the offset of the surface's keyword.
    surfaces: Vec<(Vec<u8>, usize)>,
    /// Element sides in surfaces, ascending: the element, the index in `surfaces`, and the label of the side, such as
    /// `S1`.
    sides: Vec<(u32, u32, [u8; 2])>,
}

impl ElementGroups {
    pub(super) fn new(
        source: &Source,
        deck: &Deck<'_>,
        cursor: &Cursor<'_>,
        lists: &[List<'_, '_>],
        mut sets: Sets,
        sections: &[(&Block<'_>, usize)],
        visitor: &mut dyn MeshVisitor,
    ) -> Result<ElementGroups, ReadError> {
        let mut found = ElementGroups::default();
        let key = |(block, scope): (&Block<'_>, usize)| {
            block.name("ELSET").map(|name| (scope, name.to_ascii_uppercase()))
        };
        let names = |keyword| -> HashSet<Key> { deck.of_mesh(keyword).filter_map(key).collect() };
        let (listed, of_lists) = (names("ELSET"), names("ELEMENT"));
        let of_sections: Vec<Key> = sections.iter().copied().filter_map(key).collect();
        if let Some((_, name)) =
            of_sections.iter().find(|&n| !listed.contains(n) && !of_lists.contains(n))
        {
            let name = quoted(name);
            visitor.remark(Remark::Text(format!("a section is of the set {name}, which the file lacks: vertices at the ends of the section are not fixed")));
        }
        // If all sections name sets of element lists (`*ELEMENT, ELSET=`), regions follow from the lists alone.
        let by_sets = sections.len() > 1 && of_sections.iter().any(|name| listed.contains(name));
        // If neither sections nor element lists define regions, `*ELSET` sets do.
        let by_members = sections.is_empty() && of_lists.is_empty() && !listed.is_empty();
        let has_surfaces = deck.of_mesh("SURFACE").next().is_some()
            || deck.of_assembly("SURFACE").next().is_some();
        let has_groups = visitor.asks_for_groups();
        if !by_sets && !by_members && !has_surfaces && !has_groups {
            return Ok(found);
        }
        let mut tags = Vec::new();
        let mut cursor = cursor.clone();
        for &List { block, scope, kind, .. } in lists {
            let before = tags.len() as u32;
            let Some(kind) = kind else { continue };
            let rows = &mut rows::data_rows(&mut cursor, block);
            let (offset, ahead) = (deck.offset(scope), visitor.allows_parallel());
            rows::each_element(rows, kind, offset, ahead, |_, tag, _| {
                tags.push(tag);
                Ok(())
            })?;
            if let Some(name) = block.name("ELSET") {
                sets.add(scope, name, before..tags.len() as u32);
            }
        }
        sets.read(source, deck, "ELSET");
        let all = &IdPositions::new(&tags);
        let effort = &mut WorkBudget::of(source);
        if by_sets {
            found.sections = vec![0; tags.len()];
            for (&(block, scope), section) in sections.iter().zip(1..) {
                let set = block.name("ELSET").and_then(|name| sets.find(deck, scope, name));
                let Some(set) = set else { continue };
                for element in sets.members(set, all, source, effort)? {
                    found.sections[element as usize] = section;
                }
            }
        }
        if has_groups || by_members {
            for (number, name) in sets.named(deck) {
                let group = found.names.len() as u32;
                let members = sets.members(number, all, source, effort)?;
                found.within.extend(members.into_iter().map(|element| (element, group)));
                found.names.push(name);
            }
            found.within.sort_unstable();
        }
        if by_members {
            found.sections = vec![0; tags.len()];
            let mut numbers: HashMap<Vec<u32>, u32> = HashMap::new();
            for of_element in found.within.chunk_by(|a, b| a.0 == b.0) {
                let groups = of_element.iter().map(|&(_, group)| group).collect();
                let next = numbers.len() as u32 + 1;
                let number = *numbers.entry(groups).or_insert(next);
                found.sections[of_element[0].0 as usize] = number;
            }
        }
        if !has_groups {
            found.within.clear();
        }
        found.find_sides(source, deck, &sets, all, effort, visitor)?;
        Ok(found)
    }

    /// Reads the `*SURFACE` blocks of the mesh and the assembly into `surfaces` and `sides`. A row names an element or
    /// a set of elements, then the label of a side.
    fn find_sides(
        &mut self,
        source: &Source,
        deck: &Deck<'_>,
        sets: &Sets,
        all: &IdPositions,
        effort: &mut WorkBudget,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        let of_assembly = deck.of_assembly("SURFACE").map(|block| (block, ASSEMBLY));
        for (block, scope) in deck.of_mesh("SURFACE").chain(of_assembly) {
            let of_elements =
                block.name("TYPE").is_none_or(|of| of.eq_ignore_ascii_case(b"ELEMENT"));
            let Some(name) = block.name("NAME") else { continue };
            if !of_elements {
                visitor.unsupported(&lost_surface(name));
                continue;
            }
            let surface = self.surfaces.len() as u32;
            self.surfaces.push((name.to_vec(), block.at));
            let mut row = Vec::new();
            for (item, is_last) in block.items(source) {
                row.push(item);
                if !is_last {
                    continue;
                }
                if let [of, label, ..] = row[..]
                    && let Ok(label) = <[u8; 2]>::try_from(label)
                {
                    let members = match sets.find(deck, scope, of) {
                        Some(set) => sets.members(set, all, source, effort)?,
                        None => all.of_word(of, deck.offset(scope)).collect(),
                    };
                    let side = |element| (element, surface, label);
                    self.sides.extend(members.into_iter().map(side));
                } else if row.iter().any(|item| !item.is_empty()) {
                    visitor.unsupported(&lost_surface(name));
                }
                row.clear();
            }
        }
        self.sides.sort_unstable();
        Ok(())
    }

    /// Visits all elements, then the element sides in surfaces as lines of groups of the kind `surface`.
    pub(super) fn send(
        self,
        deck: &Deck<'_>,
        cursor: &Cursor<'_>,
        lists: &[List<'_, '_>],
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        let mut cursor = cursor.clone();
        // The index of the next element, and the entries of `within` and `sides` from that element on.
        let (mut place, mut within, mut sides) = (0, &self.within[..], &self.sides[..]);
        // The entries of `within` whose groups were visited last.
        let mut told: &[(u32, u32)] = &[];
        let mut lines: Vec<(u32, [u64; 2])> = Vec::new();
        // The number of elements that only constrain their nodes, and their types.
        let (mut holding, mut types_of) = (0, BTreeSet::new());
        for List { block, scope, of, kind, set } in lists {
            let rows = &mut rows::data_rows(&mut cursor, block);
            let Some(kind) = *kind else {
                send_scopes(&self.names, &mut told, &[], visitor);
                let count = send_constrained_nodes(rows, deck, *scope, visitor)?;
                if count > 0 {
                    holding += count;
                    types_of.insert(of);
                }
                continue;
            };
            let (offset, ahead) = (deck.offset(*scope), visitor.allows_parallel());
            rows::each_element(rows, kind, offset, ahead, |cursor, tag, nodes| {
                let own = within.partition_point(|&(element, _)| element <= place);
                send_scopes(&self.names, &mut told, &within[..own], visitor);
                let section = self.sections.get(place as usize).copied().unwrap_or(0);
                let region = [*set, i64::from(section)];
                visitor.element(cursor, &Element { id: tag, kind, region, nodes })?;
                within = &within[own..];
                while let [(element, surface, label), rest @ ..] = sides
                    && *element == place
                {
                    let corners = kind.nodes();
                    match types::side(of, label).filter(|&side| side < corners && corners > 2) {
                        Some(side) => {
                            lines.push((*surface, [nodes[side], nodes[(side + 1) % corners]]));
                        }
                        None => {
                            let (name, _) = &self.surfaces[*surface as usize];
                            visitor.unsupported(&lost_surface(name));
                        }
                    }
                    sides = rest;
                }
                place += 1;
                Ok(())
            })?;
        }
        if let Some(first) = types_of.first() {
            let word = if types_of.len() == 1 { "the type" } else { "types such as" };
            visitor.remark(Remark::elements(
                holding,
                "element",
                &format!(" of {word} {}", quoted(first)),
            ));
        }
        lines.sort_by_key(|&(surface, _)| surface);
        for of_surface in lines.chunk_by(|a, b| a.0 == b.0) {
            let (name, at) = &self.surfaces[of_surface[0].0 as usize];
            cursor.seek(*at);
            visitor.group_scopes(&[GroupScope {
                kind: "surface",
                label: GroupLabel::name(name),
                dimension: Some(1),
            }]);
            for &(_, [a, b]) in of_surface {
                let (kind, nodes) = (CellKind::Line, [a, b, 0, 0]);
                visitor.element(&cursor, &Element { id: 0, kind, region: [0; 2], nodes })?;
            }
        }
        visitor.group_scopes(&[]);
        Ok(())
    }
}

/// Returns the loss of a surface of nodes, or of faces instead of sides of elements, for users.
#[cold]
fn lost_surface(name: &[u8]) -> String {
    format!("nodes or faces of the surface {}", decoded(name))
}

/// Visits the groups of the next element, if they differ from the groups of the element before.
fn send_scopes<'f>(
    names: &[Vec<u8>],
    told: &mut &'f [(u32, u32)],
    now: &'f [(u32, u32)],
    visitor: &mut dyn MeshVisitor,
) {
    let groups = |all: &'f [(u32, u32)]| all.iter().map(|&(_, group)| group);
    if !groups(told).eq(groups(now)) {
        let within = |group: u32| {
            let label = GroupLabel::name(&names[group as usize]);
            GroupScope { kind: "elset", label, dimension: None }
        };
        visitor.group_scopes(&groups(now).map(within).collect::<Vec<_>>());
    }
    *told = now;
}

/// Visits the nodes of constraining elements of a scope as points. Returns how many elements have nodes of the mesh.
fn send_constrained_nodes(
    rows: &mut Cursor<'_>,
    deck: &Deck<'_>,
    scope: usize,
    visitor: &mut dyn MeshVisitor,
) -> Result<u64, ReadError> {
    let (mut count, mut last) = (0, None);
    rows::each_constrained(rows, deck, scope, |cursor, tag, node| {
        let (kind, nodes) = (CellKind::Point, [node, 0, 0, 0]);
        visitor.element(cursor, &Element { id: tag, kind, region: [0; 2], nodes })?;
        count += u64::from(last.replace(tag) != Some(tag));
        Ok(())
    })?;
    Ok(count)
}
