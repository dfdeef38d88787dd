//! Text files: the cursor that reads words and rows, the syntax of formats, and numbers as text.

pub(crate) mod card;
pub(crate) mod continuation;
pub(crate) mod cursor;
pub(crate) mod cursor_numbers;
pub(crate) mod field_text;
pub(crate) mod parallel_rows;
pub(crate) mod row_layout;
pub(crate) mod syntax;
pub(crate) mod token;
