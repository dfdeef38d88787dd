//! Names that resemble a mistyped one.

use std::path::{Path, PathBuf};

/// Largest number of inserted, deleted, replaced or swapped letters of a mistyped name.
const MAX_EDITS: usize = 2;
/// Length of the shortest word with `MAX_EDITS`. In shorter words, one letter may be wrong.
const MIN_LENGTH: usize = 6;

/// Returns the name nearest to `word`, without regard to capital and small letters. `None` if all names differ by more than a
/// slip.
pub fn nearest(word: &str, names: impl IntoIterator<Item = String>) -> Option<String> {
    let lower = word.to_lowercase();
    let most = if word.chars().count() < MIN_LENGTH { 1 } else { MAX_EDITS };
    let edits = |name: &String| strsim::osa_distance(&lower, &name.to_lowercase());
    names.into_iter().min_by_key(edits).filter(|name| edits(name) <= most && name != word)
}

/// Returns the file nearest to a path without a file, in the directory of the path. The names may differ in their endings.
pub(crate) fn nearest_file(path: &Path) -> Option<PathBuf> {
    let parent = path.parent()?;
    let folder = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
    let entries = std::fs::read_dir(folder).ok()?.filter_map(Result::ok);
    let mut names: Vec<String> = entries
        .filter(|entry| entry.path().is_file())
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect();
    names.sort_unstable();
    let name = path.file_name()?.to_str()?;
    Some(parent.join(nearest(name, names)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_one_or_two_slips_is_found() {
        let find = |word: &str| nearest(word, ["inlet", "outlet", "a1"].map(str::to_owned));
        assert_eq!(find("Inlt").as_deref(), Some("inlet"));
        assert_eq!(find("otulet").as_deref(), Some("outlet"));
        assert_eq!(find("a2").as_deref(), Some("a1"));
        assert_eq!(find("onlat"), None);
        assert_eq!((find("wall"), find("inlet"), find("b2")), (None, None, None));
    }
}
