//! How far a run is, while it is under way: a bar on a terminal, else a line now and then.

mod form;
mod left;
mod run;
mod stage;
mod tally;

pub(crate) use run::Display;
pub(crate) use stage::Stage;
pub(crate) use tally::Tally;
