//! Files of other programs that are cut off, damaged, or announce more items than they hold.

use super::Folder;
use super::damage::{self, damaged, random};
use super::facts::mesh_of;
use super::made::{Made, all, base};
use super::others::{folder, for_each};
use mesh_io::{Format, Location, MeshFile, ReadOptions};
use std::fs;
use std::time::Instant;

/// Reads a file that may be damaged: each vertex and triangle of a mesh must have a location, and an error must name
/// the file on a single line.
pub(crate) fn mesh_or_error(folder: &Folder, name: &str) -> Result<MeshFile, String> {
    match ReadOptions::new().weld(true).read(&folder.path(name)) {
        Ok(file) => {
            let length = fs::metadata(folder.path(name)).unwrap().len() as usize;
            let mesh = mesh_of(&file);
            let (vertices, triangles) = (mesh.points.len(), mesh.triangles.len());
            let mut named = mesh.triangles.iter().flatten().chain(&mesh.fixed);
            assert!(named.all(|&v| (v as usize) < vertices));
            let inside = |location| match location {
                Location::Line(line) => (1..=length).contains(&line),
                Location::Byte(at) => at <= length,
                Location::Unknown => false,
            };
            let places = file.vertex_locations(0..vertices as u32);
            assert_eq!(places.len(), vertices);
            assert!(places.values().all(|place| inside(place.location)), "a vertex beyond the end");
            let places = file.triangle_locations(0..triangles);
            assert_eq!(places.len(), triangles);
            let found = places.values().all(|place| inside(place.location));
            assert!(found, "a triangle beyond the end");
            Ok(file)
        }
        Err(error) => {
            let error = error.to_string();
            assert!(error.contains(name), "{error}");
            assert_eq!(error.lines().count(), 1, "{error}");
            Err(error)
        }
    }
}

#[test]
fn a_file_cut_off_anywhere_is_an_error_or_a_mesh() {
    for_each(&base(), |made| {
        let folder = folder(made, &[]);
        for cut in 0..made.bytes.len() {
            folder.put(made.name, &made.bytes[..cut]);
            let read = mesh_or_error(&folder, made.name);
            let in_a_list = made.lists.iter().any(|list| list.contains(&cut));
            assert!(!in_a_list || read.is_err(), "a mesh of the first {cut} bytes");
        }
    });
}

/// Returns counts that are too large for any file, as digits if `count` consists of digits, else as binary numbers of
/// equal width.
fn huge(made: &Made, count: &[u8]) -> Vec<Vec<u8>> {
    if count.iter().all(u8::is_ascii_digit) {
        let numbers = ["4000000000", "9223372036854775807", "18446744073709551615"];
        let more = ["99999999999999999999999", "-1", "1e9"];
        return numbers.iter().chain(&more).map(|n| n.as_bytes().to_vec()).collect();
    }
    let mut all = vec![vec![0xFF; count.len()]];
    // The largest and the smallest signed number, and two numbers whose multiples overflow to small numbers.
    for (first, others) in [(0x7F, 0xFF), (0x80, 0), (0x40, 0), (0x20, 0)] {
        let mut bytes = vec![others; count.len()];
        bytes[0] = first;
        if !made.big {
            bytes.reverse();
        }
        all.push(bytes);
    }
    all
}

#[test]
fn counts_beyond_the_file_are_errors() {
    for_each(&base(), |made| {
        for count in &made.counts {
            for huge in huge(made, &made.bytes[count.clone()]) {
                let [before, after] = [&made.bytes[..count.start], &made.bytes[count.end..]];
                let folder = folder(made, &[before, &huge, after].concat());
                let start = Instant::now();
                let read = mesh_or_error(&folder, made.name);
                let seconds = start.elapsed().as_secs_f64();
                let shown = String::from_utf8_lossy(&huge);
                assert!(read.is_err(), "{shown:?} at byte {} is read", count.start);
                assert!(seconds < 5.0, "{shown:?} at byte {}: {seconds} s", count.start);
            }
        }
    });
}

#[test]
fn wrong_counts_are_errors() {
    for_each(&base(), |made| {
        for count in &made.counts {
            let bytes = &made.bytes;
            let Ok(text) = str::from_utf8(&bytes[count.clone()]) else { continue };
            let Ok(number) = text.parse::<u64>() else { continue };
            // The count is too large by one, so the reader meets another item after the list.
            let more = (number + 1).to_string();
            let parts = [&bytes[..count.start], more.as_bytes(), &bytes[count.end..]];
            let read = mesh_or_error(&folder(made, &parts.concat()), made.name);
            assert!(read.is_err(), "{more} for {number} at byte {}", count.start);
        }
    });
}

/// A file with random bytes cut, replaced or doubled gives an error or a mesh with all locations, never a panic.
#[test]
fn damaged_files_of_other_programs_never_panic() {
    let rounds = damage::rounds(1000);
    let all = all(&base());
    let mut random = random(17);
    for format in Format::ALL {
        let samples: Vec<_> = all.iter().filter(|made| made.format == format).collect();
        if samples.is_empty() {
            continue;
        }
        let folders: Vec<_> = samples.iter().map(|made| folder(made, &[])).collect();
        let mut read = 0;
        for round in 0..rounds {
            let (made, folder) = (samples[round % samples.len()], &folders[round % samples.len()]);
            let content = damaged(&made.bytes, &mut random);
            folder.put(made.name, &content);
            let start = Instant::now();
            if let Ok(file) = mesh_or_error(folder, made.name) {
                read += 1;
                if round % 7 == 0 {
                    file.write(&folder.path("out"), file.points()).unwrap();
                    assert!(fs::read(folder.path("out")).unwrap() == content, "{}", made.what);
                }
            }
            assert!(start.elapsed().as_secs() < 10, "{} takes forever", made.what);
        }
        let few = rounds / 50;
        assert!((few..rounds - few).contains(&read), "{format}: {read} of {rounds} were read");
    }
}

/// Writes a file of every layout as a start input of the fuzzer, if the environment variable FUZZ_CORPUS names a
/// folder.
#[test]
fn the_corpus_can_be_written() {
    let Some(folder) = std::env::var_os("FUZZ_CORPUS") else { return };
    let folder = std::path::Path::new(&folder).join("read");
    fs::create_dir_all(&folder).unwrap();
    for (index, made) in all(&base()).iter().enumerate() {
        fs::write(folder.join(format!("layout{index}")), &made.bytes).unwrap();
    }
}
