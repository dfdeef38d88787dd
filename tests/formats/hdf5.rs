//! Meshes in HDF5, as several programs write them: `h5/make.py` has made the files.

use super::damage::{self, damaged, random};
use super::{Folder, support::check};
use gpu_smooth::{Conversion, Format, MeshFile, PointField};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A file, and those beside it that it names.
struct Sample {
    name: &'static str,
    beside: &'static [&'static str],
    /// Whether all numbers stand in the file as they are, so that its length does not change.
    is_plain: bool,
}

const SAMPLES: [Sample; 9] = [
    Sample { name: "dolfin.xdmf", beside: &["dolfin.h5"], is_plain: true },
    Sample { name: "meshio.xdmf", beside: &["meshio.h5"], is_plain: false },
    Sample { name: "latest.xdmf", beside: &["latest.h5"], is_plain: false },
    Sample { name: "chunked.xdmf", beside: &["chunked.h5"], is_plain: false },
    Sample { name: "raw.xdmf", beside: &["raw-cells.bin", "raw.bin"], is_plain: true },
    Sample { name: "gmsh.cgns", beside: &[], is_plain: true },
    Sample { name: "gmsh.med", beside: &[], is_plain: true },
    Sample { name: "netcdf4.exo", beside: &[], is_plain: true },
    Sample { name: "zlib.exo", beside: &[], is_plain: false },
];

fn made(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/h5").join(name)
}

impl Sample {
    /// A folder with the files.
    fn folder(&self) -> Folder {
        let folder = Folder::new(&[]);
        for name in [self.name].iter().chain(self.beside) {
            fs::copy(made(name), folder.path(name)).unwrap();
        }
        folder
    }

    /// What the files that are called so hold.
    fn bytes(&self, file: &MeshFile) -> Vec<Vec<u8>> {
        file.paths().map(|path| fs::read(path).unwrap()).collect()
    }
}

/// What files give that may be damaged: a mesh whose parts are found again, or an error of one line with the name of one of them.
fn mesh_or_error(folder: &Folder, sample: &Sample) -> Option<MeshFile> {
    match MeshFile::read(&folder.path(sample.name)) {
        Ok(file) => {
            let (vertices, triangles) = (file.mesh().points.len(), file.mesh().triangles.len());
            let mut named = file.mesh().triangles.iter().flatten().chain(&file.mesh().fixed);
            assert!(named.all(|&v| (v as usize) < vertices));
            assert_eq!(file.vertex_places(0..vertices as u32).len(), vertices);
            assert_eq!(file.triangle_places(0..triangles).len(), triangles);
            Some(file)
        }
        Err(error) => {
            let error = error.to_string();
            let stem = sample.name.split('.').next().unwrap();
            assert!(error.contains(stem) && error.lines().count() == 1, "{error}");
            None
        }
    }
}

fn bits(points: &[[f64; 2]]) -> Vec<[u64; 2]> {
    points.iter().map(|p| p.map(f64::to_bits)).collect()
}

/// Where the corners of each triangle are, in any order.
fn corners(mesh: &gpu_smooth::Mesh) -> Vec<[[u64; 2]; 3]> {
    let of = |triangle: &[u32; 3]| {
        let mut corners = triangle.map(|v| mesh.points[v as usize].map(f64::to_bits));
        let first = (0..3).min_by_key(|&k| corners[k]).unwrap();
        corners.rotate_left(first);
        corners
    };
    let mut all: Vec<_> = mesh.triangles.iter().map(of).collect();
    all.sort_unstable();
    all
}

/// The points with those that may move at other places, of digits that take room.
fn moved(file: &MeshFile, by: f64) -> Vec<[f64; 2]> {
    let mut points = file.mesh().points.clone();
    let held = check::held(file.mesh());
    for (v, point) in points.iter_mut().enumerate().filter(|(v, _)| !held[*v]) {
        let at = (v as f64 + by).sin() * 0.1;
        *point = point.map(|x| file.precision().rounded(x + at));
    }
    points
}

