//! Mesh files that are compressed as a whole by gzip or zstd.

use super::facts::mesh_of;
use super::made::base;
use super::others::for_each;
use super::{ELE, Folder, GMSH22, NODE};
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use mesh_io::{Location, MeshFile};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::fs;
use std::io::{Read, Write};
use std::path::Path;

/// Returns the bytes compressed by gzip at another level than that of the writer.
fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut content = Vec::new();
    GzDecoder::new(bytes).read_to_end(&mut content).unwrap();
    content
}

#[test]
fn every_variant_is_read_and_written_compressed() {
    for_each(&base(), |made| {
        let bytes = packed(&made.bytes);
        let [input, output] = ["", "out-"].map(|before| format!("{before}{}.gz", made.name));
        let output = if made.name == "fort.14" { "out.14.gz" } else { &output };
        let folder = Folder::new(&[]);
        fs::write(folder.path(&input), &bytes).unwrap();
        fs::write(folder.path(made.name), &made.bytes).unwrap();
        let (file, plain) = (folder.read(&input), folder.read(made.name));
        assert_eq!((file.format(), mesh_of(&file)), (plain.format(), mesh_of(&plain)));
        // If no vertex moves, the compressed bytes come back, whichever program compressed them.
        file.write(&folder.path(output), file.points()).unwrap();
        assert!(fs::read(folder.path(output)).unwrap() == bytes);
        // If vertices move, the decompressed content equals the file that is written without compression.
        let mut moved = file.points().to_vec();
        moved[14][0] += 0.0625;
        let uncompressed = output.trim_end_matches(".gz");
        plain.write(&folder.path(uncompressed), &moved).unwrap();
        let expected = fs::read(folder.path(uncompressed)).unwrap();
        assert!(expected != made.bytes);
        for file in [&file, &plain] {
            file.write(&folder.path(output), &moved).unwrap();
            assert!(unpacked(&fs::read(folder.path(output)).unwrap()) == expected);
            file.write(&folder.path(uncompressed), &moved).unwrap();
            assert!(fs::read(folder.path(uncompressed)).unwrap() == expected);
        }
    });
}

#[test]
fn a_file_compressed_under_a_plain_name_stays_compressed() {
    let folder = Folder::new(&[]);
    fs::write(folder.path("a.msh"), packed(GMSH22.as_bytes())).unwrap();
    let file = folder.read("a.msh");
    let mut points = file.points().to_vec();
    points[4][0] = 0.375;
    file.write(&folder.path("a.msh"), &points).unwrap();
    let content = unpacked(&fs::read(folder.path("a.msh")).unwrap());
    assert_eq!(String::from_utf8(content).unwrap(), GMSH22.replace("5 0.25 0.5", "5 0.375 0.5"));
}

#[test]
fn places_in_compressed_files_are_those_of_the_content() {
    let folder = Folder::new(&[]);
    fs::write(folder.path("a.msh.gz"), packed(GMSH22.as_bytes())).unwrap();
    let place = folder.read("a.msh.gz").vertex_location(0);
    assert_eq!((place.location, place.id), (Location::Line(10), 900_000_000_000));
    let cut = packed(&GMSH22.as_bytes()[..300]);
    fs::write(folder.path("a.msh.gz"), cut).unwrap();
    let error = MeshFile::read(&folder.path("a.msh.gz")).unwrap_err().to_string();
    assert!(error.contains("a.msh.gz:"), "{error}");
}

