//! Meshes as writers see them: the content, the capabilities of a format, and names and numbers that fit the format.

/// Appends formatted text to a string.
macro_rules! put {
    ($out:expr, $($text:tt)*) => {
        write!($out, $($text)*).expect("memory takes what is written to it")
    };
}

pub(crate) mod collector;
pub(crate) mod content;
pub(crate) mod holds;
pub(crate) mod job;
pub(crate) mod sides;
pub(crate) mod spelling;
pub(crate) mod tags;

pub(crate) use put;
