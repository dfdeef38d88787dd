//! NetCDF-4: variables are datasets in the root group of an HDF5 file.
//!
//! The format: <https://docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html#netcdf_4_spec>. Each
//! dimension is stored as a dataset with one axis of the dimension's length.

use super::attribute::Attribute;
use super::header::{Content, Header, Variable};
use super::types::NumberType;
use crate::binary::byte_order::ByteOrder;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::hdf5::{self, Hdf5};

/// Start of the attribute `NAME` of datasets that only stand for a dimension and hold no variable.
const NO_VARIABLE: &[u8] = b"This is a netCDF dimension but not a netCDF variable";

/// Makes dimensions and variables from the datasets in the root group. Skips groups, and datasets that cannot be read.
pub(super) fn read(source: &Source) -> Result<Header<'_>, ReadError> {
    let file = Hdf5::open(source)?;
    let (mut dimensions, mut variables) = (Vec::new(), Vec::new());
    let named = file.children(file.root()).filter_map(|(name, object)| {
        let dataset = file.dataset(object).ok()??;
        Some((name, object, dataset))
    });
    let datasets: Vec<_> = named.collect();
    // The dataset of the record dimension may be shorter than variables with records, so the longest dataset counts.
    let growing = datasets.iter().filter(|(.., dataset)| dataset.grows());
    let records = growing.filter_map(|(.., dataset)| dataset.shape().first().copied()).max();
    for (name, object, dataset) in datasets {
        let mut shape = dataset.shape().to_vec();
        if let &[length] = &shape[..] {
            dimensions.push((name.to_vec(), length));
        }
        // A dataset that only stands for a dimension has no values.
        if file
            .attribute(object, b"NAME")
            .is_some_and(|name| name.text().is_some_and(|text| text.starts_with(NO_VARIABLE)))
        {
            continue;
        }
        let is_record = dataset.grows() && shape.first().copied() == records;
        if is_record {
            shape.remove(0);
        }
        let (number, order) = match dataset.datatype {
            hdf5::Datatype::Text(1) => (NumberType::Text, ByteOrder::Big),
            other => number_of(other),
        };
        let size = shape.iter().try_fold(number.bytes() as u64, |size, &n| size.checked_mul(n));
        let Some(size) = size.and_then(|size| usize::try_from(size).ok()) else { continue };
        let attributes = file.attributes(object).into_iter().map(|(name, attribute)| {
            // The text of an attribute is a single HDF5 item, however long.
            let (number, order) = match attribute.number {
                hdf5::Datatype::Text(_) => (NumberType::Text, ByteOrder::Big),
                other => number_of(other),
            };
            Attribute { name: name.to_vec(), number, order, bytes: attribute.bytes.to_vec() }
        });
        let attributes = attributes.collect();
        let name = name.to_vec();
        let content = Content::Dataset(Box::new(dataset));
        variables.push(Variable {
            name,
            shape,
            is_record,
            number,
            order,
            attributes,
            size,
            content,
        });
    }
    let records = records.and_then(|records| usize::try_from(records).ok()).unwrap_or(0);
    Ok(Header { source, dimensions, variables, records, hdf5: Some(file) })
}

/// Returns the netCDF type and the byte order of a datatype. Texts and unknown types become `Other`.
fn number_of(number: hdf5::Datatype) -> (NumberType, ByteOrder) {
    match number {
        hdf5::Datatype::Whole(number, order) => (NumberType::Whole(number), order),
        hdf5::Datatype::Real(precision, order) => (NumberType::Real(precision), order),
        hdf5::Datatype::Text(bytes)
        | hdf5::Datatype::VariableText(bytes)
        | hdf5::Datatype::Other(bytes) => (NumberType::Other(bytes), ByteOrder::Big),
    }
}
