//! NetCDF-4: variables are datasets of HDF5, in the root group of the file.
//!
//! The format: <https://docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html#netcdf_4_spec>. A dimension is a
//! dataset too, as long as the dimension.

use super::netcdf::{Content, Header, Number, Variable};
use crate::error::ReadError;
use crate::file::binary::Order;
use crate::file::hdf5::{self, Hdf5};
use crate::file::source::Source;

/// Reads which datasets there are. What is no dataset, or none that can be read, is no variable.
pub(super) fn read(source: &Source) -> Result<Header<'_>, ReadError> {
    let file = Hdf5::open(source)?;
    let (mut dimensions, mut variables) = (Vec::new(), Vec::new());
    let named = file.children(file.root()).filter_map(|(name, object)| {
        let dataset = file.dataset(object).ok()??;
        Some((name, object, dataset))
    });
    let datasets: Vec<_> = named.collect();
    // The dimension itself need not be as long as those that have it.
    let growing = datasets.iter().filter(|(.., dataset)| dataset.grows());
    let records = growing.filter_map(|(.., dataset)| dataset.shape().first().copied()).max();
    for (name, object, dataset) in datasets {
        let mut shape = dataset.shape().to_vec();
        if let &[length] = &shape[..] {
            dimensions.push((name.to_vec(), length));
        }
        let is_record = dataset.grows() && shape.first().copied() == records;
        if is_record {
            shape.remove(0);
        }
        let (number, order) = match dataset.number {
            hdf5::Number::Text(1) => (Number::Text, Order::Big),
            hdf5::Number::Whole(bytes, order) => (Number::Whole(bytes), order),
            hdf5::Number::Real(precision, order) => (Number::Real(precision), order),
            hdf5::Number::Text(bytes) | hdf5::Number::Other(bytes) => {
                (Number::Other(bytes), Order::Big)
            }
        };
        let size = shape.iter().try_fold(number.bytes() as u64, |size, &n| size.checked_mul(n));
        let Some(size) = size.and_then(|size| usize::try_from(size).ok()) else { continue };
        let element_type = file.attribute(object, b"elem_type");
        let element_type = element_type.and_then(|text| Some(text.text()?.to_vec()));
        let name = name.to_vec();
        let content = Content::Dataset(dataset);
        variables.push(Variable {
            name,
            shape,
            is_record,
            number,
            order,
            element_type,
            size,
            content,
        });
    }
    let records = records.and_then(|records| usize::try_from(records).ok()).unwrap_or(0);
    Ok(Header { source, dimensions, variables, records, hdf5: Some(file) })
}
