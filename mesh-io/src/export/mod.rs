//! Meshes as writers see them: the content, the capabilities of a format, and names and numbers that fit the format.

/// Appends formatted text to a string.
macro_rules! put {
    ($out:expr, $($text:tt)*) => {
        write!($out, $($text)*).expect("memory takes what is written to it")
    };
}

pub(crate) mod blocks;
pub(crate) mod capabilities;
pub(crate) mod content;
pub(crate) mod content_builder;
pub(crate) mod counters;
pub(crate) mod data_support;
pub(crate) mod group_numbers;
mod implied_cells;
pub(crate) mod name_rules;
pub(crate) mod rows;
pub(crate) mod sides;
pub(crate) mod writer_input;

pub(crate) use put;