#[test]
fn files_that_cannot_be_decompressed_are_errors() {
    let folder = Folder::new(&[]);
    let refused = |name: &str, bytes: &[u8], parts: &[&str]| {
        fs::write(folder.path(name), bytes).unwrap();
        let error = MeshFile::read(&folder.path(name)).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    };
    let whole = packed(GMSH22.as_bytes());
    refused("a.msh.gz", &whole[..whole.len() / 2], &["a.msh.gz: ", "damaged or cut off"]);
    refused("a.msh.gz", &packed(&vec![b'\n'; 30 << 20]), &["200 times its size", "gunzip"]);
    refused("a.msh.zst", b"\x28\xB5\x2F\xFD\0\0", &["by zstd, but damaged or cut off"]);
    refused("a.msh.bz2", b"BZh91AY", &["compressed by bzip2", "bunzip2"]);
    refused("a.msh.gz", &packed(b""), &["the file is empty"]);
    let not_read = ["a.node.gz", "not read compressed", "gunzip"];
    refused("a.node.gz", &packed(NODE.as_bytes()), &["a.ele: not found", "beside", "a.node.gz"]);
    for other in ["a.ele.gz", "a.ele"] {
        fs::write(folder.path(other), packed(ELE.as_bytes())).unwrap();
        refused("a.node.gz", &packed(NODE.as_bytes()), &not_read);
        fs::remove_file(folder.path(other)).unwrap();
    }
    fs::remove_file(folder.path("a.node.gz")).unwrap();
    refused("a.ele.gz", &packed(ELE.as_bytes()), &["a.node: not found", "a.ele.gz"]);
    fs::write(folder.path("b.ele"), packed(ELE.as_bytes())).unwrap();
    refused("b.node", NODE.as_bytes(), &["b.ele: ", "not read compressed", "gunzip"]);
}

#[test]
fn a_triangle_mesh_is_not_written_compressed() {
    let folder = Folder::new(&[("a.node", NODE), ("a.ele", ELE)]);
    let file = folder.read("a.node");
    let error = file.write(&folder.path("b.node.gz"), file.points()).unwrap_err().to_string();
    assert!(error.contains("not written compressed") && error.contains(".node"), "{error}");
    assert_eq!(folder.count(), 2);
}

#[test]
fn bytes_in_memory_are_read_and_written() {
    let name = Path::new("memory");
    for bytes in [GMSH22.as_bytes().to_vec(), packed(GMSH22.as_bytes())] {
        let file = MeshFile::from_bytes(name, bytes.clone()).unwrap();
        let mut out = Vec::new();
        file.write_to(name, &mut out, file.points()).unwrap();
        assert!(out == bytes);
        let error = file.write_to(name, &mut Vec::new(), &[]).unwrap_err().to_string();
        assert!(error.contains("memory") && error.contains("0 points given"), "{error}");
    }
    let error = MeshFile::from_bytes(name, b"hello".to_vec()).unwrap_err().to_string();
    assert!(error.starts_with("memory: the format is not recognized"), "{error}");
    let error = MeshFile::from_bytes(Path::new("a.node"), NODE.into()).unwrap_err().to_string();
    assert!(error.contains("one of the two files of a Triangle mesh"), "{error}");
    let folder = Folder::new(&[("a.node", NODE), ("a.ele", ELE)]);
    let file = folder.read("a.node");
    let error = file.write_to(name, &mut Vec::new(), file.points()).unwrap_err().to_string();
    assert!(error.contains("of several files. Name a file"), "{error}");
}

#[test]
fn files_compressed_by_zstd_are_read_and_written() {
    let folder = Folder::new(&[("plain.msh", GMSH22)]);
    // Another program may store the content uncompressed in the zstd frame.
    let bytes = compress_to_vec(GMSH22.as_bytes(), CompressionLevel::Uncompressed);
    fs::write(folder.path("in.msh.zst"), &bytes).unwrap();
    let (file, plain) = (folder.read("in.msh.zst"), folder.read("plain.msh"));
    assert_eq!((file.format(), mesh_of(&file)), (plain.format(), mesh_of(&plain)));
    file.write(&folder.path("same.msh.ZST"), file.points()).unwrap();
    assert!(fs::read(folder.path("same.msh.ZST")).unwrap() == bytes);
    let mut moved = file.points().to_vec();
    moved[4][0] += 0.0625;
    plain.write(&folder.path("moved.msh"), &moved).unwrap();
    let expected = folder.text("moved.msh");
    for name in ["out.msh.zst", "out.msh.gz", "out.msh"] {
        file.write(&folder.path(name), &moved).unwrap();
        let start = fs::read(folder.path(name)).unwrap()[..2].to_vec();
        let packed = [("zst", [0x28, 0xB5]), ("gz", [0x1F, 0x8B]), ("msh", [b'$', b'M'])];
        assert!(packed.iter().any(|(ending, opens)| name.ends_with(ending) && start == opens));
        let back = folder.read(name);
        back.write(&folder.path("back.msh"), back.points()).unwrap();
        assert_eq!(folder.text("back.msh"), expected, "{name}");
    }
}
