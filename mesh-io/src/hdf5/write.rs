//! Writes HDF5 files: groups, contiguous datasets and attributes.
//!
//! The format: HDF5 File Format Specification, version 3.0. Files have a superblock of version 2 and object headers of
//! version 2, as libhdf5 reads them since 1.8. Groups track the creation order of their links: the library of MED lists
//! families in this order, and refuses groups without it.

use super::checksum::lookup3;

/// Address of an object that does not exist.
const UNDEFINED: [u8; 8] = [0xFF; 8];
/// Length of the superblock of version 2 in bytes.
const SUPERBLOCK: usize = 48;

/// Types of messages in an object header.
mod message {
    pub(super) const DATASPACE: u8 = 1;
    pub(super) const LINK_INFO: u8 = 2;
    pub(super) const DATATYPE: u8 = 3;
    pub(super) const FILL_VALUE: u8 = 5;
    pub(super) const LINK: u8 = 6;
    pub(super) const LAYOUT: u8 = 8;
    pub(super) const GROUP_INFO: u8 = 10;
    pub(super) const ATTRIBUTE: u8 = 12;
}

/// Numbers or texts of a dataset or an attribute, little-endian.
pub(crate) struct Values {
    datatype: Vec<u8>,
    /// Length of each dimension; empty for a scalar.
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Values {
    /// Makes an array of 64-bit floats.
    pub(crate) fn reals(numbers: impl IntoIterator<Item = f64>) -> Values {
        Values::list(real(8), 8, numbers.into_iter().flat_map(f64::to_le_bytes).collect())
    }

    /// Makes an array of 32-bit floats.
    pub(crate) fn singles(numbers: impl IntoIterator<Item = f32>) -> Values {
        Values::list(real(4), 4, numbers.into_iter().flat_map(f32::to_le_bytes).collect())
    }

    /// Makes an array of signed 64-bit integers.
    pub(crate) fn longs(numbers: impl IntoIterator<Item = i64>) -> Values {
        Values::list(integer(8), 8, numbers.into_iter().flat_map(i64::to_le_bytes).collect())
    }

    /// Makes a scalar of a signed 64-bit integer.
    pub(crate) fn long(number: i64) -> Values {
        Values::longs([number]).scalar()
    }

    /// Makes an array of signed 32-bit integers.
    pub(crate) fn ints(numbers: impl IntoIterator<Item = i32>) -> Values {
        Values::list(integer(4), 4, numbers.into_iter().flat_map(i32::to_le_bytes).collect())
    }

    /// Makes an array of the bytes of a text, as signed 8-bit integers.
    pub(crate) fn chars(text: &[u8]) -> Values {
        Values::list(integer(1), 1, text.to_vec())
    }

    /// Makes an array of texts, each of which is an array of `size` signed 8-bit integers, padded with zeros.
    pub(crate) fn char_arrays<'t>(
        texts: impl IntoIterator<Item = &'t [u8]>,
        size: usize,
    ) -> Values {
        // Class 10 (array) in version 3: rank, length of the dimension, base type.
        let mut datatype = head(3 << 4 | 10, [0; 3], size);
        datatype.push(1);
        datatype.extend((size as u32).to_le_bytes());
        datatype.extend(integer(1));
        Values::list(
            datatype,
            size,
            texts.into_iter().flat_map(|text| padded(text, size)).collect(),
        )
    }

    /// Makes a text of fixed length, cut or padded with zeros to `size` bytes. The last byte is 0.
    pub(crate) fn text(text: &[u8], size: usize) -> Values {
        let text = &text[..text.len().min(size - 1)];
        Values {
            datatype: head(1 << 4 | 3, [0; 3], size),
            shape: Vec::new(),
            bytes: padded(text, size),
        }
    }

    /// Converts an array of one number to a scalar.
    pub(crate) fn scalar(self) -> Values {
        Values { shape: Vec::new(), ..self }
    }

    /// Changes the shape of an array. The number of numbers must stay the same.
    pub(crate) fn shaped(self, shape: &[usize]) -> Values {
        Values { shape: shape.to_vec(), ..self }
    }

    fn list(datatype: Vec<u8>, size: usize, bytes: Vec<u8>) -> Values {
        Values { datatype, shape: vec![bytes.len() / size], bytes }
    }

    /// Returns the message of a dataspace in version 2.
    fn dataspace(&self) -> Vec<u8> {
        let mut space = vec![2, self.shape.len() as u8, 0, u8::from(!self.shape.is_empty())];
        self.shape.iter().for_each(|&length| space.extend((length as u64).to_le_bytes()));
        space
    }
}

/// Returns class and version, bit field and size, with which every datatype starts.
fn head(class: u8, bits: [u8; 3], size: usize) -> Vec<u8> {
    let mut datatype = vec![class];
    datatype.extend(bits);
    datatype.extend((size as u32).to_le_bytes());
    datatype
}

