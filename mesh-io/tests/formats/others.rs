//! Formats of other programs: readers get the expected mesh from each variant, and a rewrite changes only moved
//! coordinates.

use super::Folder;
use super::facts::{between_regions, fixed, freed};
use super::made::{Made, PROBED, all, base};
use super::nastran;
use mesh_io::{Format, Location, MeshFile};
use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use support::Mesh;
use support::{SplitMix64, check};

/// Runs a check on every variant, and fails with the names of the failing variants.
#[track_caller]
pub(crate) fn for_each(mesh: &Mesh, check: impl Fn(&Made) + Sync) {
    let all = all(mesh);
    let (next, failed) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some(made) = all.get(next.fetch_add(1, Ordering::Relaxed)) {
            if catch_unwind(AssertUnwindSafe(|| check(made))).is_err() {
                failed.lock().unwrap().push(&made.what);
            }
        }
    };
    // Not threads of rayon, which would start another variant while they wait for the parts of a file.
    std::thread::scope(|scope| {
        (0..4).for_each(|_| drop(scope.spawn(work)));
    });
    let failed = failed.into_inner().unwrap();
    assert!(failed.is_empty(), "{} of {} failed: {failed:#?}", failed.len(), all.len());
}

/// Returns a folder with a file of the sample's name and these bytes.
pub(crate) fn folder(made: &Made, bytes: &[u8]) -> Folder {
    let folder = Folder::new(&[]);
    fs::write(folder.path(made.name), bytes).unwrap();
    folder
}

/// Returns the text with a carriage return before each line feed.
fn with_crlf(bytes: &[u8]) -> Vec<u8> {
    str::from_utf8(bytes).unwrap().replace('\n', "\r\n").into_bytes()
}

/// Returns the bytes of the file; for text, also a copy with carriage returns before line feeds.
fn both_ends(made: &Made) -> Vec<Vec<u8>> {
    let mut both = vec![made.bytes.clone()];
    if made.is_text() {
        both.push(with_crlf(&made.bytes));
    }
    both
}

fn bits(points: &[[f64; 2]]) -> Vec<[u64; 2]> {
    points.iter().map(|p| p.map(f64::to_bits)).collect()
}

fn set(vertices: &[u32]) -> BTreeSet<u32> {
    vertices.iter().copied().collect()
}

#[test]
fn every_variant_is_read_as_what_it_holds() {
    for_each(&base(), |made| {
        for bytes in both_ends(made) {
            let file = folder(made, &bytes).read(made.name);
            assert_eq!((file.format(), file.precision()), (made.format, made.precision));
            assert_eq!(bits(file.points()), bits(&made.points()));
            assert_eq!(file.triangles(), made.mesh.triangles);
            assert_eq!(file.regions(), made.regions.as_deref());
            let interfaces = made.interfaces();
            assert_eq!(between_regions(&file), interfaces);
            let held = [made.mesh.fixed.as_slice(), &interfaces].concat();
            assert_eq!(set(&fixed(&file)), set(&held));
            assert_eq!(set(&file.constraints().vertices), set(&made.mesh.fixed));
            assert!(check::mover_count(&freed(&file)) >= 4, "nothing is left to move");
        }
    });
}

/// Every format is tested here or, like Triangle and gmsh, in other files, and has a row in docs/formats.md.
#[test]
fn every_format_is_tried_and_documented() {
    let made: BTreeSet<String> = all(&base()).iter().map(|made| made.format.to_string()).collect();
    let documented = include_str!("../../../docs/formats.md");
    let first_column =
        documented.lines().filter_map(|line| line.strip_prefix("| ")?.split('|').next());
    let names: BTreeSet<&str> =
        first_column.flat_map(|names| names.split(", ")).map(str::trim).collect();
    for format in Format::ALL {
        let name = format.to_string();
        assert!(
            names.contains(name.as_str()),
            "{name} has no row in docs/formats.md: add one to ROWS of mesh-io/src/convert/doc_tests.rs, \
             and run UPDATE_DOCS=1 cargo test -p mesh-io --lib doc_tests"
        );
        let elsewhere = ["Triangle", "gmsh 2.2", "gmsh 4.1", "VTK XML", "STL", "MED", "CGNS"];
        assert!(
            made.contains(&name) || elsewhere.iter().any(|other| name.starts_with(other)),
            "{name} has no sample: add one to a file of mesh-io/tests/formats/made"
        );
    }
}

#[test]
fn unmoved_points_give_the_same_bytes_in_every_variant() {
    for_each(&base(), |made| {
        for bytes in both_ends(made) {
            let folder = folder(made, &bytes);
            let file = folder.read(made.name);
            file.write(&folder.path("out"), file.points()).unwrap();
            assert!(fs::read(folder.path("out")).unwrap() == bytes, "the bytes have changed");
            // Digits beyond the precision of the file do not count as a move.
            file.write(&folder.path("out"), &made.mesh.points).unwrap();
            assert!(fs::read(folder.path("out")).unwrap() == bytes, "the bytes have changed");
        }
    });
}

