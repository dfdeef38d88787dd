//! Spelling rules of formats for names, and the choice of distinct names.

use std::collections::HashMap;

/// Rules of a format for the names of groups and data.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum NameRules {
    /// Any text.
    Any,
    /// Text in quotation marks, without quotation marks inside. Numbers identify groups besides names.
    Quoted,
    /// Word without blanks or percent signs. Names alone identify groups and arrays.
    Word,
    /// Name of a netCDF variable: a word without slashes that starts with a letter, a digit or an underscore.
    Variable,
    /// Word of ASCII letters, digits, underscores and hyphens that starts with a letter or an underscore. Capital and
    /// small letters are equal.
    Label,
}

impl NameRules {
    /// Returns whether names alone identify groups and arrays, and must therefore be distinct.
    pub(crate) fn is_word(self) -> bool {
        matches!(self, NameRules::Word | NameRules::Variable | NameRules::Label)
    }

    /// Returns a key that is equal for names that the format does not distinguish.
    fn key(self, name: &str) -> String {
        if self == NameRules::Label { name.to_ascii_lowercase() } else { name.to_owned() }
    }

    /// Returns a name in the format's spelling; empty or blank if no valid character remains.
    pub(crate) fn of(self, name: &str) -> String {
        match self {
            NameRules::Any => name.to_owned(),
            NameRules::Quoted => {
                let held = |c: char| match c {
                    '"' => '\'',
                    c if c.is_control() => ' ',
                    c => c,
                };
                name.chars().map(held).collect()
            }
            NameRules::Word => {
                // A percent sign starts a comment in SU2.
                let is_blank = |c: char| c.is_whitespace() || c.is_control() || c == '%';
                let words: Vec<&str> =
                    name.split(is_blank).filter(|word| !word.is_empty()).collect();
                words.join("_")
            }
            NameRules::Variable => {
                let is_blank = |c: char| c.is_whitespace() || c.is_control() || c == '/';
                let words: Vec<&str> =
                    name.split(is_blank).filter(|word| !word.is_empty()).collect();
                let word = words.join("_");
                match word.starts_with(|c: char| c.is_alphanumeric() || c == '_') || word.is_empty()
                {
                    true => word,
                    false => format!("_{word}"),
                }
            }
            NameRules::Label => {
                let is_held = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
                let word: String = name.chars().map(|c| if is_held(c) { c } else { '_' }).collect();
                match word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
                    || word.is_empty()
                {
                    true => word,
                    false => format!("set{word}"),
                }
            }
        }
    }
}

/// Returns valid names for a format. Valid names are kept; if the format identifies by name, of equal names only the
/// first. Other names are respelled, with a suffix `_2`, `_3` and so on that makes them differ from `taken` and from
/// all results. `spare(i)` replaces name `i` if its respelling is blank.
pub(crate) fn distinct(
    names: &[&str],
    spelling: NameRules,
    taken: &[&str],
    spare: impl Fn(usize) -> String,
) -> Vec<String> {
    // Keys of all names in use, each with the suffix for the next equal name.
    let key = |name: &str| spelling.key(name);
    let mut given: HashMap<String, usize> = taken.iter().map(|&name| (key(name), 2)).collect();
    let mut spelled: Vec<Option<String>> = Vec::with_capacity(names.len());
    for &name in names {
        let stays = spelling.of(name) == name && !name.is_empty();
        let is_new = stays && given.insert(key(name), 2).is_none();
        let keeps = is_new || (stays && !spelling.is_word());
        spelled.push(keeps.then(|| name.to_owned()));
    }
    let name = |(at, kept): (usize, Option<String>)| {
        kept.unwrap_or_else(|| {
            let new = match spelling.of(names[at]) {
                new if new.trim().is_empty() => spare(at),
                new => new,
            };
            let Some(next) = given.get(&key(&new)).copied() else {
                given.insert(key(&new), 2);
                return new;
            };
            let free = (next..).find(|end| !given.contains_key(&key(&format!("{new}_{end}"))));
            let end = free.unwrap_or(next);
            let other = format!("{new}_{end}");
            given.insert(key(&new), end + 1);
            given.insert(key(&other), 2);
            other
        })
    };
    spelled.into_iter().enumerate().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spelled(names: &[&str], spelling: NameRules) -> Vec<String> {
        distinct(names, spelling, &["x"], |at| at.to_string())
    }

    #[test]
    fn names_that_can_stay_do_and_all_others_differ_from_them() {
        let names = ["a b", "a_b", "a\tb", "wall", "wall", "a_b_2", "50%", "", " ", "x"];
        let words = ["a_b_3", "a_b", "a_b_4", "wall", "wall_2", "a_b_2", "50", "7", "8", "x_2"];
        assert_eq!(spelled(&names, NameRules::Word), words);
    }

    #[test]
    fn variables_have_no_slash_and_start_with_a_letter_or_digit() {
        let names = ["a/b", "a_b", "/", "-x", "7", "h\u{f6}he", "T (K)", "x", ""];
        let words = ["a_b_2", "a_b", "2", "_-x", "7", "h\u{f6}he", "T_(K)", "x_2", "8"];
        assert_eq!(spelled(&names, NameRules::Variable), words);
    }

    #[test]
    fn labels_are_plain_words_whatever_their_capitals() {
        let names = ["Wall", "wall", "a b", "a,b", "7", "-x", "_5", "h\u{f6}he", "", "x"];
        let labels = ["Wall", "wall_2", "a_b", "a_b_2", "set7", "set-x", "_5", "h_he", "8", "x_2"];
        assert_eq!(spelled(&names, NameRules::Label), labels);
    }

    /// Numbers identify groups besides quoted names, and therefore equal names stay.
    #[test]
    fn only_quotation_marks_are_changed_between_them() {
        let names = ["a\"b", "a'b", "wall", "wall", "in let", "a\nb"];
        let quoted = ["a'b_2", "a'b", "wall", "wall", "in let", "a b"];
        assert_eq!(spelled(&names, NameRules::Quoted), quoted);
    }

    #[test]
    fn many_groups_of_one_name_differ() {
        let names = vec!["wall"; 100_000];
        let words = spelled(&names, NameRules::Word);
        assert_eq!(words[99_999], "wall_100000");
    }
}
