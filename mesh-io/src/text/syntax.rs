//! How text formats separate numbers.

/// How the items of a list are laid out on lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Items {
    /// One item in each line.
    Rows,
    /// Each item starts on a new line and may continue on the next ones, as Fortran reads lists.
    Records,
    /// Anywhere. The end of a line is a blank.
    Words,
}

/// The meaning of commas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Commas {
    /// Part of a word.
    Letters,
    /// At the end of a word, a comma is ignored.
    Trailing,
    /// A comma between two numbers is a blank.
    Blanks,
    /// A semicolon between two numbers is a blank.
    Semicolons,
}

/// How a text format separates numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Syntax {
    pub(crate) items: Items,
    pub(crate) commas: Commas,
    /// Whether a backslash at the end of a line joins the line to the next one.
    pub(crate) joins_lines: bool,
    /// Whether a line that starts with a blank, a comma, `+` or `*` continues the card of the line before, as in
    /// Nastran.
    pub(crate) continues_cards: bool,
    /// The byte that starts a comment, besides `#`.
    pub(crate) comment: u8,
    /// The bytes that end a word.
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
    /// A number may be followed by a comma, which stands before a blank.
    pub(crate) const TRAILING: Syntax = Syntax { commas: Commas::Trailing, ..Syntax::PLAIN };
    /// A line that ends in a backslash continues in the next one.
    pub(crate) const JOINED: Syntax =
        Syntax { joins_lines: true, ends: &JOINED_ENDS, is_plain: false, ..Syntax::PLAIN };

    /// Whether items stand anywhere on lines.
    pub(crate) fn is_of_words(&self) -> bool {
        self.items == Items::Words
    }

    /// Whether a word ends before this byte.
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

/// Returns a table in which blanks, control characters and `others` are marked.
const fn ends(others: &[u8]) -> [bool; 256] {
    let mut ends = [false; 256];
    let mut at = 0;
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
