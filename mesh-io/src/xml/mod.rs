//! Start tags of XML files in file order, with their offsets, attributes and text.

use crate::content::decoded::decoded;
use crate::disk::source::Source;
use crate::error::{Location, ReadError};
use crate::text::cursor::CORRECT;
use crate::text::token::{on_one_line, quoted};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::borrow::Cow;
use std::ops::Range;

/// Limit on nested elements. VTK and XDMF nest at most ten, and each open element takes memory.
const MAX_DEPTH: usize = 100;

/// Iterator over the start tags of a document, with the elements that are open.
pub(crate) struct XmlTags<'a> {
    source: &'a Source,
    /// Offset of the first byte after a byte order mark, where the parser starts.
    begin: usize,
    reader: Reader<&'a [u8]>,
    /// The tags of the elements around the next tag, the innermost last.
    open: Vec<XmlTag<'a>>,
    /// The tag that was returned last, if its element has content and may enclose the next tag.
    last: Option<XmlTag<'a>>,
}

/// A start tag, with its range in the file.
#[derive(Clone)]
pub(crate) struct XmlTag<'a> {
    source: &'a Source,
    start: BytesStart<'a>,
    /// The range of the tag in the file, with its angle brackets.
    range: Range<usize>,
}

impl<'a> XmlTags<'a> {
    pub(crate) fn new(source: &'a Source) -> XmlTags<'a> {
        let begin = source.begin();
        let mut reader = Reader::from_reader(&source.bytes[begin..]);
        reader.config_mut().check_end_names = false;
        XmlTags { source, begin, reader, open: Vec::new(), last: None }
    }

    /// Returns the next start tag; `None` at the end of the file.
    ///
    /// # Errors
    /// If the file is not XML, or if elements are nested too deep.
    pub(crate) fn next(&mut self) -> Result<Option<XmlTag<'a>>, ReadError> {
        self.open.extend(self.last.take());
        loop {
            let at = self.at();
            let event = self.reader.read_event().map_err(|error| {
                let place = Location::Line(self.source.line_of(at.min(self.source.bytes.len())));
                self.source.error_at(place, ill_formed(&error), CORRECT)
            })?;
            match event {
                Event::Eof => return Ok(None),
                Event::End(_) => _ = self.open.pop(),
                Event::Start(start) | Event::Empty(start) => {
                    let tag = XmlTag { source: self.source, start, range: at..self.at() };
                    if !tag.is_empty() {
                        if self.open.len() == MAX_DEPTH {
                            let problem = format!("elements are nested more than {MAX_DEPTH} deep");
                            return Err(tag.error(problem, CORRECT));
                        }
                        self.last = Some(tag.clone());
                    }
                    return Ok(Some(tag));
                }
                _ => {}
            }
        }
    }

    /// Returns the tag of the element around the last tag; `None` for the outermost element.
    pub(crate) fn parent(&self) -> Option<&XmlTag<'a>> {
        self.open.last()
    }

    fn at(&self) -> usize {
        self.begin + self.reader.buffer_position() as usize
    }
}

