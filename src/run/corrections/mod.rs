//! Runs with corrections from coarser levels, as opposed to sweeps alone.

mod advance;
mod exponent;
mod levels;
pub(crate) mod plan_steps;
mod record;
mod reopening;
mod saving;
mod state;
mod stepping;

pub(crate) use state::Corrections;
