//! Respelling of the names of groups and data for a format. Conversions change names nowhere else.

use crate::content::group_label::GroupLabel;
use crate::export::capabilities::{Capabilities, GroupSupport};
use crate::export::content::{Content, ContentGroup};
use crate::export::group_numbers::GroupNumbers;
use crate::export::name_rules::{NameRules, distinct};
use crate::format::Format;
use crate::formats::{cgns, ugrid, vtk};
use crate::text::token::join_first;
use std::collections::HashMap;

/// Respells the names that a format stores but cannot spell, and names sets of vertices. Distinct names stay distinct.
/// If the format identifies groups by names alone, later groups with an equal name get a suffix `_2`, `_3` and so on.
/// Returns the changes: a line for groups, a line for groups of vertices, a line for data of vertices and a line for
/// data of elements, each only if names change.
pub(crate) fn fit(holds: &Capabilities, content: &mut Content) -> Vec<String> {
    match holds.name_rules {
        NameRules::Any => Vec::new(),
        _ => [groups(holds, content), vertex_sets(holds, content), data(holds, content)].concat(),
    }
}

fn groups(holds: &Capabilities, content: &mut Content) -> Vec<String> {
    let tags = GroupNumbers::new(content, holds.allows_negative_numbers);
    let stored = [0, 1, 2].map(|dimension| holds.stored_kinds(content, dimension));
    // If names must be words, an unnamed group gets its number as name.
    let name = |(place, group): (usize, &ContentGroup)| {
        let dimension = usize::from(group.dimension);
        let is_held = holds.names[dimension] && stored[dimension].contains(&&*group.kind);
        let number = || tags.number(place as u32).to_string();
        let by_number = || holds.name_rules.is_word().then(number);
        group.name().map(str::to_owned).or_else(by_number).filter(|_| is_held)
    };
    let names: Vec<Option<String>> = content.groups.iter().enumerate().map(name).collect();
    // Lines and surfaces of equal kind, label and name share a new name, as formats without dimensions of groups have
    // them in one group. Sections of CGNS have elements of one dimension.
    let is_mixed = holds.groups != GroupSupport::Sections;
    let mut places: HashMap<(&str, &GroupLabel, &str, u8), usize> = HashMap::new();
    let mut owners: Vec<usize> = Vec::new();
    let mut old: Vec<&str> = Vec::new();
    let mut place_of = vec![None; names.len()];
    for (owner, (group, name)) in content.groups.iter().zip(&names).enumerate() {
        let Some(name) = name else { continue };
        let dimension = if is_mixed { 0 } else { group.dimension };
        let key = (group.kind.as_str(), &group.label, name.as_str(), dimension);
        let place = *places.entry(key).or_insert(old.len());
        if place == old.len() {
            old.push(name);
            owners.push(owner);
        }
        place_of[owner] = Some(place);
    }
    let number = |place: usize| tags.number(owners[place] as u32).to_string();
    let taken: &[&str] = if is_mixed { &[] } else { &cgns::write::NAMES };
    let new = distinct(&old, holds.name_rules, taken, number);
    let changes = old.iter().zip(&new).zip(&owners).filter(|((old, new), _)| old != new);
    let told: Vec<String> = changes
        .map(|((old, new), &owner)| match content.groups[owner].label {
            // The number distinguishes groups with equal names.
            GroupLabel::Tag(tag) if *old != tag.to_string() => {
                format!("`{old}` ({tag}) to `{new}`")
            }
            _ => format!("`{old}` to `{new}`"),
        })
        .collect();
    let is_new = |place: &usize| old[*place] != new[*place];
    let changed: Vec<Option<String>> = place_of
        .into_iter()
        .map(|place| place.filter(is_new).map(|place| new[place].clone()))
        .collect();
    for (group, new) in content.groups.iter_mut().zip(changed).filter(|(_, new)| new.is_some()) {
        group.name = new;
    }
    line("groups", &told)
}

