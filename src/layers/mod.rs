//! Boundary layers: rows of stretched elements along walls, found by their connectivity and geometry.

mod choice;
mod elements;
mod ends;
mod find;
mod front;
mod keep;
mod march;
mod measure;
mod result;
mod search;
mod sectors;
mod segments;
mod spacing;
mod vector;
mod wakes;

pub use choice::KeepLayers;
pub use elements::Elements;
pub use result::Layers;
pub use spacing::Spacing;