/// What is read of each is what the plain file has.
#[test]
fn every_file_has_the_mesh() {
    let plain = MeshFile::read(&made("plain.xdmf")).unwrap();
    for sample in &SAMPLES {
        let file = MeshFile::read(&made(sample.name)).unwrap();
        let rounded: Vec<_> =
            plain.mesh().points.iter().map(|p| p.map(|x| file.precision().rounded(x))).collect();
        let given = gpu_smooth::Mesh { points: rounded, ..plain.mesh().clone() };
        assert_eq!(corners(file.mesh()), corners(&given), "{}", sample.name);
        if !sample.name.starts_with("gmsh") {
            assert_eq!(bits(&file.mesh().points), bits(&given.points), "{}", sample.name);
            assert_eq!(file.mesh().triangles, given.triangles, "{}", sample.name);
        }
        assert_eq!(file.paths().count(), 1 + sample.beside.len());
    }
}

#[test]
fn what_has_not_moved_keeps_its_bytes() {
    for sample in &SAMPLES {
        let folder = sample.folder();
        let file = folder.read(sample.name);
        let before = sample.bytes(&file);
        file.write(&folder.path(sample.name), &file.mesh().points).unwrap();
        assert!(sample.bytes(&file) == before, "{}", sample.name);
        let fields = file.point_fields(None).unwrap();
        file.write_with(&folder.path(sample.name), &file.mesh().points, &fields).unwrap();
        assert!(sample.bytes(&file) == before, "{}", sample.name);
    }
}

/// Again and again, as chunks that have gone to the end of the file may go there once more.
#[test]
fn only_coordinates_change() {
    for sample in &SAMPLES {
        let folder = sample.folder();
        let first = folder.read(sample.name);
        for round in 0..4 {
            let file = folder.read(sample.name);
            let to = moved(&file, f64::from(round));
            let before = sample.bytes(&file);
            file.write(&folder.path(sample.name), &to).unwrap();
            let again = folder.read(sample.name);
            assert_eq!(bits(&again.mesh().points), bits(&to), "{}", sample.name);
            assert_eq!(again.mesh().triangles, first.mesh().triangles);
            let after = sample.bytes(&again);
            assert!(before != after);
            let lengths = before.iter().zip(&after).map(|(a, b)| b.len().cmp(&a.len()));
            assert!(lengths.into_iter().all(|length| length.is_eq() || !sample.is_plain));
            for other in [&first, &file] {
                assert_eq!(other.difference(&again), None, "{}", sample.name);
                assert_eq!(again.difference(other), None, "{}", sample.name);
            }
            let groups = |file: &MeshFile| format!("{:?}", file.groups().unwrap());
            assert_eq!(groups(&first), groups(&again));
            let values = |file: &MeshFile| -> Vec<_> {
                let fields = file.point_fields(None).unwrap();
                fields.iter().map(|field| field.values().to_vec()).collect()
            };
            assert_eq!(values(&first), values(&again), "{}", sample.name);
        }
    }
}

/// A byte that is none of a coordinate shows, wherever it is.
#[test]
fn other_bytes_are_told() {
    for sample in &SAMPLES {
        let folder = sample.folder();
        let first = folder.read(sample.name);
        first.write(&folder.path(sample.name), &moved(&first, 1.0)).unwrap();
        let path = first.paths().nth(usize::from(!sample.beside.is_empty())).unwrap().to_owned();
        let bytes = fs::read(&path).unwrap();
        let mut told = 0;
        for at in (0..bytes.len()).step_by(97) {
            let mut changed = bytes.clone();
            changed[at] ^= 1;
            fs::write(&path, &changed).unwrap();
            let Ok(again) = MeshFile::read(&folder.path(sample.name)) else { continue };
            told += usize::from(first.difference(&again).is_some());
        }
        assert!(told >= bytes.len() / 97 / 4, "{}: {told} were told", sample.name);
    }
}

