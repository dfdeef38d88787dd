//! Marks of reports, pages and pictures of this program in their first bytes. Another file is not replaced without `--force`.

/// Line of a page that names its program, as HTML defines for `generator`.
pub(crate) const PAGE_MARK: &str = "<meta name=\"generator\" content=\"gpu-smooth\">";

/// Comment in pictures in SVG.
pub(crate) const SVG_MARK: &str = "<!-- Created with gpu-smooth -->";

/// Keyword and text of pictures in PNG, of which the specification defines `Software`.
pub(crate) const PNG_MARK: [&str; 2] = ["Software", "gpu-smooth"];

/// Returns whether a file that begins with the bytes `head` is a report, with any version and any blanks.
pub(super) fn is_report(head: &[u8]) -> bool {
    let text: Vec<u8> = head.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect();
    let version = text.strip_prefix(b"{\"schema_version\":");
    let digits = |text: &[u8]| text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    version.is_some_and(|text| text[digits(text)..].starts_with(b",\"program\":\"gpu-smooth"))
}

/// Returns whether a file that begins with the bytes `head` is a page.
pub(super) fn is_page(head: &[u8]) -> bool {
    head.starts_with(b"<!doctype html>") && contains(head, PAGE_MARK.as_bytes())
}

/// Returns whether a file that begins with the bytes `head` is a picture.
pub(super) fn is_picture(head: &[u8]) -> bool {
    let in_png = format!("tEXt{}", PNG_MARK.join("\0"));
    head.starts_with(b"<svg ") && contains(head, SVG_MARK.as_bytes())
        || head.starts_with(b"\x89PNG") && contains(head, in_png.as_bytes())
}

fn contains(head: &[u8], part: &[u8]) -> bool {
    head.windows(part.len()).any(|window| window == part)
}
