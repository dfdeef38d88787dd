//! Golden files: hashes of every file that is written from the samples of all formats, recorded in `golden.txt` beside
//! this file. A commit that changes a recorded hash must contain no other change, and must give the reason.
//! `GPU_SMOOTH_GOLDEN=write cargo test -p mesh-io --test formats golden` writes the record.

use super::facts::mesh_of;
use super::made::{all, base};
use super::others::folder;
use super::{ELE, Folder, GMSH22, GMSH41, NODE, POLY};
use mesh_io::{Conversion, MeshFile};
use std::fmt::Write as _;
use std::path::Path;

/// Command line that writes the record.
const RECORD: &str = "GPU_SMOOTH_GOLDEN=write cargo test -p mesh-io --test formats golden";

/// Returns the FNV-1a hash with 64 bits.
fn hash(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Returns hashes of the mesh, its groups, its files with moved vertices, and all its conversions.
fn hashes(folder: &Folder, file: &MeshFile, name: &str) -> String {
    let mesh = mesh_of(file);
    let mut fixed = mesh.fixed.clone();
    fixed.sort_unstable();
    fixed.dedup();
    let points = mesh.points.as_flattened().iter().flat_map(|x| x.to_le_bytes());
    let numbers =
        mesh.triangles.as_flattened().iter().chain(&fixed).chain(file.regions().unwrap_or(&[]));
    let read = hash(points.chain(numbers.flat_map(|number| number.to_le_bytes())));
    let mut groups = Vec::new();
    for group in file.groups().unwrap().iter() {
        let is_of_lines = group.dimension == 1 && !group.vertices().is_empty();
        assert!(!is_of_lines || file.may_name_lines(), "{name}: {group}");
        groups.extend(format!("{} {:?} {:?}", group.dimension, group.tag, group.name).bytes());
        let members = group.vertices().iter().chain(group.triangles());
        groups.extend(members.flat_map(|member| member.to_le_bytes()));
    }
    let moved: Vec<_> = mesh.points.iter().map(|[x, y]| [1.1 * x + 0.013, y - 0.007]).collect();
    let out = folder.path("moved").join(name);
    std::fs::create_dir_all(folder.path("moved")).unwrap();
    file.write(&out, &moved).unwrap();
    let written = file.destinations(&out).unwrap();
    let written = written.iter().flat_map(|path| std::fs::read(path).unwrap());
    let converted = Conversion::targets().flat_map(|(name, format)| {
        let mut conversion = Conversion::new(file, format).unwrap().unwrap();
        conversion.set_creator("gpu-smooth");
        let out = folder.path("moved").join(name);
        conversion.write(&out).unwrap();
        let paths = conversion.destinations(&out);
        // Triangle meshes without lines have no `.poly`, so some destinations do not exist.
        let there = paths.into_iter().filter(|path| path.exists());
        there.flat_map(|path| std::fs::read(path).unwrap()).collect::<Vec<_>>()
    });
    let [groups, written, converted] = [hash(groups), hash(written), hash(converted)];
    format!(
        "read {read:016x} groups {groups:016x} written {written:016x} converted {converted:016x}"
    )
}

#[test]
fn files_written_from_every_sample_have_the_recorded_bytes() {
    let mut lines = String::new();
    for made in &all(&base()) {
        let folder = folder(made, &made.bytes);
        let hashes = hashes(&folder, &folder.read(made.name), made.name);
        writeln!(lines, "{} {hashes}", made.what.replace('\n', " ")).unwrap();
    }
    let texts: [&[(&str, &str)]; 4] = [
        &[("a.node", NODE), ("a.ele", ELE)],
        &[("a.node", NODE), ("a.ele", ELE), ("a.poly", POLY)],
        &[("a.msh", GMSH22)],
        &[("a.msh", GMSH41)],
    ];
    for files in texts {
        let folder = Folder::new(files);
        let name = files[0].0;
        writeln!(lines, "{name} {}", hashes(&folder, &folder.read(name), name)).unwrap();
    }
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/h5");
    let mut names: Vec<_> =
        std::fs::read_dir(&samples).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    for name in names.iter().map(|name| name.to_str().unwrap()) {
        let folder = Folder::new(&[]);
        for other in &names {
            std::fs::copy(samples.join(other), folder.path(other.to_str().unwrap())).unwrap();
        }
        if let Ok(file) = MeshFile::read(&folder.path(name)) {
            writeln!(lines, "{name} {}", hashes(&folder, &file, name)).unwrap();
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/golden.txt");
    if std::env::var("GPU_SMOOTH_GOLDEN").is_ok_and(|what| what == "write") {
        std::fs::write(&path, &lines).unwrap();
    }
    let recorded = std::fs::read_to_string(&path).unwrap();
    // A new sample may come before others, so the test reports only lines that the other text lacks.
    let missing = |from: &str, sign: &str, other: &str| {
        let has = |line: &&str| !other.lines().any(|own| own == *line);
        from.lines().filter(has).map(|line| format!("{sign} {line}")).collect::<Vec<_>>()
    };
    let differ = [missing(&recorded, "-", &lines), missing(&lines, "+", &recorded)].concat();
    assert!(
        differ.is_empty(),
        "lines of golden.txt differ; if that is meant, as for a new sample, {RECORD} writes them anew\n{}",
        differ.join("\n")
    );
    assert_eq!(recorded.lines().count(), lines.lines().count(), "{RECORD} writes golden.txt anew");
}
