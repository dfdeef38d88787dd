//! The options of runs that the command line and the Python package share: one table with a row for each option, from which
//! help, keywords, checks, completions, reports and documents are made.

mod conflicts;
mod given;
mod row;
mod settings;
mod spelling;
mod table;

pub use given::GivenOptions;
pub use row::{Belongs, Kind, OptionRow};
pub use settings::Settings;
pub use spelling::Spelling;
pub use table::OPTIONS;
