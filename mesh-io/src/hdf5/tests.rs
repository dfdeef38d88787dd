//! Tests with files of other programs, in `tests/formats/h5`.

use super::{Datatype, Hdf5, Hdf5Arrays};
use crate::disk::source::Source;
use crate::edit::numbers::EncodedArrays;
use crate::edit::rewrite::Rewrite;
use std::path::Path;

const FILES: [&str; 10] = [
    "chunked.h5",
    "dolfin.h5",
    "gmsh.cgns",
    "gmsh.med",
    "h5netcdf.nc",
    "latest.h5",
    "meshio.h5",
    "netcdf4.exo",
    "ugrid.nc",
    "zlib.exo",
];

fn load(name: &str) -> Source {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/h5");
    Source::load(&folder.join(name)).unwrap()
}

/// Returns the paths of all datasets of real numbers, group by group.
fn paths(file: &Hdf5<'_>) -> Vec<Vec<u8>> {
    let mut groups = vec![Vec::new()];
    let mut found = Vec::new();
    while let Some(group) = groups.pop() {
        // A damaged name may contain slashes, so its path may lead nowhere.
        let Some(object) = file.find(&group) else { continue };
        if groups.len() > 1000 {
            break;
        }
        for (name, child) in file.children(object) {
            let path = [&group[..], b"/", name].concat();
            match file.dataset(child) {
                Ok(None) if path.len() < 200 => groups.push(path),
                Ok(Some(dataset)) if matches!(dataset.datatype, Datatype::Real(..)) => {
                    found.push(path)
                }
                _ => {}
            }
        }
    }
    found
}

fn array<'a>(file: &Hdf5<'a>, path: &[u8]) -> Option<(super::DatasetArray<'a>, Datatype)> {
    let dataset = file.dataset(file.find(path)?).ok()??;
    Some((file.array(&dataset).ok()?, dataset.datatype))
}

/// Changes all numbers of a dataset. Returns the new file and the new numbers.
fn changed(source: &Source, path: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let file = Hdf5::open(source).unwrap();
    let (array, number) = array(&file, path).unwrap();
    let size = number.bytes();
    let encoding = Hdf5Arrays::new(&file, vec![array]);
    let mut new = EncodedArrays::bytes(&encoding).to_vec();
    for (k, number) in new.chunks_exact_mut(size).enumerate() {
        // Bytes that no compressor shortens, so that chunks outgrow their place.
        let digits = (k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes();
        number[..size - 2].copy_from_slice(&digits[..size - 2]);
    }
    let bytes = &source.bytes;
    let mut end = bytes.len();
    let mut edits = encoding.edits(bytes, &new, &mut end);
    let more = encoding.dependent_edits(bytes, &edits, end);
    edits.extend(more);
    edits.sort_by_key(|edit| edit.range.start);
    let mut out = Vec::new();
    Rewrite { bytes, columns: &[], edits: &edits }.write(&mut out).unwrap();
    assert_eq!(out.len(), end);
    (out, new)
}

/// Changes each dataset of real numbers, in every layout: the dataset must hold its new numbers, and all other datasets
/// their old numbers.
#[test]
fn numbers_of_every_layout_are_replaced() {
    let mut replaced = 0;
    for name in FILES {
        let source = load(name);
        let file = Hdf5::open(&source).unwrap();
        let all = paths(&file);
        for path in &all {
            let shown = format!("{name}{}", String::from_utf8_lossy(path));
            let Some((old, _)) = array(&file, path).filter(|(array, _)| !array.bytes.is_empty())
            else {
                continue;
            };
            let (bytes, new) = changed(&source, path);
            let again = Source::new(Path::new(name), bytes).unwrap();
            let after = Hdf5::open(&again).unwrap();
            for other in &all {
                let (Some((before, _)), Some((after, _))) =
                    (array(&file, other), array(&after, other))
                else {
                    assert!(array(&file, other).is_none(), "{shown}");
                    continue;
                };
                let is_own = before.bytes == old.bytes
                    && array(&after_of(&again), path).is_some_and(|(a, _)| a.bytes == after.bytes);
                assert!(before.bytes == after.bytes || is_own, "{shown}");
            }
            assert!(array(&after, path).is_some_and(|(array, _)| array.bytes == new), "{shown}");
            after.check_no_overlaps().unwrap();
            replaced += 1;
        }
    }
    assert!(replaced > 20, "{replaced} datasets");
}

fn after_of(source: &Source) -> Hdf5<'_> {
    Hdf5::open(source).unwrap()
}

#[test]
fn a_cut_file_never_panics() {
    for name in FILES {
        let mut source = load(name);
        while !source.bytes.is_empty() {
            source.bytes.pop();
            if source.bytes.len().is_multiple_of(29) {
                use_all(&source);
            }
        }
    }
}

/// Reads all datasets of a file that may be damaged, and changes each readable dataset of less than 64 KiB.
fn use_all(source: &Source) {
    let Ok(file) = Hdf5::open(source) else { return };
    for path in paths(&file) {
        if array(&file, &path).is_some_and(|(array, _)| array.bytes.len() < 1 << 16) {
            changed(source, &path);
        }
    }
    let _ = file.check_no_overlaps();
}

/// Damages random bytes of each file. In tests no checksum is verified, so damage reaches the code behind the
/// checksums.
#[test]
fn damaged_files_never_panic() {
    let mut state = 7_u64;
    let mut random = |below: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let rounds = std::env::var("GPU_SMOOTH_DAMAGES").ok().and_then(|n| n.parse().ok());
    for round in 0..rounds.unwrap_or(400) {
        let mut source = load(FILES[round % FILES.len()]);
        for _ in 0..=random(4) {
            let length = source.bytes.len();
            let at = random(length);
            let some = [0, 1, 2, 8, 0x40, 0x7F, 0x80, 0xFE, 0xFF, random(256)];
            match random(6) {
                0 => source.bytes[at] ^= 1 << random(8),
                1 => source.bytes.truncate(at.max(8)),
                2 => {
                    let from = random(length.saturating_sub(8).max(1));
                    source.bytes.copy_within(from..from + 8, at.min(length - 8));
                }
                _ => source.bytes[at] = some[random(some.len())] as u8,
            }
        }
        use_all(&source);
    }
}
