//! Named values, of which the state of a run consists in a checkpoint.

use bytemuck::Pod;

/// Lists of values by name, as bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Named(pub(crate) Vec<(String, Vec<u8>)>);

impl Named {
    /// Adds a list of values.
    pub(crate) fn add_list<T: Pod>(&mut self, name: &str, values: &[T]) {
        self.0.push((name.to_owned(), bytemuck::cast_slice(values).to_vec()));
    }

    /// Adds a single value.
    pub(crate) fn add<T: Pod>(&mut self, name: &str, value: T) {
        self.add_list(name, &[value]);
    }

    /// Adds whether something holds.
    pub(crate) fn add_flag(&mut self, name: &str, holds: bool) {
        self.add(name, u8::from(holds));
    }

    /// Returns the list called `name`. `None` for an unknown name, or for bytes that are not a whole number of values.
    pub(crate) fn list<T: Pod>(&self, name: &str) -> Option<Vec<T>> {
        let (_, bytes) = self.0.iter().find(|(known, _)| known == name)?;
        let is_whole = bytes.len().is_multiple_of(size_of::<T>());
        is_whole.then(|| bytemuck::pod_collect_to_vec(bytes))
    }

    /// Returns the list called `name`. `None` for an unknown name, or for another number of values than `count`.
    pub(crate) fn list_of<T: Pod>(&self, name: &str, count: usize) -> Option<Vec<T>> {
        self.list(name).filter(|values| values.len() == count)
    }

    /// Returns the single value called `name`. `None` for an unknown name or for several values.
    pub(crate) fn one<T: Pod>(&self, name: &str) -> Option<T> {
        self.list_of(name, 1)?.pop()
    }

    /// Returns whether `name` holds. `None` for an unknown name or for a value other than 0 and 1.
    pub(crate) fn flag(&self, name: &str) -> Option<bool> {
        match self.one::<u8>(name)? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_by_name_and_kind_and_count() {
        let mut named = Named::default();
        named.add_list("words", &[1_u32, 2, 3]);
        named.add("length", 0.25);
        named.add_flag("settled", true);
        assert_eq!(named.list::<u32>("words"), Some(vec![1, 2, 3]));
        assert_eq!(named.list::<u64>("words"), None);
        assert_eq!(named.list_of::<u32>("words", 2), None);
        assert_eq!((named.one("length"), named.one::<f64>("width")), (Some(0.25), None));
        assert_eq!((named.flag("settled"), named.flag("length")), (Some(true), None));
    }
}
