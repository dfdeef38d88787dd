//! Separators, comments and the layout of items in text formats.

/// Layout of the items of a list on lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Items {
    /// One item in each line.
    Rows,
    /// Each item starts on a new line and may continue on further lines, as Fortran reads lists.
    Records,
    /// Items start and end anywhere; line ends count as blanks.
    Words,
}

/// The meaning of commas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Commas {
    /// Part of a word.
    Letters,
    /// A comma at the end of a word is ignored.
    Trailing,
    /// A comma between two numbers is a blank.
    Blanks,
    /// A semicolon between two numbers is a blank.
    Semicolons,
}

/// Syntax of a text format: layout of items, separators, comments and continuation lines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Syntax {
    pub(crate) items: Items,
    pub(crate) commas: Commas,
    /// Whether a backslash at the end of a line joins the next line.
    pub(crate) joins_lines: bool,
    /// Whether a line that starts with a blank, a comma, `+` or `*` continues the card of the line before, as in
    /// Nastran.
    pub(crate) continues_cards: bool,
    /// The byte that starts a comment, besides `#`.
    pub(crate) comment: u8,
    /// Table of all byte values, true for bytes that end a word.
    ends: &'static [bool; 256],
    /// Whether words are separated only by blanks.
    pub(crate) is_plain: bool,
}

impl Syntax {
    /// One item a line, comments after `#`.
    pub(crate) const PLAIN: Syntax = Syntax {
        items: Items::Rows,
        commas: Commas::Letters,
        joins_lines: false,
        continues_cards: false,
        comment: b'#',
        ends: &PLAIN_ENDS,
        is_plain: true,
    };
    /// SU2: comments also start with a percent sign.
    pub(crate) const PERCENT: Syntax =
        Syntax { comment: b'%', ends: &PERCENT_ENDS, ..Syntax::PLAIN };
    /// Lists as Fortran reads them: commas are blanks, and a slash ends the reading of a line.
    pub(crate) const FORTRAN: Syntax = Syntax {
        items: Items::Records,
        commas: Commas::Blanks,
        ends: &FORTRAN_ENDS,
        is_plain: false,
        ..Syntax::PLAIN
    };
    /// Numbers are separated by semicolons, as in JIGSAW's files.
    pub(crate) const SEMICOLONS: Syntax = Syntax {
        commas: Commas::Semicolons,
        ends: &SEMICOLON_ENDS,
        is_plain: false,
        ..Syntax::PLAIN
    };
    /// Abaqus: commas between items, and comments after asterisks.
    pub(crate) const KEYWORDS: Syntax = Syntax {
        commas: Commas::Blanks,
        comment: b'*',
        ends: &COMMA_ENDS,
        is_plain: false,
        ..Syntax::PLAIN
    };
    /// Nastran: cards of several lines, and comments after `$`.
    pub(crate) const CARDS: Syntax =
        Syntax { continues_cards: true, comment: b'$', ..Syntax::PLAIN };
    /// Each item starts on a new line.
    pub(crate) const RECORDS: Syntax = Syntax { items: Items::Records, ..Syntax::PLAIN };
    /// Items stand anywhere on lines.
    pub(crate) const WORDS: Syntax = Syntax { items: Items::Words, ..Syntax::PLAIN };
    /// Triangle: commas directly behind numbers are ignored.
    pub(crate) const TRAILING: Syntax = Syntax { commas: Commas::Trailing, ..Syntax::PLAIN };
    /// A line that ends in a backslash continues in the next one.
    pub(crate) const JOINED: Syntax =
        Syntax { joins_lines: true, ends: &JOINED_ENDS, is_plain: false, ..Syntax::PLAIN };

    /// Returns whether items start and end anywhere on lines.
    pub(crate) fn is_of_words(&self) -> bool {
        self.items == Items::Words
    }

    /// Returns whether a byte ends the word before it.
    #[inline]
    pub(crate) fn ends_before(&self, byte: u8) -> bool {
        self.ends[usize::from(byte)]
    }
}

static PLAIN_ENDS: [bool; 256] = ends(b"#");
static PERCENT_ENDS: [bool; 256] = ends(b"#%");
static FORTRAN_ENDS: [bool; 256] = ends(b"#,/");
static SEMICOLON_ENDS: [bool; 256] = ends(b"#;");
static COMMA_ENDS: [bool; 256] = ends(b",");
static JOINED_ENDS: [bool; 256] = ends(b"#\\");

/// Returns a table that is true for blanks, control characters and the bytes in `others`. A zero byte ends no word: it stands for
/// lost bytes, and would make two numbers of a damaged one.
const fn ends(others: &[u8]) -> [bool; 256] {
    let mut ends = [false; 256];
    let mut at = 1;
    while at <= b' ' as usize {
        ends[at] = true;
        at += 1;
    }
    let mut other = 0;
    while other < others.len() {
        ends[others[other] as usize] = true;
        other += 1;
    }
    ends
}
