//! Input shared by the stages of a run.

use crate::error::CliError;
use crate::load::conversion::{self, NewForm};
use crate::load::{InterpolatedFields, LoadedMesh, MovableSelection, streams};
use crate::report::SmoothJob;
use crate::request::SmoothRequest;
use gpu_smooth::{front_ends::Plane, options::Precision};
use std::time::Instant;

/// A mesh with its task and the selection of movable vertices.
#[derive(Clone, Copy)]
pub(super) struct Input<'a> {
    pub(super) task: &'a SmoothJob<'a>,
    pub(super) file: &'a LoadedMesh,
    pub(super) choice: &'a MovableSelection,
    /// The format to which the mesh is converted; `None` if its file is rewritten.
    pub(super) form: Option<NewForm>,
    /// Size of the input file in bytes; 0 if the input is not a file.
    pub(super) bytes: u64,
    /// Start of the run, from which the time limit counts.
    pub(super) began: Instant,
}

impl<'a> Input<'a> {
    pub(super) fn request(&self) -> &'a SmoothRequest {
        self.task.request
    }

    /// Writes the mesh with its vertices at `points` to OUT, in its own or another format.
    pub(super) fn write(
        &self,
        points: &[[f64; 2]],
        fields: &InterpolatedFields,
    ) -> Result<(), CliError> {
        let (file, out, fields) = (self.file, self.task.out, fields.fields());
        match &self.form {
            None => streams::write(file, out, points, fields),
            Some(form) => {
                let given = file.domain.given(points);
                conversion::write(&form.conversion(file, &given, fields, out)?, out)
            }
        }
    }

    /// Returns the precision with which OUT stores the coordinates of the mesh. Coordinates in a tilted plane are not
    /// stored.
    pub(super) fn precision(&self) -> Precision {
        match self.form {
            Some(form) if !self.file.plane().is_some_and(Plane::is_tilted) => form.precision,
            _ => self.file.precision(),
        }
    }
}