/// Data of vertices are written as coordinates are, and with them.
#[test]
fn data_are_replaced() {
    for sample in &SAMPLES {
        let folder = sample.folder();
        let file = folder.read(sample.name);
        let mut fields = file.point_fields(None).unwrap();
        let original: Vec<Vec<f64>> = fields.iter().map(|field| field.values().to_vec()).collect();
        for (k, field) in fields.iter_mut().enumerate() {
            let change = |(v, x): (usize, &f64)| x + (v as f64 * 0.7 + k as f64).sin();
            let values = field.values().iter().enumerate().map(change).collect();
            field.set(values).unwrap();
        }
        let to = moved(&file, 3.0);
        file.write_with(&folder.path(sample.name), &to, &fields).unwrap();
        let again = folder.read(sample.name);
        assert_eq!(bits(&again.mesh().points), bits(&to));
        let found = again.point_fields(None).unwrap();
        assert_eq!(found.len(), fields.len());
        for (found, wanted) in found.iter().zip(&fields) {
            let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * (1.0 + b.abs());
            assert!(found.values().iter().zip(wanted.values()).all(close), "{}", sample.name);
        }
        let sides = [&found[..], &fields[..]];
        assert_eq!(again.difference_besides(&file, sides), None, "{}", sample.name);
        // And back to the same numbers.
        let mut back = found;
        let set =
            |(field, values): (&mut PointField, &Vec<f64>)| field.set(values.clone()).unwrap();
        back.iter_mut().zip(&original).for_each(|pair| _ = set(pair));
        again.write_with(&folder.path(sample.name), &file.mesh().points, &back).unwrap();
        let again = folder.read(sample.name);
        assert_eq!(bits(&again.mesh().points), bits(&file.mesh().points));
        let values: Vec<Vec<f64>> =
            again.point_fields(None).unwrap().iter().map(|f| f.values().to_vec()).collect();
        assert_eq!(values, original, "{}", sample.name);
    }
}

/// Families of MED tell regions, and groups have their names.
#[test]
fn groups_of_med_have_their_names() {
    let file = MeshFile::read(&made("gmsh.med")).unwrap();
    assert_eq!(file.format(), Format::Med);
    let groups = file.groups().unwrap();
    assert_eq!(groups.find("steel").unwrap().triangles().len(), 30);
    assert_eq!(groups.find("sand").unwrap().triangles().len(), 10);
    assert_eq!(groups.find("group:line:wire").unwrap().vertices(), [7, 8]);
    assert_eq!(groups.find("family:surface:-2").unwrap().triangles().len(), 10);
    assert!(file.regions().is_some());
    assert!(file.mesh().fixed.contains(&7) && !file.interface_vertices().is_empty());
    let text = Conversion::new(&file, Format::Gmsh41).unwrap().unwrap().text().unwrap();
    assert!(text.contains("\"steel\""), "{text}");
}

/// Sections of CGNS tell regions; boundary conditions and families are groups.
#[test]
fn sections_and_boundaries_of_cgns_are_groups() {
    let file = MeshFile::read(&made("gmsh.cgns")).unwrap();
    assert_eq!(file.format(), Format::Cgns);
    let groups = file.groups().unwrap();
    for name in ["steel", "section:surface:3_S_5", "boundary:S_5", "family:S_5"] {
        assert_eq!(groups.find(name).unwrap().triangles().len(), 30, "{name}");
    }
    assert_eq!(groups.find("sand").unwrap().triangles().len(), 10);
    let wire = groups.find("wire").unwrap().vertices();
    assert!(wire.len() == 2 && wire.iter().all(|v| file.mesh().fixed.contains(v)));
    assert!(file.regions().is_some());
    let place = file.triangle_place(0);
    assert_eq!(place.label, 2);
}

/// Under an ending of HDF5, or none, the content tells what it is, and in place it keeps its name.
#[test]
fn any_file_of_hdf5_is_known_by_its_content() {
    let all =
        [("gmsh.med", Format::Med), ("gmsh.cgns", Format::Cgns), ("zlib.exo", Format::Exodus)];
    for (name, format) in all {
        let folder = Folder::new(&[]);
        for under in ["in.h5", "in.hdf5", "in", "in.dat"] {
            fs::copy(made(name), folder.path(under)).unwrap();
            let file = folder.read(under);
            assert_eq!(file.format(), format);
            file.write(&folder.path(under), &moved(&file, 1.0)).unwrap();
            assert_eq!(folder.read(under).difference(&file), None);
        }
    }
    refused(
        MeshFile::read(&made("dolfin.h5")),
        &["no mesh of Exodus II, MED or CGNS", "name the .xdmf"],
    );
}

