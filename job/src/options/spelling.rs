//! The spelling of options and their values in the front ends.

use gpu_smooth::Metric;

/// The front end in whose words an option is spelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spelling {
    /// The command line: `--guard worst`.
    CommandLine,
    /// The Python package: `guard="worst"`.
    Python,
}

impl Spelling {
    /// Spells an option of the table, alone or with a value as in `guard=worst`.
    pub fn option(self, option: &str) -> String {
        let (name, value) = option.split_once('=').map_or((option, None), |(n, v)| (n, Some(v)));
        match (self, value) {
            (Self::CommandLine, None) => format!("--{name}"),
            (Self::CommandLine, Some(value)) => format!("--{name} {value}"),
            (Self::Python, None) => name.replace('-', "_"),
            (Self::Python, Some(value)) => format!("{}=\"{value}\"", name.replace('-', "_")),
        }
    }

    /// Spells a text of the table. Options stand in braces, with or without a value. Other words in braces are `IN`, the mesh
    /// before the run, and lists of metrics.
    pub(super) fn text(self, text: &str) -> String {
        let mut spelled = String::new();
        let mut rest = text;
        while let Some((before, (word, after))) = rest
            .split_once('{')
            .and_then(|(before, braced)| Some((before, braced.split_once('}')?)))
        {
            spelled += before;
            spelled += &self.word(word);
            rest = after;
        }
        spelled + rest
    }

    fn word(self, word: &str) -> String {
        match (word, self) {
            ("IN", Self::CommandLine) => "IN".to_owned(),
            ("IN", Self::Python) => "the given mesh".to_owned(),
            ("all metrics", _) => metrics(|_| true, ", "),
            ("metrics without corrections", _) => {
                metrics(|metric| !metric.supports_multilevel(), " or ")
            }
            (option, Self::CommandLine) => self.option(option),
            (option, Self::Python) => format!("`{}`", self.option(option)),
        }
    }
}

/// Lists the metrics for which `is_wanted` is true.
fn metrics(is_wanted: impl Fn(&Metric) -> bool, separator: &str) -> String {
    let names: Vec<_> =
        Metric::ALL.iter().filter(|metric| is_wanted(metric)).map(|metric| metric.name()).collect();
    names.join(separator)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_in_braces_are_spelled_by_each_front_end() {
        let text = "as {max-move} with {guard=worst} of {IN}";
        let spelled = Spelling::CommandLine.text(text);
        assert_eq!(spelled, "as --max-move with --guard worst of IN");
        let spelled = Spelling::Python.text(text);
        assert_eq!(spelled, "as `max_move` with `guard=\"worst\"` of the given mesh");
        assert_eq!(Spelling::Python.text("an open { brace"), "an open { brace");
    }
}
