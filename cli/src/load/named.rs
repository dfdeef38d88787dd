//! Groups of a mesh that the values of options name.

use mesh_io::{Group, GroupError, Groups};

use crate::error::CliError;
use crate::load::LoadedMesh;
use crate::similar;

/// Remedy of an unknown name.
const LIST: &str = "`gpu-smooth groups` lists what can be named";

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
    let mut found = Vec::new();
    for given in text.split(',') {
        // The name in the file may begin or end with blanks.
        let name = match groups.find(given) {
            Err(GroupError::Unknown { .. }) => given.trim(),
            _ => given,
        };
        match groups.find(name) {
            Ok(group) => found.push((name, group)),
            Err(error) => match of_one_name(groups, &error) {
                Some(all) => found.extend(all.into_iter().map(|group| (name, group))),
                None => return Err(unknown(file, groups, option, &error)),
            },
        }
    }
    Ok(found)
}

/// Returns the groups that share an ambiguous name, if they differ in their tags alone: solvers take groups of one name as
/// one. `None` for other errors, and for groups of several kinds or dimensions.
fn of_one_name<'g>(groups: &'g Groups, error: &GroupError) -> Option<Vec<&'g Group>> {
    let GroupError::Ambiguous { candidates, .. } = error else { return None };
    let all: Vec<&Group> =
        candidates.iter().map(|own| groups.find(own).ok()).collect::<Option<_>>()?;
    // A name without elements adds nothing.
    let is_empty = |group: &&Group| group.vertices().is_empty();
    let all: Vec<&Group> = match all.iter().all(is_empty) {
        true => all,
        false => all.into_iter().filter(|group| !is_empty(group)).collect(),
    };
    let identity = |group: &&'g Group| (group.name.clone(), group.kind.clone(), group.dimension);
    let first = all.first().map(identity)?;
    (first.0.is_some() && all.iter().all(|group| identity(group) == first)).then_some(all)
}

/// Returns the error for a name without a group, with the name that was probably meant.
fn unknown(file: &LoadedMesh, groups: &Groups, option: &str, error: &GroupError) -> CliError {
    let refused = refusal(file, option, &error.to_string());
    let GroupError::Unknown { name, known } = error else { return refused };
    // Names that groups share are not among the known ones, which identify groups.
    let names = groups.iter().filter_map(|group| group.name.clone());
    match similar::nearest(name, names.chain(known.iter().cloned())) {
        Some(meant) => refused.with_remedy(format!("Did you mean {meant}? {LIST}")),
        None => refused,
    }
}

/// Returns the error for an option whose value does not fit the groups of a mesh.
pub(super) fn refusal(file: &LoadedMesh, option: &str, problem: &str) -> CliError {
    let path = file.source.path().display();
    CliError::input(format!("{path}: {option}: {problem}")).with_remedy(LIST)
}
