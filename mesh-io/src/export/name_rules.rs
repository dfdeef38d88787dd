//! Spelling rules of formats for names, and the choice of distinct names.

use std::collections::HashMap;

/// Rules of a format for the names of groups and data.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum NameRules {
    /// Any text.
    Any,
    /// Text in quotation marks, without quotation marks inside. Numbers identify groups besides names.
    Quoted,
    /// Text without blanks at its ends. Numbers identify groups besides names.
    Trimmed,
    /// Word without blanks or percent signs. Names alone identify groups and arrays.
    Word,
    /// Name of a netCDF variable: a word without slashes that starts with a letter, a digit or an underscore.
    Variable,
    /// Word of ASCII letters, digits, underscores and hyphens that starts with a letter or an underscore. Capital and
    /// small letters are equal.
    Label,
    /// Text of at most 80 bytes, without blanks at its ends. Names alone identify groups.
    Text80,
    /// Text of at most 32 bytes without slashes, and without blanks at its ends. Names alone identify groups and arrays.
    Node32,
}

impl NameRules {
    /// Returns whether names alone identify groups and arrays, and must therefore be distinct.
    pub(crate) fn is_word(self) -> bool {
        !matches!(self, NameRules::Any | NameRules::Quoted | NameRules::Trimmed)
    }

    /// Returns a key that is equal for names that the format does not distinguish.
    fn key(self, name: &str) -> String {
        if self == NameRules::Label { name.to_ascii_lowercase() } else { name.to_owned() }
    }

    /// Returns the maximum length of a name in bytes.
    fn limit(self) -> usize {
        match self {
            NameRules::Text80 => 80,
            NameRules::Node32 => 32,
            _ => usize::MAX,
        }
    }

    /// Cuts a name to a length in bytes, and removes a blank at the new end.
    fn cut(name: &str, limit: usize) -> &str {
        let ends = (0..=limit.min(name.len())).rev();
        let end = ends.into_iter().find(|&end| name.is_char_boundary(end));
        name[..end.unwrap_or(0)].trim_end()
    }

    /// Returns a name in the format's spelling; empty or blank if no valid character remains.
    pub(crate) fn of(self, name: &str) -> String {
        match self {
            NameRules::Any => name.to_owned(),
            NameRules::Trimmed => name.trim_ascii().to_owned(),
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
            NameRules::Text80 | NameRules::Node32 => {
                let held = |c: char| match c {
                    '/' if self == NameRules::Node32 => '_',
                    c if c.is_control() => ' ',
                    c => c,
                };
                let text: String = name.chars().map(held).collect();
                match NameRules::cut(text.trim(), self.limit()) {
                    // These names of a node would be steps of a path.
                    "." | ".." if self == NameRules::Node32 => "_".to_owned(),
                    text => text.to_owned(),
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
            let ended = |end: usize| {
                let end = format!("_{end}");
                let start = NameRules::cut(&new, spelling.limit().saturating_sub(end.len()));
                format!("{start}{end}")
            };
            let free = (next..).find(|&end| !given.contains_key(&key(&ended(end))));
            let end = free.unwrap_or(next);
            let other = ended(end);
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

    #[test]
    fn long_names_are_cut_and_still_differ() {
        let long = format!("{}\u{f6}", "a".repeat(31));
        let names = [&long, &"a".repeat(40), &"a".repeat(31), "in/let", " b\t", "..", "", "x"];
        let (cut, ended) = ("a".repeat(32), format!("{}_2", "a".repeat(30)));
        let nodes = [&ended, &cut, &"a".repeat(31), "in_let", "b", "_", "6", "x_2"];
        assert_eq!(spelled(&names, NameRules::Node32), nodes);
        let texts = ["in/let", "\u{f6}".repeat(41).as_str(), ".."].map(str::to_owned);
        let kept = ["in/let", "\u{f6}".repeat(40).as_str(), ".."].map(str::to_owned);
        assert_eq!(spelled(&texts.each_ref().map(String::as_str), NameRules::Text80), kept);
    }

    /// Numbers identify groups besides quoted names, and therefore equal names stay.
    #[test]
    fn only_quotation_marks_are_changed_between_them() {
        let names = ["a\"b", "a'b", "wall", "wall", "in let", "a\nb"];
        let quoted = ["a'b_2", "a'b", "wall", "wall", "in let", "a b"];
        assert_eq!(spelled(&names, NameRules::Quoted), quoted);
    }

    #[test]
    fn blanks_at_the_ends_alone_are_removed() {
        let names = [" wall", "wall", "in let\t", "wall", " ", "a/b"];
        let trimmed = ["wall_2", "wall", "in let", "wall", "4", "a/b"];
        assert_eq!(spelled(&names, NameRules::Trimmed), trimmed);
    }

    #[test]
    fn many_groups_of_one_name_differ() {
        let names = vec!["wall"; 100_000];
        let words = spelled(&names, NameRules::Word);
        assert_eq!(words[99_999], "wall_100000");
    }
}
