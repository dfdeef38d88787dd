//! The data arrays that a format can store.

use super::content::DataArray;
use crate::text::token::join_first;

/// The data arrays that a format can store.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum DataSupport {
    None,
    All,
    /// All arrays, padded with zeros to [`DataArray::padded_components`].
    Padded,
    /// Arrays with one component.
    Scalars,
    /// Arrays with one component, without their names.
    Unnamed,
    /// Arrays with the given name and one component.
    Only(&'static str),
}

impl DataSupport {
    /// Returns whether the format can store a data array.
    pub(crate) fn supports(self, data: &DataArray) -> bool {
        match self {
            DataSupport::None => false,
            DataSupport::All | DataSupport::Padded => true,
            DataSupport::Scalars | DataSupport::Unnamed => data.components == 1,
            DataSupport::Only(name) => data.name == name && data.components == 1,
        }
    }

    /// Lists the arrays and parts of arrays that the format cannot store. `what` names the data.
    pub(crate) fn losses(self, what: &str, data: &[DataArray], lost: &mut Vec<String>) {
        let names = |kept: bool| -> Vec<&str> {
            let of = data.iter().filter(|data| self.supports(data) == kept);
            let mut names: Vec<&str> = of.map(|data| data.name.as_str()).collect();
            names.dedup();
            names
        };
        let dropped = names(false);
        if !dropped.is_empty() {
            lost.push(format!("{what}: {}", join_first(&dropped)));
        }
        let mut kept = names(true);
        // Names such as `attribute1` are the format's own.
        kept.retain(|name| !name.starts_with("attribute"));
        if self == DataSupport::Unnamed && !kept.is_empty() {
            lost.push(format!("names of {what}: {}", join_first(&kept)));
        }
    }

    /// Returns a line on arrays whose tuples the format fills up with zeros. `what` names the data.
    pub(crate) fn filled(self, what: &str, data: &[DataArray]) -> Option<String> {
        let is_padded = |data: &&DataArray| data.padded_components() != data.components;
        let padded: Vec<&str> =
            data.iter().filter(is_padded).map(|data| data.name.as_str()).collect();
        (self == DataSupport::Padded && !padded.is_empty()).then(|| {
            let names = join_first(&padded);
            format!("numbers of components of {what}, which zeros fill up to 3 or 9: {names}")
        })
    }
}
