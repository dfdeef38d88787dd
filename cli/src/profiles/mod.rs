//! Profiles: the limits of solvers and their users, from the program's own files or a file of the user.

mod built_in;
mod profile;

pub(crate) use built_in::{ProfileSource, names};
pub(crate) use profile::{Elements, Limit, Profile};
