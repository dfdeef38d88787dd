//! Shows how far a run is: by a bar on a terminal, else by a line now and then.

mod form;
mod left;
mod run;
mod stage;
mod tally;

pub(crate) use run::Display;
pub(crate) use stage::Stage;
pub(crate) use tally::Tally;
