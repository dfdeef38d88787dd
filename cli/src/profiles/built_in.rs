//! The profiles of the program, and the choice between them and a file of the user.

use std::path::{Path, PathBuf};

use crate::error::CliError;
use crate::profiles::profile::Profile;
use crate::similar;
use mesh_io::ReadError;

/// The names of the program's profiles, each with its file.
const BUILT_IN: [(&str, &str); 7] = [
    ("adcirc", include_str!("adcirc.toml")),
    ("dflowfm", include_str!("dflowfm.toml")),
    ("fea", include_str!("fea.toml")),
    ("fvcom", include_str!("fvcom.toml")),
    ("schism", include_str!("schism.toml")),
    ("swan", include_str!("swan.toml")),
    ("telemac", include_str!("telemac.toml")),
];

/// The profile that `--for` names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ProfileSource {
    /// One of the program's profiles, by its index.
    BuiltIn(usize),
    /// A file of the user, whose name ends in `.toml`.
    File(PathBuf),
}

/// Returns the names of the program's profiles.
pub(crate) fn names() -> Vec<&'static str> {
    BUILT_IN.iter().map(|(name, _)| *name).collect()
}

impl ProfileSource {
    /// Parses the name of a profile, or of a file that ends in `.toml`.
    ///
    /// # Errors
    /// A text for the user with the names of all profiles.
    pub(crate) fn of(text: &str) -> Result<Self, String> {
        if Path::new(text).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
            return Ok(Self::File(text.into()));
        }
        let name = text.trim().to_ascii_lowercase();
        if let Some(index) = BUILT_IN.iter().position(|(known, _)| *known == name) {
            return Ok(Self::BuiltIn(index));
        }
        let meant = similar::nearest(&name, names().into_iter().map(str::to_owned));
        let meant = meant.map(|meant| format!(". Did you mean {meant}?")).unwrap_or_default();
        Err(format!(
            "no profile is called '{text}'; there are {}, or a file that ends in .toml{meant}",
            names().join(", ")
        ))
    }

    /// Reads the profile.
    ///
    /// # Errors
    /// An error of the kind [`ErrorKind::Input`](crate::error::ErrorKind::Input) if the file is missing or damaged.
    pub(crate) fn read(&self) -> Result<Profile, CliError> {
        match self {
            Self::BuiltIn(index) => {
                let (name, text) = BUILT_IN[*index];
                Profile::parse(text).map_err(|problem| {
                    CliError::input(problem.message).within(&format!("profile {name}"))
                })
            }
            Self::File(path) => {
                let text = std::fs::read_to_string(path).map_err(|source| {
                    let remedy = match source.kind() {
                        std::io::ErrorKind::NotFound => "Check the name",
                        _ => "docs/solvers.md describes the file",
                    };
                    ReadError::Io { path: path.clone(), source, remedy: remedy.into() }
                })?;
                Profile::parse(&text).map_err(|problem| {
                    let line = problem.line.map(|line| format!(":{line}")).unwrap_or_default();
                    CliError::input(problem.message)
                        .within(&format!("{}{line}", path.display()))
                        .with_remedy("docs/solvers.md describes the file")
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profiles::{Elements, Limit};

    #[test]
    fn each_limit_of_the_program_has_a_source_and_is_in_the_document() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let document = std::fs::read_to_string(root.join("../docs/solvers.md")).unwrap();
        // Lines of the document are broken anywhere.
        let document = document.split_whitespace().collect::<Vec<_>>().join(" ");
        for (index, (name, _)) in BUILT_IN.iter().enumerate() {
            let profile = ProfileSource::BuiltIn(index).read().unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(&profile.name, name);
            assert!(!profile.title.is_empty() && !profile.limits.is_empty(), "{name}");
            assert!(document.contains(&format!("`{name}`")), "docs/solvers.md lacks `{name}`");
            for Limit { quantity, elements, warn, fail, source } in &profile.limits {
                if warn.is_none() && fail.is_none() {
                    let row = format!("| `{quantity}` | | | listed |");
                    assert!(document.contains(&row), "docs/solvers.md lacks the row\n{row}");
                    continue;
                }
                assert!(source.len() > 10, "{name}: {quantity} has no source");
                let range = |range: &Option<crate::limits::Threshold>| {
                    range.as_ref().map(|range| format!("`{}`", range.range())).unwrap_or_default()
                };
                let of = match elements {
                    Elements::Triangles => "",
                    Elements::Quadrilaterals => " of quadrilaterals",
                };
                let row =
                    format!("| `{quantity}`{of} | {} | {} | {source} |", range(warn), range(fail));
                let row = row.replace("|  |", "| |");
                assert!(document.contains(&row), "docs/solvers.md lacks the row\n{row}");
            }
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_all_names_and_the_nearest() {
        let error = ProfileSource::of("dflow-fm").unwrap_err();
        assert!(error.contains("there are adcirc, dflowfm, fea, "), "{error}");
        assert!(error.ends_with("Did you mean dflowfm?"), "{error}");
        assert!(!ProfileSource::of("comsol").unwrap_err().contains("Did you mean"));
        assert_eq!(ProfileSource::of("SWAN").unwrap().read().unwrap().name, "swan");
        assert_eq!(ProfileSource::of("my.toml"), Ok(ProfileSource::File("my.toml".into())));
    }
}
