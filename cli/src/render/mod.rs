//! Tables, pictures and pages.

pub(crate) mod columns;
pub(crate) mod html;
pub(crate) mod picture;
