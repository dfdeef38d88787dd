//! Groups of a mesh that the values of options name.

use mesh_io::{Group, Groups};

use crate::error::CliError;
use crate::load::LoadedMesh;

/// Returns the groups that the value of an option names, separated by commas. Each group is paired with the name used in
/// the value.
pub(super) fn named<'t, 'g>(
    file: &LoadedMesh,
    groups: &'g Groups,
    option: &str,
    text: &'t str,
) -> Result<Vec<(&'t str, &'g Group)>, CliError> {
    // A group's name may contain commas.
    let ends = |name: &str| name.contains(',') && text.ends_with(name);
    if groups.iter().any(|group| group.name.as_deref().is_some_and(ends))
        && let Ok(group) = groups.find(text)
    {
        return Ok(vec![(text, group)]);
    }
    let find = |name: &'t str| match groups.find(name.trim()) {
        Ok(group) => Ok((name.trim(), group)),
        Err(error) => Err(refusal(file, option, &error.to_string())),
    };
    text.split(',').map(find).collect()
}

/// Returns the error for an option whose value does not fit the groups of a mesh.
pub(super) fn refusal(file: &LoadedMesh, option: &str, problem: &str) -> CliError {
    let path = file.source.path().display();
    CliError::input(format!("{path}: {option}: {problem}"))
        .with_remedy("`gpu-smooth groups` lists what can be named")
}
