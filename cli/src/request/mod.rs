//! Typed requests made from the options, and all checks that precede the reading of meshes.

#[cfg(any(test, fuzzing))]
pub(crate) mod checks;
mod command_line;
mod conflicts;
mod earlier_output;
mod form;
pub(crate) mod mistyped;
mod movable;
mod outputs;
mod picture;
mod read;
mod smooth;
mod target;
#[cfg(test)]
mod tests;
mod trial;

pub(crate) use command_line::command_line;
pub(crate) use earlier_output::{PAGE_MARK, PNG_MARK, SVG_MARK};
pub(crate) use form::FormRequest;
pub(crate) use movable::{FieldsRequest, MovableRequest, NearBad, SlideRequest};
pub(crate) use outputs::{MeshOutput, Outputs};
pub(crate) use picture::{PictureFormat, PictureRequest};
pub(crate) use read::ReadRequest;
pub(crate) use smooth::{Batch, Meshes, RunExtent, SmoothRequest, TableForm};
pub(crate) use target::{GivenTargets, TargetRequest, TargetSource, ThirdCoordinate};
pub(crate) use trial::TrialRun;
