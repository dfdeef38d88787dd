//! Types in place of the device of a run, for builds without the feature `gpu`.

use glam::DVec2;

use crate::error::GpuError;
use crate::layout::Problem;
use crate::mesh::MeshSize;
use crate::run::{Plan, Work};
use crate::slide::OnCurves;

/// The device of a run. The type has no value, as no device exists.
pub(crate) type Device<'s> = &'s NoDevice;

/// The engine on a device, likewise without a value.
pub(crate) type DeviceEngine<'s> = &'s NoDevice;

/// A type without values.
pub(crate) enum NoDevice {}

impl NoDevice {
    pub(crate) fn check_size(&self, _: MeshSize) -> Result<(), GpuError> {
        match *self {}
    }

    pub(crate) async fn check_arithmetic(&self) -> Result<(), GpuError> {
        match *self {}
    }

    pub(crate) async fn engine<'s>(
        &self,
        _: &Problem,
        _: &[DVec2],
        _: Option<&OnCurves>,
        _: Plan,
        _: Work,
    ) -> Result<DeviceEngine<'s>, GpuError> {
        match *self {}
    }
}
