//! Text in columns, for a terminal or as CSV.

use std::io::IsTerminal;

use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// Returns the width of the terminal in columns; `None` if standard output is not a terminal.
pub(crate) fn of_terminal() -> Option<usize> {
    let size = std::io::stdout().is_terminal().then(terminal_size::terminal_size).flatten();
    size.map(|(width, _)| usize::from(width.0))
}

/// Appends spaces to a text up to `width` columns.
pub(crate) fn left(text: &str, width: usize) -> String {
    format!("{text}{}", " ".repeat(width.saturating_sub(text.width())))
}

/// Prepends spaces to a text up to `width` columns.
pub(crate) fn right(text: &str, width: usize) -> String {
    format!("{}{text}", " ".repeat(width.saturating_sub(text.width())))
}

/// Shortens a name that exceeds `most` columns to three dots and the name's end. Two dots would look like a folder.
pub(crate) fn shortened(name: &str, most: usize) -> String {
    if name.width() <= most {
        return name.to_owned();
    }
    let mut room = most.saturating_sub(3);
    let fits = |&(_, c): &(usize, char)| {
        let width = c.width().unwrap_or(0);
        let fits = width <= room;
        room = room.saturating_sub(width);
        fits
    };
    let start = name.char_indices().rev().take_while(fits).last().map_or(name.len(), |(at, _)| at);
    format!("...{}", &name[start..])
}

/// Quotes a field of CSV if the field contains commas, quotes or line ends.
pub(crate) fn quoted(field: &str) -> String {
    match field.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_lose_their_start() {
        assert_eq!(shortened("a/long/name.msh", 9), "...me.msh");
        assert_eq!(shortened("name.msh", 9), "name.msh");
        assert_eq!(shortened("name.msh", 1), "...");
    }

    /// Chinese, Japanese and Korean characters take two columns each, combining characters none.
    #[test]
    fn wide_characters_count_twice() {
        assert_eq!(left("網格", 6), "網格  ");
        assert_eq!(right("網格.msh", 10), "  網格.msh");
        assert_eq!(shortened("東京湾.msh", 8), "....msh");
        assert_eq!(shortened("東京湾.msh", 9), "...湾.msh");
        assert_eq!(shortened("東京湾.msh", 10), "東京湾.msh");
        assert_eq!(left("e\u{301}", 3), "e\u{301}  ");
    }

    #[test]
    fn fields_are_quoted_where_they_must_be() {
        assert_eq!(quoted("a b"), "a b");
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
