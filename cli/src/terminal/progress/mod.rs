//! Progress of runs on standard error: a bar on a terminal, otherwise a line of text at intervals.

mod form;
mod left;
mod run;
mod stage;
mod tally;

pub(crate) use form::remove_bar;
pub(crate) use run::Display;
pub(crate) use stage::Stage;
pub(crate) use tally::Tally;
