//! The meaning of options, and what is refused before any file is read.

#[cfg(any(test, fuzzing))]
pub(crate) mod checks;
mod command_line;
mod conflicts;
mod outputs;
mod picture;
mod smooth;
mod target;
#[cfg(test)]
mod tests;

pub(crate) use command_line::read;
pub(crate) use outputs::{CheckpointPlan, MeshOutput, Outputs, is_checkpoint};
pub(crate) use picture::{PictureFormat, PictureRequest};
