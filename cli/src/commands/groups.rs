//! The command `gpu-smooth groups MESH`, which lists the group names of a mesh.

use mesh_io::{Group, Groups};
use serde_json::json;
use unicode_width::UnicodeWidthStr;

use crate::args::GroupsArgs;
use crate::error::CliError;
use crate::load::streams::read;
use crate::render::columns::{left, right};
use crate::request::ReadRequest;
use crate::terminal::tell;

/// Prints the groups of a mesh with the names that options accept, and the names of vertex data.
pub(crate) fn run(args: &GroupsArgs) -> Result<(), CliError> {
    let file = read(&args.mesh, &ReadRequest::from(&args.reading).taking_quadrilaterals())?;
    let groups = file.groups()?;
    let (path, format) = (file.source.path().display(), file.source.format());
    if args.json {
        let spellings = groups.unique_names();
        let list: Vec<_> = groups
            .iter()
            .zip(&spellings)
            .map(|(group, spelling)| as_json(group, spelling))
            .collect();
        let value = json!({
            "file": path.to_string(),
            "format": format.to_string(),
            "groups": list,
            "data": file.source.data_names(),
        });
        tell::say_data(&format!("{value:#}"));
        return Ok(());
    }
    tell::say(&format!("{path}: {format}"));
    match groups.is_empty() {
        true => tell::say("the file names no groups"),
        false => tell::say(&table(groups)),
    }
    if !file.source.data_names().is_empty() {
        tell::say(&format!(
            "data of vertices (--interpolate): {}",
            file.source.data_names().join(", ")
        ));
    }
    Ok(())
}

fn as_json(group: &Group, spelling: &str) -> serde_json::Value {
    json!({
        "group": spelling,
        "what": group.kind,
        "kind": group.dimension_name(),
        "dimension": group.dimension,
        "name": group.name,
        "tag": group.tag,
        "points": group.points,
        "lines": group.lines,
        "triangles": group.triangles().len(),
        "quadrilaterals": group.quadrilaterals().len(),
        "vertices": group.vertices().len(),
    })
}

/// Returns a table with a row for each group. Columns of zeros are omitted, as is the column of names unless several groups
/// share a name, so that their tags stand for them.
fn table(groups: &Groups) -> String {
    let spellings = groups.unique_names();
    let is_hidden = |(group, spelling): (&Group, &String)| {
        group.name.as_ref().is_some_and(|name| !spelling.ends_with(name.as_str()))
    };
    let has_names = groups.iter().zip(&spellings).any(is_hidden);
    let texts = |group: &Group, spelling: &String| {
        let tag = group.tag.map_or_else(|| "-".to_owned(), |tag| tag.to_string());
        let name = has_names.then(|| group.name.as_deref().unwrap_or("-").to_owned());
        let kind = format!("{} {}", group.kind, group.dimension_name());
        [Some(spelling.clone()), name, Some(kind), Some(tag)].into_iter().flatten()
    };
    let counts = |group: &Group| {
        let (triangles, vertices) = (group.triangles().len(), group.vertices().len());
        [group.points, group.lines, triangles, group.quadrilaterals().len(), vertices]
    };
    let is_used = |column: usize| groups.iter().any(|group| counts(group)[column] > 0);
    let names = ["points", "lines", "triangles", "quadrilaterals", "vertices"];
    let used: Vec<usize> = (0..names.len()).filter(|&column| is_used(column)).collect();
    let head = [Some("group"), has_names.then_some("name"), Some("what"), Some("tag")];
    let words = 2 + usize::from(has_names);
    let head = head.into_iter().flatten().map(str::to_owned);
    let mut rows: Vec<Vec<String>> =
        vec![head.chain(used.iter().map(|&column| names[column].to_owned())).collect()];
    for (group, spelling) in groups.iter().zip(&spellings) {
        let counts = counts(group);
        let numbers = used.iter().map(|&column| counts[column].to_string());
        rows.push(texts(group, spelling).chain(numbers).collect());
    }
    let width = |column: usize| rows.iter().map(|row| row[column].width()).max();
    let widths: Vec<usize> = (0..rows[0].len()).filter_map(width).collect();
    let line = |row: &Vec<String>| {
        let cell = |(column, text): (usize, &String)| match column {
            // Words are aligned left, numbers right.
            column if column < words => left(text, widths[column]),
            _ => right(text, widths[column]),
        };
        row.iter().enumerate().map(cell).collect::<Vec<_>>().join("  ")
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}