/// What netCDF-4 has is what the classic format has: groups and their names, and data in every time step.
#[test]
fn netcdf_gives_the_same_in_every_format() {
    let classic = MeshFile::read(&made("classic.exo")).unwrap();
    for name in ["netcdf4.exo", "zlib.exo"] {
        let file = MeshFile::read(&made(name)).unwrap();
        assert_eq!(file.format(), Format::Exodus);
        assert_eq!(file.mesh(), classic.mesh());
        assert_eq!(file.regions(), classic.regions());
        let groups = |file: &MeshFile| format!("{:?}", file.groups().unwrap());
        assert_eq!(groups(&file), groups(&classic));
        assert_eq!(file.data_names(), ["T"]);
        let values = |file: &MeshFile| -> Vec<_> {
            let fields = file.point_fields(None).unwrap();
            fields.iter().map(|field| field.values().to_vec()).collect()
        };
        assert_eq!(values(&file).len(), 2);
        assert_eq!(values(&file), values(&classic));
        let text = |file: &MeshFile| Conversion::new(file, Format::Gmsh41).unwrap().unwrap().text();
        assert_eq!(text(&file), text(&classic));
    }
}

/// Random bytes cut, replaced, doubled: an error or a mesh that can be located, never a panic.
#[test]
fn damaged_files_of_hdf5_never_panic() {
    let mut random = random(23);
    for sample in &SAMPLES {
        let folder = sample.folder();
        let files: Vec<&str> = [sample.name].iter().chain(sample.beside).copied().collect();
        let whole: Vec<Vec<u8>> = files.iter().map(|name| fs::read(made(name)).unwrap()).collect();
        let ending = |name: &str| name.split('.').next_back().map(str::to_owned);
        let alike = SAMPLES.iter().filter(|other| ending(other.name) == ending(sample.name));
        let rounds = damage::rounds(2000) / alike.count();
        let mut read = 0;
        for round in 0..rounds {
            let part = round % files.len();
            let content = match round % 3 {
                // Text and counts of another length are seldom read: a byte more often is.
                0 => damaged(&whole[part], &mut random),
                _ => {
                    let mut content = whole[part].clone();
                    let at = random(content.len());
                    content[at] = [0, 1, 0xFF, content[at] ^ 1][random(4)];
                    content
                }
            };
            fs::write(folder.path(files[part]), &content).unwrap();
            let start = Instant::now();
            let read_again = mesh_or_error(&folder, sample);
            read += usize::from(read_again.is_some());
            if let Some(file) = read_again.filter(|_| round % 7 == 0) {
                let before = sample.bytes(&file);
                file.write(&folder.path(sample.name), &file.mesh().points).unwrap();
                assert!(sample.bytes(&file) == before, "{}", sample.name);
                let to = moved(&file, 1.0);
                file.write(&folder.path(sample.name), &to).unwrap();
                if let Ok(fields) = file.point_fields(None) {
                    assert!(fields.len() < 100);
                }
            }
            assert!(start.elapsed().as_secs() < 10, "{} takes forever", sample.name);
            // What was damaged, and what was written.
            for (name, bytes) in files.iter().zip(&whole) {
                if name == &files[part] || round % 7 == 0 {
                    fs::write(folder.path(name), bytes).unwrap();
                }
            }
        }
        let few = rounds / 50;
        assert!((few..rounds - few).contains(&read), "{}: {read} of {rounds}", sample.name);
    }
}

