//! Makes the table of conversions in docs/formats.md from what each target holds.

use super::targets::TARGETS;
use crate::export::capabilities::{Elements, Groups, Holds, Numbers};
use crate::format::Format;
use crate::registry::Family;
use std::fmt::Write;

/// Returns the name of a format in conversions, if it is a target.
pub(crate) fn name_of(format: Format) -> Option<String> {
    let target = TARGETS.iter().find(|target| target.format == format);
    target.map(|target| format!("`{}`", target.name))
}

/// Makes a row for each target.
pub(crate) fn targets() -> String {
    let mut table = "| `--to` | ending | elements besides triangles | z | own numbers of vertices | groups of elements | \
                     names of groups of | groups of vertices | data of vertices | data of elements |\n\
                     |---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for target in TARGETS {
        let holds = &target.holds;
        let ending = Family::of(target.format).endings[0];
        let yes = |held: bool| if held { "yes" } else { "–" };
        writeln!(
            table,
            "| `{}` | `{ending}` | {} | {} | {} | {} | {} | {} | {} | {} |",
            target.name,
            elements(holds),
            yes(holds.heights),
            yes(holds.labels),
            groups(holds.groups),
            names(holds),
            match (holds.vertex_groups, holds.groups) {
                _ if holds.vertex_sets => "node sets, with names",
                (true, Groups::Blocks) => "node sets, with names",
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

fn elements(holds: &Holds) -> String {
    let held = |elements, all, some| match elements {
        Elements::None => None,
        Elements::All => Some(all),
        Elements::OfGroups => Some(some),
    };
    let words = [
        held(holds.points, "points", "points of groups"),
        held(holds.lines, "lines", "lines of groups"),
        holds.quadrilaterals.then_some("quadrilaterals"),
        holds.polygons.then_some("polygons"),
    ];
    joined(&words.into_iter().flatten().collect::<Vec<_>>())
}

fn groups(groups: Groups) -> &'static str {
    match groups {
        Groups::None => "–",
        Groups::One => "one per element",
        Groups::OneOfLines => "one per line",
        Groups::PhysicalAndEntity => "a physical group and an entity per element",
        Groups::Each => "one of every kind per element",
        Groups::Blocks => "a block per element, side sets",
    }
}

fn names(holds: &Holds) -> String {
    let words = ["points", "lines", "surfaces"].into_iter().zip(holds.names);
    let held: Vec<&str> = words.filter(|(_, held)| *held).map(|(word, _)| word).collect();
    match (held.is_empty(), holds.own) {
        (false, _) => joined(&held),
        (true, "") => "–".into(),
        (true, own) => format!("only of a {own}"),
    }
}

fn numbers(numbers: Numbers, owner: &str) -> String {
    match numbers {
        Numbers::None => "–".into(),
        Numbers::All => "all".into(),
        Numbers::Scalars => format!("one number {owner}"),
        Numbers::Unnamed => format!("one number {owner}, without names"),
        Numbers::Only(name) => format!("`{name}`"),
    }
}