/// Returns the datatype of signed integers: class 0 in version 1, with bit offset 0 and all bits in use.
fn integer(size: usize) -> Vec<u8> {
    let mut datatype = head(1 << 4, [0x08, 0, 0], size);
    datatype.extend([0, 0, 8 * size as u8, 0]);
    datatype
}

/// Returns the datatype of IEEE floats: class 1 in version 1.
fn real(size: usize) -> Vec<u8> {
    // Bits of exponent and mantissa, and the bias of the exponent.
    let (exponent, mantissa, bias) = if size == 8 { (11, 52, 1023_u32) } else { (8, 23, 127) };
    let mut datatype = head(1 << 4 | 1, [0x20, 8 * size as u8 - 1, 0], size);
    datatype.extend([0, 0, 8 * size as u8, 0, mantissa, exponent, 0, mantissa]);
    datatype.extend(bias.to_le_bytes());
    datatype
}

fn padded(text: &[u8], size: usize) -> Vec<u8> {
    let mut bytes = text[..text.len().min(size)].to_vec();
    bytes.resize(size, 0);
    bytes
}

/// A group or a dataset of a file under construction, with attributes.
#[derive(Default)]
pub(crate) struct NewObject {
    attributes: Vec<(String, Values)>,
    /// The objects of a group, in the order of their creation.
    children: Vec<(String, NewObject)>,
    /// The numbers of a dataset; `None` for a group.
    values: Option<Values>,
}

impl NewObject {
    /// Returns the group at a path, with names separated by `/`. Makes missing groups.
    pub(crate) fn group(&mut self, path: &str) -> &mut NewObject {
        path.split('/').filter(|name| !name.is_empty()).fold(self, |at, name| {
            match at.children.iter().position(|(own, _)| own == name) {
                Some(place) => &mut at.children[place].1,
                None => at.add(name),
            }
        })
    }

    /// Adds a group with a new name, and returns it.
    pub(crate) fn add(&mut self, name: &str) -> &mut NewObject {
        self.children.push((name.to_owned(), NewObject::default()));
        let place = self.children.len() - 1;
        &mut self.children[place].1
    }

    /// Adds a dataset with a new name, and returns it.
    pub(crate) fn dataset(&mut self, name: &str, values: Values) -> &mut NewObject {
        let object = self.add(name);
        object.values = Some(values);
        object
    }

    /// Adds an attribute.
    pub(crate) fn attribute(&mut self, name: &str, values: Values) -> &mut NewObject {
        self.attributes.push((name.to_owned(), values));
        self
    }

    /// Returns the file of which this group is the root.
    pub(crate) fn file(&self) -> Vec<u8> {
        let mut out = vec![0; SUPERBLOCK];
        let root = self.put(&mut out);
        let mut superblock = b"\x89HDF\r\n\x1a\n\x02\x08\x08\0".to_vec();
        superblock.extend([0; 8]);
        superblock.extend(UNDEFINED);
        superblock.extend((out.len() as u64).to_le_bytes());
        superblock.extend((root as u64).to_le_bytes());
        superblock.extend(lookup3(&superblock).to_le_bytes());
        out[..SUPERBLOCK].copy_from_slice(&superblock);
        out
    }

    /// Appends this object after its children. Returns the address of its header.
    fn put(&self, out: &mut Vec<u8>) -> usize {
        let mut messages = Vec::new();
        let mut add = |kind: u8, body: &[u8]| {
            messages.push(kind);
            messages.extend((body.len() as u16).to_le_bytes());
            messages.push(0);
            messages.extend(body);
        };
        match &self.values {
            Some(values) => {
                let address = match values.bytes.is_empty() {
                    true => UNDEFINED,
                    false => aligned(out).to_le_bytes(),
                };
                out.extend(&values.bytes);
                add(message::DATASPACE, &values.dataspace());
                add(message::DATATYPE, &values.datatype);
                // Version 3: space is allocated late, and no value is set.
                add(message::FILL_VALUE, &[3, 0x0A]);
                let size = (values.bytes.len() as u64).to_le_bytes();
                add(message::LAYOUT, &[&[3, 1][..], &address, &size].concat());
            }
            None => {
                let addresses: Vec<_> =
                    self.children.iter().map(|(_, child)| child.put(out)).collect();
                let count = (self.children.len() as u64).to_le_bytes();
                // Creation order is tracked; links are in the header, so heap and index of links do not exist.
                add(message::LINK_INFO, &[&[0, 1][..], &count, &UNDEFINED, &UNDEFINED].concat());
                add(message::GROUP_INFO, &[0, 0]);
                for (order, ((name, _), address)) in self.children.iter().zip(addresses).enumerate()
                {
                    // Bits 0 and 1: the length of the name has two bytes. Bit 2: the creation order follows.
                    let (order, length) =
                        ((order as u64).to_le_bytes(), (name.len() as u16).to_le_bytes());
                    let address = (address as u64).to_le_bytes();
                    let link =
                        [&[1, 0b101][..], &order, &length, name.as_bytes(), &address].concat();
                    add(message::LINK, &link);
                }
            }
        }
        for (name, values) in &self.attributes {
            let space = values.dataspace();
            let sizes = [name.len() + 1, values.datatype.len(), space.len()];
            let mut body = vec![3, 0];
            sizes.iter().for_each(|&size| body.extend((size as u16).to_le_bytes()));
            body.push(0);
            body.extend(name.as_bytes());
            body.push(0);
            body.extend(&values.datatype);
            body.extend(&space);
            body.extend(&values.bytes);
            add(message::ATTRIBUTE, &body);
        }
        let start = aligned(out) as usize;
        // Version 2, with four bytes for the size of the messages.
        let mut header = b"OHDR\x02\x02".to_vec();
        header.extend((messages.len() as u32).to_le_bytes());
        header.extend(messages);
        header.extend(lookup3(&header).to_le_bytes());
        out.extend(header);
        start
    }
}

