//! Node coordinates in variables of a netCDF file.

use crate::error::ReadError;
use crate::formats::axes::{Axes, BinaryReals};
use crate::netcdf::{Header, Items, Variable};

/// Locates the coordinates of `nodes` nodes in netCDF variables. Together the variables hold `axes` axes, axis after
/// axis, all encoded as `form`.
///
/// # Errors
/// If the content of a variable cannot be read.
pub(crate) fn axes<'a>(
    header: &Header<'a>,
    variables: &[&Variable],
    form: BinaryReals,
    axes: usize,
    nodes: usize,
) -> Result<Axes<'a>, ReadError> {
    let mut items = variables.iter().map(|own| header.items(own)).collect::<Result<Vec<_>, _>>()?;
    let Some(file) = &header.hdf5 else {
        let length = nodes * form.precision.bytes();
        let of_each = axes / items.len().max(1);
        let of = |start: usize| (0..of_each).map(move |axis| start + axis * length);
        let starts: Vec<usize> = items.iter().filter_map(Items::start).flat_map(of).collect();
        return Ok(Axes::in_place(header.source, form, &starts, nodes));
    };
    let arrays = items.iter_mut().filter_map(Items::take_array).collect();
    Ok(Axes::of_arrays(file, form, arrays, axes, nodes))
}
