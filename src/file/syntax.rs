//! What text formats make of the bytes between their numbers.

/// How the items of a list stand on its lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Items {
    /// One a line.
    Rows,
    /// Each starts on a line of its own and goes on in the next ones until all of it was read, as Fortran reads lists.
    Records,
    /// Anywhere: the end of a line is a blank like others.
    Words,
}

/// What commas are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Commas {
    /// Part of a word.
    Letters,
    /// At the end of a word they do not count.
    Trailing,
    /// One between two numbers is as good as a blank.
    Blanks,
}

/// What a text format makes of the bytes between its numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Syntax {
    pub(crate) items: Items,
    pub(crate) commas: Commas,
    /// Whether a backslash at the end of a line joins it to the next one.
    pub(crate) joins: bool,
    /// What, besides `#`, starts a comment.
    pub(crate) comment: u8,
    /// The bytes that end a word.
    ends: &'static [bool; 256],
    /// Whether nothing but blanks stands between words.
    pub(crate) is_plain: bool,
}

impl Syntax {
    /// One item a line, comments after `#`.
    pub(crate) const PLAIN: Syntax = Syntax {
        items: Items::Rows,
        commas: Commas::Letters,
        joins: false,
        comment: b'#',
        ends: &PLAIN_ENDS,
        is_plain: true,
    };
    /// SU2's: comments start with a percent sign.
    pub(crate) const PERCENT: Syntax =
        Syntax { comment: b'%', ends: &PERCENT_ENDS, ..Syntax::PLAIN };
    /// Lists that Fortran reads: commas are blanks, a slash ends what is read of a line.
    pub(crate) const FORTRAN: Syntax = Syntax {
        items: Items::Records,
        commas: Commas::Blanks,
        ends: &FORTRAN_ENDS,
        is_plain: false,
        ..Syntax::PLAIN
    };
    /// Items start on lines of their own.
    pub(crate) const RECORDS: Syntax = Syntax { items: Items::Records, ..Syntax::PLAIN };
    /// Items stand anywhere, whatever the lines.
    pub(crate) const WORDS: Syntax = Syntax { items: Items::Words, ..Syntax::PLAIN };
    /// Numbers may be followed by a comma, which stands before a blank.
    pub(crate) const TRAILING: Syntax = Syntax { commas: Commas::Trailing, ..Syntax::PLAIN };
    /// Lines that end in a backslash go on in the next one.
    pub(crate) const JOINED: Syntax =
        Syntax { joins: true, ends: &JOINED_ENDS, is_plain: false, ..Syntax::PLAIN };

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
static JOINED_ENDS: [bool; 256] = ends(b"#\\");

/// Blanks, control characters and these bytes.
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