/// Respells the names of groups of vertices, if the format has named sets of vertices. If names alone identify sets, each
/// group gets a name.
fn vertex_sets(holds: &Capabilities, content: &mut Content) -> Vec<String> {
    let has_node_sets = holds.groups == GroupSupport::Blocks && holds.vertex_groups;
    if !holds.vertex_sets && !has_node_sets {
        return Vec::new();
    }
    // In CGNS, the boundary conditions of lines have names in the same list.
    let tags = GroupNumbers::new(content, holds.allows_negative_numbers);
    let of_lines = content.groups.iter().enumerate().filter(|(_, group)| group.dimension == 1);
    let name = |(place, group): (usize, &ContentGroup)| {
        group.name().map_or_else(|| tags.number(place as u32).to_string(), str::to_owned)
    };
    let taken: Vec<String> = match holds.groups {
        GroupSupport::Sections => {
            of_lines.map(name).chain([cgns::write::LINES.to_owned()]).collect()
        }
        _ => Vec::new(),
    };
    let taken: Vec<&str> = taken.iter().map(String::as_str).collect();
    let by_number = |group: &ContentGroup| match group.label {
        GroupLabel::Tag(tag) if holds.name_rules.is_word() => Some(tag.to_string()),
        _ => None,
    };
    let name = |group: &ContentGroup| group.name().map(str::to_owned).or_else(|| by_number(group));
    let groups = content.vertex_groups.iter_mut().map(|(group, _)| group);
    let (mut groups, old): (Vec<&mut ContentGroup>, Vec<String>) =
        groups.filter_map(|group| name(group).map(|name| (group, name))).unzip();
    let names: Vec<&str> = old.iter().map(String::as_str).collect();
    let new = distinct(&names, holds.name_rules, &taken, |at| format!("set{}", at + 1));
    let changes = old.iter().zip(&new).filter(|(old, new)| old != new);
    let told: Vec<String> = changes.map(|(old, new)| format!("`{old}` to `{new}`")).collect();
    for (group, new) in groups.iter_mut().zip(new) {
        group.name = Some(new);
    }
    line("groups of vertices", &told)
}

/// Returns a line for the region arrays that become arrays of another name, if a mesh is converted among VTK's formats
/// and XDMF: files of these formats get the usual names, by which other programs recognize regions.
pub(crate) fn regions(content: &Content, from: Format, to: Format) -> Vec<String> {
    let has_arrays = |format: Format| {
        matches!(format, Format::Vtk | Format::VtkBinary | Format::Vtu | Format::Vtp | Format::Xdmf)
    };
    if !has_arrays(from) || !has_arrays(to) {
        return Vec::new();
    }
    let renamed = vtk::write::renamed_regions(&content.region_names);
    let told = renamed.iter().map(|(old, new)| format!("`{old}` to `{new}`"));
    line("data of elements", &told.collect::<Vec<_>>())
}

fn data(holds: &Capabilities, content: &mut Content) -> Vec<String> {
    let mut taken: Vec<String> = match holds.name_rules {
        // In PLY, coordinates are properties of vertices, like data with one component.
        NameRules::Word => ["x", "y", "z"].map(String::from).to_vec(),
        NameRules::Variable => ugrid::write::NAMES.map(String::from).to_vec(),
        _ => Vec::new(),
    };
    let mut changed = Vec::new();
    for (what, held, data) in [
        ("data of vertices", holds.point_data, &mut content.point_data),
        ("data of elements", holds.cell_data, &mut content.cell_data),
    ] {
        let mut data: Vec<_> = data.iter_mut().filter(|data| held.supports(data)).collect();
        let names: Vec<&str> = data.iter().map(|data| data.name.as_str()).collect();
        let all: Vec<&str> = taken.iter().map(String::as_str).collect();
        let new = distinct(&names, holds.name_rules, &all, |at| format!("data{}", at + 1));
        if holds.name_rules == NameRules::Variable {
            // Variables of vertices and of elements share a name space.
            taken.extend_from_slice(&new);
        }
        let mut told = Vec::new();
        for (data, new) in data.iter_mut().zip(new).filter(|(data, new)| data.name != *new) {
            told.push(format!("`{}` to `{new}`", data.name));
            data.name = new;
        }
        changed.extend(line(what, &told));
    }
    changed
}

/// Joins the first 8 changes in a line, and counts the rest. Returns an empty list without changes.
fn line(what: &str, told: &[String]) -> Vec<String> {
    let told: Vec<&str> = told.iter().map(String::as_str).collect();
    if told.is_empty() { Vec::new() } else { vec![format!("{what}: {}", join_first(&told))] }
}