impl<'a> XmlTag<'a> {
    pub(crate) fn name(&self) -> Cow<'_, str> {
        String::from_utf8_lossy(self.start.name().into_inner())
    }

    /// Returns whether the element has no content, because its tag ends in a slash.
    pub(crate) fn is_empty(&self) -> bool {
        self.source.bytes[self.range.clone()].ends_with(b"/>")
    }

    /// Returns the offset of the tag.
    pub(crate) fn at(&self) -> usize {
        self.range.start
    }

    /// Returns the offset after the tag.
    pub(crate) fn end(&self) -> usize {
        self.range.end
    }

    /// Returns the range of the text between the tag and the next one; `None` if no tag follows.
    pub(crate) fn text(&self) -> Option<Range<usize>> {
        let after = self.end();
        memchr::memchr(b'<', &self.source.bytes[after..]).map(|length| after..after + length)
    }

    /// Returns the names and values of all attributes.
    pub(crate) fn attributes(
        &self,
    ) -> impl Iterator<Item = Result<(Cow<'_, str>, String), ReadError>> {
        let mut attributes = self.start.attributes();
        attributes.with_checks(false);
        attributes.map(|attribute| {
            let attribute =
                attribute.map_err(|error| self.error(format!("an attribute: {error}"), CORRECT))?;
            let name = String::from_utf8_lossy(attribute.key.into_inner());
            Ok((name, plain_text(&attribute.value)))
        })
    }

    /// Returns the value of the first attribute of the name; `None` if there is none.
    pub(crate) fn attribute(&self, name: &str) -> Result<Option<String>, ReadError> {
        for attribute in self.attributes() {
            let (own, value) = attribute?;
            if own == name {
                return Ok(Some(value));
            }
        }
        Ok(None)
    }

    /// Returns the value of an attribute as an unsigned integer. The tag must have the attribute.
    pub(crate) fn number(&self, name: &str) -> Result<u64, ReadError> {
        let text = self.attribute(name)?.unwrap_or_default();
        text.trim().parse().map_err(|_| {
            let problem = format!("{name} is `{}`, not a whole number", quoted(text.as_bytes()));
            self.error(problem, CORRECT)
        })
    }

    /// Returns the range of an attribute's value in the file. The tag must have the attribute.
    pub(crate) fn value_range(&self, name: &str) -> Result<Range<usize>, ReadError> {
        let tag = &self.source.bytes[self.range.clone()];
        let found = memchr::memmem::find_iter(tag, name).find_map(|at| {
            let blank_before = at > 0 && tag[at - 1] <= b' ';
            let rest = &tag[at + name.len()..];
            let equals = rest.iter().position(|&byte| byte > b' ')?;
            let quote_at = equals + 1 + rest[equals + 1..].iter().position(|&byte| byte > b' ')?;
            let quote = rest[quote_at];
            let is_value = blank_before && rest[equals] == b'=' && matches!(quote, b'"' | b'\'');
            let start = at + name.len() + quote_at + 1;
            let length = memchr::memchr(quote, &tag[start..])?;
            is_value.then_some(self.at() + start..self.at() + start + length)
        });
        found.ok_or_else(|| {
            self.error(format!("the attribute {name} is not written as name=\"value\""), CORRECT)
        })
    }

    /// Makes a read error that names the line of the tag.
    #[cold]
    pub(crate) fn error(&self, problem: impl Into<String>, remedy: &str) -> ReadError {
        let place = Location::Line(self.source.line_of(self.at()));
        self.source.error_at(place, problem, remedy)
    }
}

/// Words the error of the XML parser on one line of limited length, as the error may quote a tag of any length.
fn ill_formed(error: &quick_xml::Error) -> String {
    format!("it is not XML: {}", on_one_line(error.to_string().as_bytes(), 120))
}

/// Returns the value of an attribute or the text of an element without escapes: `a"b` for `a&quot;b`. If an entity is
/// unknown, the whole text is returned unchanged.
pub(crate) fn plain_text(value: &[u8]) -> String {
    let text = decoded(value);
    quick_xml::escape::unescape(&text).map(Cow::into_owned).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_xml_are_the_text_that_they_stand_for() {
        for (value, text) in [
            ("a &quot;b&quot; &lt; &amp;amp; &#233;", "a \"b\" < &amp; \u{e9}"),
            ("R&D", "R&D"),
            ("&none;", "&none;"),
        ] {
            assert_eq!(plain_text(value.as_bytes()), text);
        }
    }

    #[test]
    fn a_tag_is_given_with_its_place_and_the_tag_around_it() {
        let bytes = b"\xEF\xBB\xBF<a><b c='&lt;'/><d>\n1 2</d><e/></a>".to_vec();
        let source = Source::new("a.xml".as_ref(), bytes).unwrap();
        let (mut tags, mut found) = (XmlTags::new(&source), Vec::new());
        while let Some(tag) = tags.next().unwrap() {
            let parent = tags.parent().map(|parent| parent.name().into_owned());
            found.push((tag.name().into_owned(), parent, tag.at(), tag.is_empty()));
            if tag.name() == "b" {
                assert_eq!(tag.attribute("c").unwrap().as_deref(), Some("<"));
                assert_eq!(&source.bytes[tag.value_range("c").unwrap()], b"&lt;");
            }
            if tag.name() == "d" {
                assert_eq!(&source.bytes[tag.text().unwrap()], b"\n1 2");
            }
        }
        let a = || Some("a".to_owned());
        let expected = [
            ("a".into(), None, 3, false),
            ("b".into(), a(), 6, true),
            ("d".into(), a(), 19, false),
            ("e".into(), a(), 30, true),
        ];
        assert_eq!(found, expected);
    }
}
