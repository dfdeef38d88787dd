//! Remarks on a mesh file.

use std::fmt;

/// A fact about a mesh file that its user may want to know. [`Display`](fmt::Display) words the fact in one line.
///
/// Which vertices move is decided outside of this crate, so that a program may word the first three kinds by what it
/// does with these vertices.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remark {
    /// The file has elements other than triangles. Their vertices are among
    /// [`Constraints::vertices`](crate::Constraints::vertices).
    OtherElements {
        /// The number of these elements.
        count: u64,
        /// The name of these elements, in the plural if there are several: `quadrilaterals`, `segment of la.poly`.
        name: String,
    },
    /// Every vertex lies on a point or a curve of the model, and so is among
    /// [`Constraints::vertices`](crate::Constraints::vertices).
    AllOnModelCurves,
    /// Some periodic pairs name a node that the file does not list. The other vertex of such a pair is among
    /// [`Constraints::anchored`](crate::Constraints::anchored).
    UnlistedPairs {
        /// The number of these pairs.
        count: u64,
        /// The name of the file's list of nodes, such as `$Nodes`.
        list: String,
    },
    /// Another fact, in words.
    Text(String),
}

impl Remark {
    /// Makes the remark that a file has `count` elements, called `name` in the singular, followed by `of`.
    pub(crate) fn elements(count: u64, name: &str, of: &str) -> Remark {
        let s = if count == 1 { "" } else { "s" };
        Remark::OtherElements { count, name: format!("{name}{s}{of}") }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Remark::OtherElements { count, name } => write!(f, "{count} {name}"),
            Remark::AllOnModelCurves => {
                write!(f, "every vertex lies on a point or curve of the model")
            }
            Remark::UnlistedPairs { count, list } => {
                write!(f, "periodic pairs that name a node which {list} does not list: {count}")
            }
            Remark::Text(text) => f.write_str(text),
        }
    }
}