/// Under another name the files beside it are called after it, and it names them so.
#[test]
fn another_name_is_that_of_all_files() {
    for sample in SAMPLES.iter().filter(|sample| !sample.beside.is_empty()) {
        let folder = sample.folder();
        let file = folder.read(sample.name);
        let to = moved(&file, 2.0);
        fs::create_dir(folder.path("sub")).unwrap();
        for out in ["out.xdmf", "sub/a & b.xmf", "sub/out"] {
            let stem = Path::new(sample.name).file_stem().unwrap().to_str().unwrap();
            let new = Path::new(out).file_stem().unwrap().to_str().unwrap();
            let destinations = file.destinations(&folder.path(out)).unwrap();
            let expected: Vec<PathBuf> = sample
                .beside
                .iter()
                .map(|name| folder.path(out).with_file_name(name.replace(stem, new)))
                .collect();
            assert_eq!(destinations[1..], expected);
            file.write(&folder.path(out), &to).unwrap();
            assert!(destinations.iter().all(|path| path.is_file()));
            let again = folder.read(out);
            assert_eq!(bits(&again.mesh().points), bits(&to));
            let own: Vec<PathBuf> = again.paths().map(Path::to_path_buf).collect();
            assert_eq!(own, destinations);
            assert_eq!(file.difference(&again), None);
            assert_eq!(again.difference(&file), None);
            // The files that were read are as they were.
            for name in [sample.name].iter().chain(sample.beside) {
                assert!(fs::read(folder.path(name)).unwrap() == fs::read(made(name)).unwrap());
            }
            // And back under the old name, with the old places: the same text.
            fs::create_dir_all(folder.path("back")).unwrap();
            let back = folder.path("back").join(sample.name);
            again.write(&back, &file.mesh().points).unwrap();
            assert!(fs::read(&back).unwrap() == fs::read(made(sample.name)).unwrap());
        }
    }
}

fn refused(read: Result<MeshFile, gpu_smooth::ReadError>, parts: &[&str]) {
    let error = read.unwrap_err().to_string();
    assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
}

#[test]
fn files_that_are_not_beside_it_are_told() {
    let sample = &SAMPLES[0];
    let folder = sample.folder();
    let path = folder.path(sample.name);
    let text = fs::read_to_string(&path).unwrap();
    let bytes = text.clone().into_bytes();
    refused(MeshFile::from_bytes(&path, bytes), &["dolfin.h5, a file beside it", "Name the file"]);
    let read = |text: String| {
        fs::write(&path, text).unwrap();
        MeshFile::read(&path)
    };
    let with = |to: &str| read(text.replace("dolfin.h5:/Mesh/mesh/geometry", to));
    refused(
        with("gone.h5:/a"),
        &["dolfin.xdmf:10: its numbers are in gone.h5, which is not there"],
    );
    refused(with("dolfin.xdmf:/a"), &["it names itself"]);
    refused(with("dolfin.h5:/Mesh/b"), &["dolfin.xdmf:10: dolfin.h5 has no dataset /Mesh/b"]);
    refused(with("dolfin.h5:/Mesh/mesh"), &["dolfin.h5 has no dataset /Mesh/mesh"]);
    refused(with("dolfin.h5:/Mesh/mesh/topology"), &["announce 60 numbers, dolfin.h5 has 120"]);
    refused(with("dolfin.h5"), &["names no dataset"]);
    refused(read(text.replace("30 2", "30 3")), &["announce 90 numbers, dolfin.h5 has 60"]);
    refused(read(text.replace("40 3\" NumberType", "4 3\" NumberType")), &["announce 12 numbers"]);
    refused(
        read(text.replace("Format=\"HDF\"", "Format=\"TIFF\"")),
        &["numbers of the format TIFF"],
    );
    fs::write(folder.path("text.h5"), "no HDF5").unwrap();
    refused(with("text.h5:/a"), &["text.h5 is no HDF5"]);
    // The same file by another name is one of the files still.
    let file = with("./dolfin.h5:/Mesh/mesh/geometry").unwrap();
    assert_eq!(file.paths().count(), 2);
    file.write(&folder.path("out.xdmf"), &file.mesh().points).unwrap();
    assert!(folder.text("out.xdmf").contains("\">out.h5:/Mesh/mesh/geometry<"));
    folder.read("out.xdmf");
}

