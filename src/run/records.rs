//! The encoding of checkpoints: named records of numbers, lists and texts.

use glam::DVec2;

use crate::metric::Metric;
use crate::run::named::Named;
use crate::run::objectives::Objectives;

/// Encodes little-endian numbers, lists after their length, and named records.
#[derive(Default)]
pub(crate) struct Writer(pub(crate) Vec<u8>);

impl Writer {
    /// Writes a record: its name, the length of its content in bytes, and the content written by `write`.
    pub(crate) fn record(&mut self, name: &str, write: impl FnOnce(&mut Self)) {
        let mut content = Self::default();
        write(&mut content);
        self.bytes(name.as_bytes());
        self.bytes(&content.0);
    }

    pub(crate) fn number(&mut self, number: u64) {
        self.0.extend(number.to_le_bytes());
    }

    pub(crate) fn real(&mut self, number: f64) {
        self.number(number.to_bits());
    }

    pub(crate) fn list<T>(&mut self, list: &[T], mut write: impl FnMut(&mut Self, &T)) {
        self.number(list.len() as u64);
        list.iter().for_each(|item| write(self, item));
    }

    /// Writes an optional number as a list: empty for `None`, else with one entry.
    pub(crate) fn optional(&mut self, number: Option<f64>) {
        self.list(number.as_slice(), |out, number| out.real(*number));
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len() as u64);
        self.0.extend(bytes);
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    pub(crate) fn named(&mut self, named: &Named) {
        self.list(&named.0, |out, (name, bytes)| {
            out.text(name);
            out.bytes(bytes);
        });
    }

    pub(crate) fn points(&mut self, points: &[DVec2]) {
        self.list(points, |out, p| p.to_array().iter().for_each(|x| out.real(*x)));
    }

    pub(crate) fn log(&mut self, log: &[Objectives]) {
        self.list(Metric::ALL, |out, metric| out.text(metric.name()));
        self.list(log, |out, one| one.values().iter().for_each(|f| out.real(*f)));
    }
}

/// Decodes the bytes that a [`Writer`] wrote. Every method returns `None` if the bytes do not fit.
#[derive(Clone, Copy)]
pub(crate) struct Reader<'b>(pub(crate) &'b [u8]);

impl<'b> Reader<'b> {
    /// Splits the rest of the bytes into records.
    pub(crate) fn records(mut self) -> Option<Records<'b>> {
        let mut records = Vec::new();
        while !self.0.is_empty() {
            let name = std::str::from_utf8(self.bytes()?).ok()?;
            records.push((name, Reader(self.bytes()?)));
        }
        Some(Records(records))
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    pub(crate) fn number(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    /// Reads a number that must fit 32 bits.
    pub(crate) fn count(&mut self) -> Option<u32> {
        u32::try_from(self.number()?).ok()
    }

    pub(crate) fn real(&mut self) -> Option<f64> {
        self.number().map(f64::from_bits)
    }

    /// Reads a list. Each item takes at least `least` bytes, so a length that exceeds the rest of the bytes is refused.
    pub(crate) fn list<T>(
        &mut self,
        least: usize,
        mut read: impl FnMut(&mut Self) -> Option<T>,
    ) -> Option<Vec<T>> {
        let length = usize::try_from(self.number()?).ok()?;
        // A damaged log may name no metric, so that its rows take no bytes.
        if length > self.0.len().checked_div(least)? {
            return None;
        }
        (0..length).map(|_| read(self)).collect()
    }

    /// Reads an optional item: a list of at most one item.
    pub(crate) fn option<T>(
        &mut self,
        read: impl FnMut(&mut Self) -> Option<T>,
    ) -> Option<Option<T>> {
        let mut list = self.list(1, read)?;
        let item = list.pop();
        list.is_empty().then_some(item)
    }

    pub(crate) fn bytes(&mut self) -> Option<&'b [u8]> {
        let length = usize::try_from(self.number()?).ok()?;
        let (bytes, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(bytes)
    }

    pub(crate) fn text(&mut self) -> Option<String> {
        String::from_utf8(self.bytes()?.to_vec()).ok()
    }

    pub(crate) fn named(&mut self) -> Option<Named> {
        self.list(16, |from| Some((from.text()?, from.bytes()?.to_vec()))).map(Named)
    }

    pub(crate) fn points(&mut self) -> Option<Vec<DVec2>> {
        self.list(16, |from| Some(DVec2::new(from.real()?, from.real()?)))
    }

    /// Reads objectives by the metrics that the list names. Metrics of other versions of the library are left out.
    pub(crate) fn log(&mut self) -> Option<Vec<Objectives>> {
        let metrics = self.list(8, |from| Some(from.text()?.parse::<Metric>().ok()))?;
        self.list(8 * metrics.len(), |from| {
            let mut objectives = Objectives::empty();
            for metric in &metrics {
                let value = from.real()?;
                if let Some(metric) = metric {
                    objectives.set(*metric, value);
                }
            }
            Some(objectives)
        })
    }
}

/// The unread records of a checkpoint, with their names.
pub(crate) struct Records<'b>(Vec<(&'b str, Reader<'b>)>);

impl<'b> Records<'b> {
    /// Reads the content of the record `name` by `read`. `None` if the record is missing, or if `read` leaves bytes
    /// unread.
    pub(crate) fn read<T>(
        &mut self,
        name: &str,
        read: impl FnOnce(&mut Reader<'b>) -> Option<T>,
    ) -> Option<T> {
        let at = self.0.iter().position(|(known, _)| *known == name)?;
        let (_, mut content) = self.0.swap_remove(at);
        let value = read(&mut content)?;
        content.is_empty().then_some(value)
    }

    /// Reads an optional record like [`read`](Self::read). `Some(None)` if the record is missing.
    pub(crate) fn read_if_any<T>(
        &mut self,
        name: &str,
        read: impl FnOnce(&mut Reader<'b>) -> Option<T>,
    ) -> Option<Option<T>> {
        match self.0.iter().any(|(known, _)| *known == name) {
            true => self.read(name, read).map(Some),
            false => Some(None),
        }
    }

    /// Returns `Some` if every record was read, and `None` otherwise.
    pub(crate) fn end(self) -> Option<()> {
        self.0.is_empty().then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A version of the library with other metrics may have written the log.
    #[test]
    fn a_log_is_read_by_the_names_of_its_metrics() {
        let mut out = Writer::default();
        out.list(&["rms", "tmop-9000", "imr"], |out, name| out.text(name));
        out.list(&[[2.5, 7.0, 1.5], [2.0, 6.0, 1.25]], |out, row| {
            row.iter().for_each(|f| out.real(*f));
        });
        let log = Reader(&out.0).log().unwrap();
        let of = |metric| log.iter().map(|now| now.of(metric)).collect::<Vec<_>>();
        assert_eq!(of(Metric::Rms), [Some(2.5), Some(2.0)]);
        assert_eq!(of(Metric::Imr), [Some(1.5), Some(1.25)]);
        assert_eq!(of(Metric::Edge), [None, None]);
        assert!(Reader(&out.0[..out.0.len() - 8]).log().is_none());
    }

    /// Only a damaged file has no metrics.
    #[test]
    fn a_log_without_metrics_is_refused() {
        for rows in [0, 1, u64::MAX] {
            let mut out = Writer::default();
            out.number(0);
            out.number(rows);
            assert!(Reader(&out.0).log().is_none());
        }
    }
}