/// Pads the file to a multiple of 8 bytes. Returns its length.
fn aligned(out: &mut Vec<u8>) -> u64 {
    out.resize(out.len().next_multiple_of(8), 0);
    out.len() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disk::source::Source;
    use crate::hdf5::{Datatype, Hdf5};
    use crate::precision::Precision;
    use std::path::Path;

    /// Reads the file under construction.
    fn read(file: &NewObject, check: impl Fn(&Hdf5<'_>)) {
        let source = Source::new(Path::new("a.h5"), file.file()).unwrap();
        check(&Hdf5::open(&source).unwrap());
    }

    #[test]
    fn numbers_and_texts_are_read_where_they_were_written() {
        let mut file = NewObject::default();
        file.attribute("root", Values::long(-7));
        let group = file.group("a/b");
        group.attribute("text", Values::text(b"some text", 6));
        group.dataset("reals", Values::reals([0.5, -1e300, f64::INFINITY, 0.0]).shaped(&[2, 2]));
        group.dataset("singles", Values::singles([3.4])).attribute("of", Values::ints([5]));
        file.group("a").dataset("longs", Values::longs([i64::MIN, 1]));
        file.group("a").dataset("ints", Values::ints([-1, 2, 3]));
        file.dataset("names", Values::char_arrays([&b"ab"[..], b"cdefg"], 4));
        file.dataset("none", Values::reals([]));
        read(&file, |file| {
            let attribute = |path: &[u8], name| file.attribute(file.find(path).unwrap(), name);
            assert_eq!(attribute(b"", b"root").unwrap().whole(), Some(-7));
            assert_eq!(attribute(b"a/b", b"text").unwrap().text(), Some(&b"some "[..]));
            assert_eq!(attribute(b"a/b/singles", b"of").unwrap().whole(), Some(5));
            let bytes = |path: &[u8]| {
                let set = file.dataset(file.find(path).unwrap()).unwrap().unwrap();
                (file.array(&set).unwrap().bytes.to_vec(), set.datatype)
            };
            let numbers = [0.5, -1e300, f64::INFINITY, 0.0].map(f64::to_le_bytes).concat();
            let (own, datatype) = bytes(b"a/b/reals");
            assert_eq!(own, numbers);
            assert!(matches!(datatype, Datatype::Real(Precision::Double, _)));
            let (own, datatype) = bytes(b"a/b/singles");
            assert_eq!(own, 3.4_f32.to_le_bytes());
            assert!(matches!(datatype, Datatype::Real(Precision::Single, _)));
            assert_eq!(bytes(b"names").0, b"ab\0\0cdef");
            assert_eq!(bytes(b"none").0, b"");
            let integers = |path| file.integers(file.find(path).unwrap());
            assert_eq!(integers(&b"a/longs"[..]), Some(vec![i64::MIN, 1]));
            assert_eq!(integers(b"a/ints"), Some(vec![-1, 2, 3]));
            let names: Vec<&[u8]> =
                file.children(file.find(b"a").unwrap()).map(|(name, _)| name).collect();
            assert_eq!(names, [&b"b"[..], b"longs", b"ints"]);
        });
    }

    #[test]
    fn groups_of_thousands_of_objects_are_read() {
        let mut file = NewObject::default();
        for number in 0..5000 {
            file.add(&format!("{number}")).attribute("number", Values::long(number));
        }
        read(&file, |file| {
            let own = file.children(file.root());
            let numbers = own.map(|(_, own)| file.attribute(own, b"number").unwrap().whole());
            assert!(numbers.eq((0..5000).map(Some)));
        });
    }
}