/// Where a file cannot take its place, all are as they were.
#[test]
fn all_files_are_replaced_or_none() {
    let sample = &SAMPLES[0];
    let folder = sample.folder();
    let file = folder.read(sample.name);
    let to = moved(&file, 1.0);
    file.write(&folder.path("out.xdmf"), &file.mesh().points).unwrap();
    let old = ["out.xdmf", "out.h5"].map(|name| fs::read(folder.path(name)).unwrap());
    let count = folder.count();
    // The text stays as it is, and then it does not.
    for text in [old[0].clone(), b"another".to_vec()] {
        fs::write(folder.path("out.xdmf"), &text).unwrap();
        fs::remove_file(folder.path("out.h5")).unwrap();
        fs::create_dir(folder.path("out.h5")).unwrap();
        let error = file.write(&folder.path("out.xdmf"), &to).unwrap_err().to_string();
        assert!(error.contains("out.h5"), "{error}");
        assert!(fs::read(folder.path("out.xdmf")).unwrap() == text);
        fs::remove_dir(folder.path("out.h5")).unwrap();
        fs::write(folder.path("out.h5"), &old[1]).unwrap();
        assert_eq!(folder.count(), count);
    }
    file.write(&folder.path("out.xdmf"), &to).unwrap();
    assert_eq!(bits(&folder.read("out.xdmf").mesh().points), bits(&to));
    assert_eq!(folder.count(), count);
}

/// What would replace a file that another part of the mesh was read from is refused before anything is written.
#[test]
fn a_file_of_the_mesh_is_not_replaced_by_another() {
    let folder = SAMPLES[4].folder();
    fs::write(folder.path("in.xdmf"), folder.text("raw.xdmf")).unwrap();
    let file = folder.read("in.xdmf");
    let names = file.destinations(&folder.path("out.xdmf")).unwrap();
    assert_eq!(names[2], folder.path("out_raw.bin"));
    let text = folder.text("raw.xdmf").replace("raw-cells.bin", "x.bin");
    fs::rename(folder.path("raw-cells.bin"), folder.path("x.bin")).unwrap();
    fs::write(folder.path("raw.xdmf"), text).unwrap();
    let file = folder.read("raw.xdmf");
    let error = file.write(&folder.path("x.xdmf"), &file.mesh().points).unwrap_err().to_string();
    assert!(error.contains("x.bin would be written, which the mesh was read from"), "{error}");
    assert!(!folder.path("x.xdmf").exists());
    let error = file.write(&folder.path("y.xdmf.gz"), &file.mesh().points).unwrap_err();
    assert!(error.to_string().contains("not written compressed"), "{error}");
    let mut out = Vec::new();
    let error = file.write_to(Path::new("-"), &mut out, &file.mesh().points).unwrap_err();
    assert!(error.to_string().contains("of several files"), "{error}");
}

/// Regions, groups and data of the files of meshio and of the newest layouts.
#[test]
fn attributes_in_files_beside_it_are_read() {
    let file = MeshFile::read(&made("meshio.xdmf")).unwrap();
    assert_eq!(file.data_names(), ["T"]);
    let groups = file.groups().unwrap();
    assert_eq!(groups.find("region:surface:2").unwrap().triangles().len(), 10);
    assert_eq!(groups.find("9").unwrap().vertices(), [7, 8]);
    assert_eq!(file.point_array("n").unwrap()[7], 7.0);
    assert!(file.mesh().fixed.contains(&7));
    let file = MeshFile::read(&made("latest.xdmf")).unwrap();
    assert_eq!(file.data_names(), ["T", "u", "c", "w"]);
    assert_eq!(file.regions().unwrap()[29..31], [0, 1]);
    assert_eq!(file.vertex_place(14).path, made("latest.h5"));
    let place = MeshFile::read(&made("dolfin.xdmf")).unwrap().triangle_place(3);
    assert_eq!((place.path, place.label), (made("dolfin.h5"), 3));
    for name in ["meshio.xdmf", "latest.xdmf"] {
        let file = MeshFile::read(&made(name)).unwrap();
        for (_, format) in Conversion::targets() {
            assert!(Conversion::new(&file, format).unwrap().is_some());
        }
    }
}
