//! Lines that are sides of elements, and the losses of a mesh in a format with element blocks (Exodus).

use super::content::{Content, DataArray};
use super::group_numbers::GroupNumbers;
use crate::visit::items::CellKind;
use std::collections::HashSet;

/// Returns the two ends of a line in ascending order.
pub(crate) fn pair(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// Returns the lines for side sets: sides of triangles or quadrilaterals, for which `group` returns a group outside of
/// blocks.
pub(crate) fn sides(content: &Content, group: impl Fn(usize) -> Option<u32>) -> HashSet<usize> {
    let mut of_elements = HashSet::new();
    for kind in [CellKind::Triangle, CellKind::Quadrilateral] {
        for corners in content.cells.all(kind).map(|cell| content.cells.of(cell)) {
            let next = corners.iter().cycle().skip(1);
            of_elements.extend(corners.iter().zip(next).map(|(&a, &b)| pair(a, b)));
        }
    }
    // Lines of a block in the original file stay in their block.
    let is_of_block = |group: u32| content.groups[group as usize].kind == "block";
    let is_side = |&line: &usize| match (group(line), content.cells.of(line)) {
        (Some(group), &[a, b]) => !is_of_block(group) && of_elements.contains(&pair(a, b)),
        _ => false,
    };
    content.cells.all(CellKind::Line).filter(is_side).collect()
}

/// Appends the losses of a mesh whose elements stand group by group to `lost`, one line each.
pub(crate) fn lost_in_blocks(content: &Content, lost: &mut Vec<String>) {
    let tags = GroupNumbers::new(content, false);
    let group = |cell: usize| tags.group(content, cell);
    let kinds = [CellKind::Triangle, CellKind::Quadrilateral];
    let of_kinds = kinds.map(|kind| content.cells.all(kind).map(group).collect::<Vec<_>>());
    for (kind, groups) in kinds.iter().zip(&of_kinds) {
        let mut runs = groups.chunk_by(|a, b| a == b).map(|run| run[0]);
        let mut seen = HashSet::new();
        if !runs.all(|own| seen.insert(own)) {
            lost.push(format!("the order of {}s, which stand group by group", kind.name()));
        }
    }
    let [triangles, quadrilaterals] =
        of_kinds.map(|groups| groups.into_iter().flatten().collect::<HashSet<_>>());
    if !triangles.is_disjoint(&quadrilaterals) {
        lost.push("that groups have triangles and quadrilaterals, which become blocks each".into());
    }
}

/// Appends the loss of data of lines that become sides to `lost`.
pub(crate) fn lost_of_sides(content: &Content, lost: &mut Vec<String>) {
    let tags = GroupNumbers::new(content, false);
    let sides = sides(content, |cell| tags.group(content, cell));
    let has_value = |data: &&DataArray| {
        let each = data.components.max(1);
        let own = |&line: &usize| data.values[line * each..(line + 1) * each].iter();
        sides.iter().flat_map(own).any(|value| !value.is_nan())
    };
    let kept = content.cell_data.iter().filter(|data| data.components == 1);
    if let Some(data) = kept.into_iter().find(has_value) {
        lost.push(format!("data of lines that become sides: {}", data.name));
    }
}