/// Returns the points with all free vertices moved.
fn moved(file: &MeshFile) -> Vec<[f64; 2]> {
    let mut rng = SplitMix64::new(3);
    let mut points = file.points().to_vec();
    let movers = check::held(&freed(file)).into_iter().enumerate().filter(|(_, held)| !held);
    for (count, (v, _)) in movers.enumerate() {
        let [x, y] = points[v];
        points[v] = match count {
            0 => [x + 1.0 / 3.0, y],
            1 => [x, -0.0],
            2 => [1e-7, 1e16],
            _ => [x + rng.range(-0.3, 0.3), y - rng.range(-0.3, 0.3)],
        };
    }
    points
}

/// Splits a text into words and the separators between the words, or a Nastran file into the contents of its fields.
pub(crate) fn pieces(format: Format, bytes: &[u8]) -> Vec<String> {
    if format == Format::Nastran {
        return nastran::fields(str::from_utf8(bytes).unwrap());
    }
    let is_between = |byte: &u8| byte.is_ascii_whitespace() || *byte == b';';
    let pieces = bytes.chunk_by(|a, b| is_between(a) == is_between(b));
    pieces.map(|piece| String::from_utf8_lossy(piece).into_owned()).collect()
}

pub(crate) fn value(word: &str) -> f64 {
    let number = word.replace('D', "E");
    number.parse().unwrap_or_else(|_| nastran::value(&number))
}

/// Checks that exactly the words of moved coordinates differ.
fn assert_text_moved(made: &Made, before: &[u8], after: &[u8], to: &[[f64; 2]]) {
    let [old, new] = [before, after].map(|bytes| pieces(made.format, bytes));
    assert_eq!(old.len(), new.len());
    let round = |x: f64| made.precision.rounded(x);
    let differing: Vec<_> = old
        .iter()
        .zip(&new)
        .filter(|(old, new)| old != new)
        .map(|(old, new)| [round(value(old)), round(value(new))].map(f64::to_bits))
        .collect();
    let from = made.points();
    let expected: Vec<_> = from
        .as_flattened()
        .iter()
        .zip(to.as_flattened())
        .map(|(&from, &to)| [from, round(to)].map(f64::to_bits))
        .filter(|[from, to]| from != to)
        .collect();
    assert!(expected.len() > 6, "only {} coordinates have moved", expected.len());
    assert_eq!(differing, expected);
}

/// Returns the bytes of a binary file with the coordinates `to` written in place.
fn rewritten(made: &Made, to: &[[f64; 2]]) -> Vec<u8> {
    let mut bytes = made.bytes.clone();
    for (places, point) in made.coordinates.iter().zip(to) {
        for (&at, &x) in places.iter().zip(point) {
            let mut number = support::Binary::empty(made.big);
            number.reals(made.precision, &[x]);
            bytes[at..at + number.bytes.len()].copy_from_slice(&number.bytes);
        }
    }
    bytes
}

#[test]
fn only_moved_coordinates_change_in_every_variant() {
    for_each(&base(), |made| {
        for bytes in both_ends(made) {
            let folder = folder(made, &bytes);
            let file = folder.read(made.name);
            let to = moved(&file);
            // The output file is the input file.
            file.write(&folder.path(made.name), &to).unwrap();
            let after = fs::read(folder.path(made.name)).unwrap();
            let again = folder.read(made.name);
            let rounded: Vec<_> = to.iter().map(|p| p.map(|x| made.precision.rounded(x))).collect();
            assert_eq!(bits(again.points()), bits(&rounded));
            // The cells of a net depend on its coordinates, and these moves invert triangles.
            if !made.lists_edges() {
                assert_eq!(again.triangles(), file.triangles());
            }
            if made.is_text() {
                assert_text_moved(made, &bytes, &after, &to);
            } else {
                assert!(after == rewritten(made, &to), "other bytes have changed");
            }
        }
    });
}

#[test]
fn places_in_the_file_are_those_of_vertices_and_triangles() {
    for_each(&base(), |made| {
        let line = |at: usize| 1 + made.bytes[..at].iter().filter(|&&byte| byte == b'\n').count();
        for bytes in both_ends(made) {
            let file = folder(made, &bytes).read(made.name);
            let vertex = file.vertex_location(PROBED.0);
            let triangle = file.triangle_location(PROBED.1);
            for (what, place, (label, range)) in
                [("vertex", vertex, &made.vertex), ("triangle", triangle, &made.triangle)]
            {
                assert_eq!(place.id, *label, "the label of the {what}");
                let name = place.path.file_name().unwrap();
                assert_eq!(name, made.name);
                match place.location {
                    Location::Line(at) => {
                        let lines = line(range.start)..=line(range.end - 1);
                        assert!(made.is_text() && lines.contains(&at), "{what}: {at}, {lines:?}");
                    }
                    Location::Byte(at) => {
                        assert!(!made.is_text() && range.contains(&at), "{what}: {at}, {range:?}");
                    }
                    Location::Unknown => panic!("{what} is not found"),
                }
            }
        }
    });
}

#[test]
fn places_asked_for_together_are_the_same_in_every_variant() {
    for_each(&base(), |made| {
        let file = folder(made, &made.bytes).read(made.name);
        let (vertices, triangles) = (made.mesh.points.len(), made.mesh.triangles.len());
        let places = file.vertex_locations(0..vertices as u32);
        assert_eq!(places.len(), vertices);
        assert!(places.iter().all(|(&v, place)| *place == file.vertex_location(v)));
        let places = file.triangle_locations(0..triangles);
        assert_eq!(places.len(), triangles);
        assert!(places.iter().all(|(&t, place)| *place == file.triangle_location(t)));
    });
}
