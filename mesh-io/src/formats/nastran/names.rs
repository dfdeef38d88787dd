//! Names of properties, which the preprocessors HyperMesh, ANSA and Femap write in comments.

use crate::disk::source::Source;
use crate::text::token::line_end;
use crate::visit::visitor::MeshVisitor;

/// Visits the names of properties in comments that start a line.
pub(super) fn send(source: &Source, visitor: &mut dyn MeshVisitor) {
    let bytes = &source.bytes;
    let starts = memchr::memchr_iter(b'$', bytes);
    for at in starts.filter(|&at| at == source.begin() || bytes[at - 1] == b'\n') {
        if let Some((tag, name)) = parse_comment(&bytes[at..line_end(bytes, at)]) {
            visitor.group_name("property", None, tag, name);
        }
    }
}

/// Returns the number and the name of the property that a comment names; `None` for other comments.
fn parse_comment(comment: &[u8]) -> Option<(i64, &[u8])> {
    let (tag, name) = if let Some(rest) = comment.strip_prefix(b"$HMNAME PROP") {
        // HyperMesh: `$HMNAME PROP       1"skin" 4`
        let mut pieces = rest.split(|&byte| byte == b'"');
        (pieces.next()?, pieces.next()?)
    } else if let Some(rest) = comment.strip_prefix(b"$ANSA_NAME_COMMENT;") {
        // ANSA: `$ANSA_NAME_COMMENT;1;PSHELL;skin;;NO;NO;NO;`
        let mut pieces = rest.split(|&byte| byte == b';');
        let (tag, card, name) = (pieces.next()?, pieces.next()?, pieces.next()?);
        (tag, card.starts_with(b"P").then_some(name)?)
    } else {
        // Femap: `$ Femap Property 1 : skin`
        let is_femap = comment.get(..8).is_some_and(|head| head.eq_ignore_ascii_case(b"$ Femap "));
        let property = memchr::memmem::find(comment, b"Property ").filter(|_| is_femap)?;
        let rest = &comment[property + b"Property ".len()..];
        rest.split_at(memchr::memchr(b':', rest)?)
    };
    let name = name.strip_prefix(b":").unwrap_or(name).trim_ascii();
    let tag = str::from_utf8(tag.trim_ascii()).ok()?.parse().ok()?;
    (!name.is_empty()).then_some((tag, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_in_the_comments_of_preprocessors() {
        for (comment, tag) in [
            ("$HMNAME PROP               7\"skin: a\" 4\r\n", 7),
            ("$ANSA_NAME_COMMENT;12;PSHELL;skin: a;;NO;NO;NO;\n", 12),
            ("$ Femap Property 3 : skin: a\n", 3),
            ("$ FEMAP with NX Nastran Property 3 : skin: a\n", 3),
        ] {
            assert_eq!(
                parse_comment(comment.as_bytes()),
                Some((tag, &b"skin: a"[..])),
                "{comment}"
            );
        }
        for comment in [
            "$HMNAME COMP               7\"skin\"",
            "$HMNAME PROP \"skin\"",
            "$ANSA_NAME_COMMENT;12;MAT1;steel;;NO;NO;NO;",
            "$ Femap Property 3",
            "$ Femap Material 3 : steel",
            "$ Property 3 : skin",
            "$",
        ] {
            assert_eq!(parse_comment(comment.as_bytes()), None, "{comment}");
        }
    }
}
