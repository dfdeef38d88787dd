//! Splits an input file into keyword blocks: a keyword, its parameters and its data lines.

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::text::token::{integer, key_value, line_end, unquoted};
use std::ops::Range;

/// A keyword of an input file, with its parameters and data lines.
pub(super) struct Block<'a> {
    /// The keyword in capital letters and without blanks, since Abaqus ignores case and blanks in keywords.
    pub(super) keyword: Vec<u8>,
    /// Pairs of a parameter's name and value: names in capital letters without blanks, values without quotation marks.
    /// A parameter without `=` has an empty value.
    parameters: Vec<(Vec<u8>, &'a [u8])>,
    /// The offset of the asterisk that starts the keyword.
    pub(super) at: usize,
    /// The byte range of the data lines: from the line feed after the keyword to the next keyword's asterisk, or to the
    /// end of the file.
    pub(super) data: Range<usize>,
}

impl<'a> Block<'a> {
    pub(super) fn is(&self, keyword: &str) -> bool {
        self.keyword == keyword.as_bytes()
    }

    /// Returns the value of a parameter: empty if the parameter has no value, `None` if the keyword lacks the
    /// parameter.
    pub(super) fn parameter(&self, name: &str) -> Option<&'a [u8]> {
        let own = self.parameters.iter().find(|(own, _)| own == name.as_bytes());
        own.map(|&(_, value)| value)
    }

    /// Returns the value of a parameter; `None` if the value is empty or the keyword lacks the parameter.
    pub(super) fn name(&self, parameter: &str) -> Option<&'a [u8]> {
        self.parameter(parameter).filter(|name| !name.is_empty())
    }

    /// Makes an error located at the keyword's line.
    #[cold]
    pub(super) fn error(
        &self,
        source: &Source,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> ReadError {
        Cursor::on_line_of(source, self.at).error(problem, remedy)
    }

    /// Lists the first items of the data lines that are whole numbers.
    pub(super) fn first_numbers(&self, source: &'a Source) -> impl Iterator<Item = u64> {
        let lines = source.bytes[self.data.clone()].split(|&byte| byte == b'\n');
        lines.filter_map(|line| integer(line.split(|&byte| byte == b',').next()?.trim_ascii()))
    }

    /// Lists the comma-separated items of the data lines, trimmed of blanks. A flag marks the last item of each line.
    /// Comment lines, which start with an asterisk, are skipped.
    pub(super) fn items(&self, source: &'a Source) -> impl Iterator<Item = (&'a [u8], bool)> {
        let lines = source.bytes[self.data.clone()].split(|&byte| byte == b'\n');
        let lines = lines.filter(|line| !line.trim_ascii_start().starts_with(b"*"));
        lines.flat_map(|line| {
            let mut items = split(line).peekable();
            std::iter::from_fn(move || {
                let item = items.next()?;
                Some((item, items.peek().is_none()))
            })
        })
    }
}

/// Finds the keyword blocks of a file. An asterisk starts a keyword if only blanks precede the asterisk on its line.
/// Two asterisks start a comment.
pub(super) fn blocks(source: &Source) -> Vec<Block<'_>> {
    let (bytes, begin) = (&source.bytes[..], source.begin());
    let opens = |&at: &usize| {
        let before = bytes[begin..at].iter().rev().find(|byte| !matches!(byte, b' ' | b'\t'));
        bytes.get(at + 1) != Some(&b'*') && before.is_none_or(|&byte| byte == b'\n')
    };
    let mut blocks: Vec<Block<'_>> = Vec::new();
    for at in memchr::memchr_iter(b'*', &bytes[begin..]).map(|at| at + begin).filter(opens) {
        if let Some(last) = blocks.last_mut() {
            last.data.end = at;
        }
        blocks.push(block(bytes, at));
    }
    blocks
}

/// Reads the keyword whose asterisk is at the offset `at`. A keyword line that ends in a comma continues on the next
/// line; comment lines between are skipped. The data range of the block extends to the end of the file, until the
/// caller finds the next keyword.
fn block(bytes: &[u8], at: usize) -> Block<'_> {
    let mut end = line_end(bytes, at);
    let mut lines = vec![&bytes[at + 1..end]];
    while end < bytes.len() && lines[lines.len() - 1].trim_ascii_end().ends_with(b",") {
        let next = line_end(bytes, end);
        let line = bytes[end..next].trim_ascii_start();
        match line.starts_with(b"**") {
            true => {}
            false if line.starts_with(b"*") => break,
            false => lines.push(&bytes[end..next]),
        }
        end = next;
    }
    let mut pieces = lines.into_iter().flat_map(split);
    let keyword = pieces.next().map(plain).unwrap_or_default();
    let parameters = pieces.filter(|piece| !piece.is_empty()).map(|piece| {
        let (name, value) = key_value(piece);
        (plain(name), unquoted(value))
    });
    let parameters = parameters.collect();
    let start = end - usize::from(bytes[..end].ends_with(b"\n"));
    Block { keyword, parameters, at, data: start..bytes.len() }
}

/// Splits a line at the commas outside quotation marks, and trims blanks around the items.
fn split(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut is_quoted = false;
    let pieces = line.split(move |&byte| {
        is_quoted ^= byte == b'"';
        byte == b',' && !is_quoted
    });
    pieces.map(<[u8]>::trim_ascii)
}

/// Returns a word in capital letters and without blanks.
fn plain(word: &[u8]) -> Vec<u8> {
    let letters = word.iter().filter(|byte| !byte.is_ascii_whitespace());
    letters.map(u8::to_ascii_uppercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn keywords_are_found_with_parameters_and_data() {
        let text = b"** *NODE\n 1, 2\n\t*Node , nset = \"A, b\" ,\n** between\n system=R\r\n1, 0.\n** 2\n*Solid Section\n\
            *element,\ttype=CPS3,\n*END";
        let source = Source::new(Path::new("a.inp"), text.to_vec()).unwrap();
        let all = blocks(&source);
        let keywords: Vec<_> = all.iter().map(|block| &block.keyword[..]).collect();
        assert_eq!(keywords, [&b"NODE"[..], b"SOLIDSECTION", b"ELEMENT", b"END"]);
        assert_eq!(all[0].parameter("NSET"), Some(&b"A, b"[..]));
        assert_eq!(all[0].parameter("SYSTEM"), Some(&b"R"[..]));
        assert_eq!(
            (all[0].parameter("INPUT"), all[2].parameter("TYPE")),
            (None, Some(&b"CPS3"[..]))
        );
        let data: Vec<_> = all.iter().map(|block| &text[block.data.clone()]).collect();
        assert_eq!(data, [&b"\n1, 0.\n** 2\n"[..], b"\n", b"\n", b""]);
        let items: Vec<_> = all[0].items(&source).filter(|(item, _)| !item.is_empty()).collect();
        assert_eq!(items, [(&b"1"[..], false), (b"0.", true)]);
    }
}
