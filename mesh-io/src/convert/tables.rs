//! Makes the table of conversions in docs/formats.md from the capabilities of each target.

use super::targets::TARGETS;
use crate::export::capabilities::{Capabilities, ElementSupport, GroupSupport};
use crate::export::data_support::DataSupport;
use crate::format::Format;
use crate::registry::FormatEntry;
use std::fmt::Write;

/// Returns the name of a format in conversions; `None` if the format is no target.
pub(crate) fn name_of(format: Format) -> Option<String> {
    let target = TARGETS.iter().find(|target| target.format == format);
    target.map(|target| format!("`{}`", target.name))
}

/// Returns the Markdown table of targets, with a row for each.
pub(crate) fn targets() -> String {
    let mut table = "| `--to` | ending | elements besides triangles | z | own numbers of vertices | groups of elements | \
                     names of groups of | groups of vertices | data of vertices | data of elements |\n\
                     |---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for target in TARGETS {
        let holds = &target.capabilities;
        let ending = FormatEntry::of(target.format).extensions[0];
        let yes = |held: bool| if held { "yes" } else { "–" };
        writeln!(
            table,
            "| `{}` | `{ending}` | {} | {} | {} | {} | {} | {} | {} | {} |",
            target.name,
            elements(holds),
            yes(holds.z),
            yes(holds.keeps_vertex_ids),
            groups(holds.groups),
            names(holds),
            match (holds.vertex_groups, holds.groups) {
                _ if holds.vertex_sets => "node sets, with names",
                (true, GroupSupport::Blocks) => "node sets, with names",
                (true, _) => "one per vertex",
                (false, _) => "–",
            },
            numbers(holds.point_data, "per vertex"),
            numbers(holds.cell_data, "per element"),
        )
        .unwrap();
    }
    table
}

fn joined(words: &[&str]) -> String {
    if words.is_empty() { "–".into() } else { words.join(", ") }
}

fn elements(holds: &Capabilities) -> String {
    let held = |elements, all, some| match elements {
        ElementSupport::None => None,
        ElementSupport::All => Some(all),
        ElementSupport::OfGroups => Some(some),
    };
    let words = [
        held(holds.points, "points", "points of groups"),
        held(holds.lines, "lines", "lines of groups"),
        holds.quadrilaterals.then_some("quadrilaterals"),
        holds.polygons.then_some("polygons"),
    ];
    joined(&words.into_iter().flatten().collect::<Vec<_>>())
}

fn groups(groups: GroupSupport) -> &'static str {
    match groups {
        GroupSupport::None => "–",
        GroupSupport::One => "one per element",
        GroupSupport::OneOfLines => "one per line",
        GroupSupport::PhysicalAndEntity => {
            "any number of physical groups, and an entity per element"
        }
        GroupSupport::Sets => "any number of sets",
        GroupSupport::Each => "one of every kind per element",
        GroupSupport::Blocks => "a block per element, side sets",
        GroupSupport::Sections => "a section per element",
    }
}

fn names(holds: &Capabilities) -> String {
    let words = ["points", "lines", "surfaces"].into_iter().zip(holds.names);
    let held: Vec<&str> = words.filter(|(_, held)| *held).map(|(word, _)| word).collect();
    match (held.is_empty(), holds.builtin_group_kind) {
        (false, _) => joined(&held),
        (true, "") => "–".into(),
        (true, own) => format!("only of a {own}"),
    }
}

fn numbers(numbers: DataSupport, owner: &str) -> String {
    match numbers {
        DataSupport::None => "–".into(),
        DataSupport::All | DataSupport::Padded => "all".into(),
        DataSupport::Scalars => format!("one number {owner}"),
        DataSupport::Unnamed => format!("one number {owner}, without names"),
        DataSupport::Only(name) => format!("`{name}`"),
    }
}
