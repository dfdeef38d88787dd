//! Texts that must fit a width: headings of meshes and of enlarged triangles.

/// Breaks a text into lines of at most `width` pixels: after a comma or a semicolon if possible, else between words. A word
/// that is wider has a line of its own. `measure` returns the width of a text in pixels.
pub(crate) fn wrapped(text: &str, width: f32, measure: &dyn Fn(&str) -> f32) -> Vec<String> {
    let mut lines = Vec::new();
    let mut rest = text;
    while measure(rest) > width {
        let breaks = || rest.match_indices(' ').map(|(at, _)| at);
        let fits = |at: &usize| measure(&rest[..*at]) <= width;
        let is_clause = |at: &usize| rest[..*at].ends_with([',', ';']);
        let at = breaks().filter(fits).filter(is_clause).last();
        let at = at.or_else(|| breaks().filter(fits).last()).or_else(|| breaks().next());
        let Some(at) = at else { break };
        lines.push(rest[..at].to_owned());
        rest = &rest[at + 1..];
    }
    lines.push(rest.to_owned());
    lines
}

/// Returns the end of a text that is at most `width` pixels wide. Dots replace the beginning. `measure` returns the width of
/// a text in pixels.
pub(crate) fn end_within(name: &str, width: f32, measure: &dyn Fn(&str) -> f32) -> String {
    let mut shown = name.to_owned();
    let mut rest = name.chars();
    while measure(&shown) > width && rest.next().is_some() {
        shown = format!("...{}", rest.as_str());
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_after_clauses_where_these_fit() {
        let measure = |text: &str| text.chars().count() as f32;
        let text = "72 triangles; size-ratio 1.0413 to 2.4084, mean 1.5871";
        let lines = |width| wrapped(text, width, &measure);
        assert_eq!(lines(60.0), [text]);
        assert_eq!(lines(45.0), ["72 triangles; size-ratio 1.0413 to 2.4084,", "mean 1.5871"]);
        assert_eq!(lines(30.0), ["72 triangles;", "size-ratio 1.0413 to 2.4084,", "mean 1.5871"]);
        assert_eq!(lines(13.0).concat().replace(' ', ""), text.replace(' ', ""));
        assert!(lines(13.0).iter().all(|line| measure(line) <= 13.0));
        assert_eq!(wrapped("a-long-word b", 3.0, &measure), ["a-long-word", "b"]);
        assert_eq!(wrapped("a-long-word", 3.0, &measure), ["a-long-word"]);
    }
}
