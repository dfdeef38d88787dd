//! Meshes in HDF5 files of several programs, made by `h5/make.py`.

use super::Folder;
use super::damage::{self, damaged, random};
use super::facts::{between_regions, fixed, mesh_of};
use mesh_io::{Conversion, Format, MeshFile, PointField, Remark};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use support::check;

/// A mesh file with its companion files.
pub(crate) struct Sample {
    pub(crate) name: &'static str,
    pub(crate) beside: &'static [&'static str],
    /// Whether all numbers are uncompressed, so that a rewrite keeps the length of the file.
    is_plain: bool,
}

pub(crate) const SAMPLES: [Sample; 11] = [
    Sample { name: "dolfin.xdmf", beside: &["dolfin.h5"], is_plain: true },
    Sample { name: "meshio.xdmf", beside: &["meshio.h5"], is_plain: false },
    Sample { name: "latest.xdmf", beside: &["latest.h5"], is_plain: false },
    Sample { name: "chunked.xdmf", beside: &["chunked.h5"], is_plain: false },
    Sample { name: "raw.xdmf", beside: &["raw-cells.bin", "raw.bin"], is_plain: true },
    Sample { name: "gmsh.cgns", beside: &[], is_plain: true },
    Sample { name: "gmsh.med", beside: &[], is_plain: true },
    Sample { name: "netcdf4.exo", beside: &[], is_plain: true },
    Sample { name: "zlib.exo", beside: &[], is_plain: false },
    Sample { name: "ugrid.nc", beside: &[], is_plain: false },
    Sample { name: "h5netcdf.nc", beside: &[], is_plain: true },
];

pub(crate) fn made(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/h5").join(name)
}

impl Sample {
    /// Returns a folder with copies of the files.
    pub(crate) fn folder(&self) -> Folder {
        let folder = Folder::new(&[]);
        for name in [self.name].iter().chain(self.beside) {
            fs::copy(made(name), folder.path(name)).unwrap();
        }
        folder
    }

    /// Returns the current content of all files of a mesh.
    fn bytes(&self, file: &MeshFile) -> Vec<Vec<u8>> {
        file.paths().map(|path| fs::read(path).unwrap()).collect()
    }
}

/// Reads files that may be damaged: each vertex and triangle of a mesh must have a location, and an error must name a
/// file on a single line. Returns the mesh, or `None` for an error.
fn mesh_or_error(folder: &Folder, sample: &Sample) -> Option<MeshFile> {
    match MeshFile::read(&folder.path(sample.name)) {
        Ok(file) => {
            let (vertices, triangles) = (file.points().len(), file.triangles().len());
            let held = fixed(&file);
            let mut named = file.triangles().iter().flatten().chain(&held);
            assert!(named.all(|&v| (v as usize) < vertices));
            assert_eq!(file.vertex_locations(0..vertices as u32).len(), vertices);
            assert_eq!(file.triangle_locations(0..triangles).len(), triangles);
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

pub(crate) fn bits(points: &[[f64; 2]]) -> Vec<[u64; 2]> {
    points.iter().map(|p| p.map(f64::to_bits)).collect()
}

/// Returns the coordinate bits of each triangle's corners, independent of the numbering of vertices and triangles.
fn corners(mesh: &support::Mesh) -> Vec<[[u64; 2]; 3]> {
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

/// Returns the points with free vertices moved to coordinates with many digits, which compress badly.
pub(crate) fn moved(file: &MeshFile, by: f64) -> Vec<[f64; 2]> {
    let mut points = file.points().to_vec();
    let held = check::held(&mesh_of(file));
    for (v, point) in points.iter_mut().enumerate().filter(|(v, _)| !held[*v]) {
        let at = (v as f64 + by).sin() * 0.1;
        *point = point.map(|x| file.precision().rounded(x + at));
    }
    points
}

/// Checks that the read failed with an error that contains all `parts`.
pub(crate) fn refused(read: Result<MeshFile, mesh_io::ReadError>, parts: &[&str]) {
    let error = read.unwrap_err().to_string();
    assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
}

/// Every sample gives the mesh of the file with plain numbers.
#[test]
fn every_sample_holds_the_same_mesh() {
    let plain = MeshFile::read(&made("plain.xdmf")).unwrap();
    for sample in &SAMPLES {
        let file = MeshFile::read(&made(sample.name)).unwrap();
        let rounded: Vec<_> =
            plain.points().iter().map(|p| p.map(|x| file.precision().rounded(x))).collect();
        let given = support::Mesh { points: rounded, ..mesh_of(&plain) };
        assert_eq!(corners(&mesh_of(&file)), corners(&given), "{}", sample.name);
        if !sample.name.starts_with("gmsh") {
            assert_eq!(bits(file.points()), bits(&given.points), "{}", sample.name);
            assert_eq!(file.triangles(), given.triangles, "{}", sample.name);
        }
        assert_eq!(file.paths().count(), 1 + sample.beside.len());
    }
}

#[test]
fn an_hdf5_mesh_that_did_not_move_keeps_its_bytes() {
    for sample in &SAMPLES {
        let folder = sample.folder();
        let file = folder.read(sample.name);
        let before = sample.bytes(&file);
        file.write(&folder.path(sample.name), file.points()).unwrap();
        assert!(sample.bytes(&file) == before, "{}", sample.name);
        let fields = file.point_fields(None).unwrap();
        file.write_with_fields(&folder.path(sample.name), file.points(), &fields).unwrap();
        assert!(sample.bytes(&file) == before, "{}", sample.name);
    }
}

/// Each file is written several times, as chunks that were moved to the end of the file may move again.
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
            assert_eq!(bits(again.points()), bits(&to), "{}", sample.name);
            assert_eq!(again.triangles(), first.triangles());
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

/// The bytes at the end may belong to a dataset that the reader does not need, such as data of elements.
#[test]
fn hdf5_that_lacks_a_byte_is_refused_and_bytes_behind_its_end_are_kept() {
    for sample in SAMPLES.iter().filter(|sample| sample.name != "raw.xdmf") {
        let folder = sample.folder();
        let name = sample.beside.first().unwrap_or(&sample.name);
        let bytes = fs::read(folder.path(name)).unwrap();
        let (length, less) = (bytes.len(), bytes.len() - 1);
        folder.put(name, &bytes[..less]);
        let problem = format!("{name}, byte {less}: the file is cut off: {less} of {length} bytes");
        refused(MeshFile::read(&folder.path(sample.name)), &[&problem, "Copy it again"]);
        let longer = [&bytes[..], b"more"].concat();
        folder.put(name, &longer);
        let file = folder.read(sample.name);
        file.write(&folder.path(sample.name), &moved(&file, 1.0)).unwrap();
        let after = fs::read(folder.path(name)).unwrap();
        assert!(after != longer && after[..8] == bytes[..8]);
        assert!(folder.read(sample.name).points() != file.points());
        if sample.is_plain {
            assert!(after.ends_with(b"more"), "{name}");
        }
    }
}

#[test]
fn hdf5_behind_a_user_block_is_refused() {
    for size in [512, 2048] {
        for sample in SAMPLES.iter().filter(|sample| sample.name != "raw.xdmf") {
            let folder = sample.folder();
            let name = sample.beside.first().unwrap_or(&sample.name);
            let bytes = fs::read(folder.path(name)).unwrap();
            folder.put(name, [&vec![b'u'; size][..], &bytes].concat());
            let parts = [*name, "behind a user block", "h5unjam -i IN -o OUT --delete"];
            refused(MeshFile::read(&folder.path(sample.name)), &parts);
        }
    }
}

/// If a chunk at the end of the file changes its length, the new chunk replaces the old one.
#[test]
fn a_mesh_that_is_written_in_place_many_times_does_not_grow_without_bound() {
    for sample in SAMPLES.iter().filter(|sample| !sample.is_plain) {
        let folder = sample.folder();
        let mut lengths = Vec::new();
        for round in 0..40 {
            let file = folder.read(sample.name);
            let to = match round % 4 {
                // Coordinates with few digits compress better.
                3 => file.points().iter().map(|p| p.map(|x| (x * 64.0).round() / 64.0)).collect(),
                _ => moved(&file, f64::from(round)),
            };
            file.write(&folder.path(sample.name), &to).unwrap();
            let again = folder.read(sample.name);
            assert_eq!(bits(again.points()), bits(&to), "{}", sample.name);
            lengths.push(sample.bytes(&again).iter().map(Vec::len).sum::<usize>());
        }
        let most = |part: &[usize]| part.iter().copied().max().unwrap_or_default();
        let [early, late] = [&lengths[..20], &lengths[20..]].map(most);
        assert!(late <= early + early / 100, "{}: {lengths:?}", sample.name);
    }
}

/// A changed byte outside of coordinates is found at any offset.
#[test]
fn compare_finds_a_changed_byte_outside_coordinates() {
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

/// Data of vertices are written like coordinates, and together with coordinates.
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
        file.write_with_fields(&folder.path(sample.name), &to, &fields).unwrap();
        let again = folder.read(sample.name);
        assert_eq!(bits(again.points()), bits(&to));
        let found = again.point_fields(None).unwrap();
        assert_eq!(found.len(), fields.len());
        for (found, wanted) in found.iter().zip(&fields) {
            let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * (1.0 + b.abs());
            assert!(found.values().iter().zip(wanted.values()).all(close), "{}", sample.name);
        }
        let sides = [&found[..], &fields[..]];
        assert_eq!(again.difference_ignoring(&file, sides), None, "{}", sample.name);
        // Restoring the values gives the original numbers.
        let mut back = found;
        let set =
            |(field, values): (&mut PointField, &Vec<f64>)| field.set(values.clone()).unwrap();
        back.iter_mut().zip(&original).for_each(|pair| _ = set(pair));
        again.write_with_fields(&folder.path(sample.name), file.points(), &back).unwrap();
        let again = folder.read(sample.name);
        assert_eq!(bits(again.points()), bits(file.points()));
        let values: Vec<Vec<f64>> =
            again.point_fields(None).unwrap().iter().map(|f| f.values().to_vec()).collect();
        assert_eq!(values, original, "{}", sample.name);
    }
}

/// Families of MED determine regions, and groups keep their names.
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
    assert!(fixed(&file).contains(&7) && !between_regions(&file).is_empty());
    let text = Conversion::new(&file, Format::Gmsh41).unwrap().unwrap().text().unwrap();
    assert!(text.contains("\"steel\""), "{text}");
}

/// Sections of CGNS determine regions; boundary conditions and families are groups.
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
    assert!(wire.len() == 2 && wire.iter().all(|v| fixed(&file).contains(v)));
    assert!(file.regions().is_some());
    let place = file.triangle_location(0);
    assert_eq!(place.id, 2);
}

/// The file has one section. Its elements have data in real and in whole numbers.
#[test]
fn solutions_of_cgns_in_cells_that_look_like_regions_are_regions() {
    let file = MeshFile::read(&made("cells.cgns")).unwrap();
    let told = Remark::RegionArray { array: "Material".into(), others: vec!["Part".into()] };
    assert!(file.remarks().contains(&told), "{:?}", file.remarks());
    let at = |&v: &u32| file.points()[v as usize][0];
    let is_left = |corners: &[u32; 3]| corners.iter().map(at).sum::<f64>() < 1.5;
    let regions = file.regions().unwrap();
    assert!(file.triangles().iter().zip(regions).all(|(corners, &region)| {
        (is_left(corners) == is_left(&file.triangles()[0])) == (region == regions[0])
    }));
    assert!(!file.interface_vertices().is_empty());
    let by_name = mesh_io::ReadOptions::new().regions(Some("Part".into()));
    assert_eq!(by_name.read(&made("cells.cgns")).unwrap().regions(), Some(regions));
    // The regions are groups, of which a conversion makes physical groups.
    let groups = file.groups().unwrap();
    let mut of_groups: Vec<_> =
        ["Material:1", "Material:2"].map(|name| groups.find(name).unwrap().triangles()).concat();
    of_groups.sort_unstable();
    assert!(of_groups.into_iter().eq(0..file.triangles().len() as u32));
    let text = Conversion::new(&file, Format::Gmsh22).unwrap().unwrap().text().unwrap();
    assert!(!text.contains("\"Material\"") && text.contains("\"Part\""), "{text}");
}

/// gmsh lists the pairs of a periodic boundary twice, once for each side.
#[test]
fn vertices_that_a_zone_of_cgns_joins_to_itself_are_periodic_pairs() {
    let file = MeshFile::read(&made("periodic.cgns")).unwrap();
    let [own] = &file.constraints().periodic[..] else { panic!("{:?}", file.constraints()) };
    assert_eq!(own.pairs.len(), 4);
    assert_eq!(own.motion, Some([[1.0, 0.0, -1.0], [0.0, 1.0, 0.0]]));
    for [a, b] in &own.pairs {
        let [a, b] = [a, b].map(|&vertex| file.points()[vertex as usize]);
        assert!((a[0] - 1.0 - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9);
    }
    assert!(file.constraints().motions.is_empty() && !file.constraints().has_unread_pairs);
}

/// Without lists of vertices, the motion remains, by which a program can find the pairs.
#[test]
fn periodic_connectivities_without_pairs_of_vertices_are_motions() {
    let mut bytes = fs::read(made("periodic.cgns")).unwrap();
    let paired = b"Abutting1to1";
    let starts: Vec<_> = (0..bytes.len()).filter(|&at| bytes[at..].starts_with(paired)).collect();
    assert_eq!(starts.len(), 2);
    for at in starts {
        bytes[at..at + paired.len()].copy_from_slice(b"Abutting    ");
    }
    let folder = Folder::new(&[]);
    fs::write(folder.path("in.cgns"), bytes).unwrap();
    let file = folder.read("in.cgns");
    let left = [[1.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
    let right = [[1.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
    assert_eq!(file.constraints().motions, [left, right]);
    assert!(file.constraints().periodic.is_empty());
}

/// With an extension of HDF5 or none, the content determines the format, and a write in place keeps the file name.
#[test]
fn any_file_of_hdf5_is_known_by_its_content() {
    let all = [
        ("gmsh.med", Format::Med),
        ("gmsh.cgns", Format::Cgns),
        ("zlib.exo", Format::Exodus),
        ("ugrid.nc", Format::Ugrid),
    ];
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
        &["no mesh of Exodus II, UGRID, MED or CGNS", "name the .xdmf"],
    );
}

/// A netCDF-4 file gives the same content as the classic file: groups, names, and data in every time step.
#[test]
fn netcdf_files_of_every_format_hold_the_same_mesh() {
    let classic = MeshFile::read(&made("classic.exo")).unwrap();
    for name in ["netcdf4.exo", "zlib.exo"] {
        let file = MeshFile::read(&made(name)).unwrap();
        assert_eq!(file.format(), Format::Exodus);
        assert_eq!(mesh_of(&file), mesh_of(&classic));
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

/// Files with random bytes cut, replaced or doubled give an error or a mesh with all locations, never a panic.
#[test]
fn damaged_files_of_hdf5_never_panic() {
    let mut random = random(23);
    for sample in &SAMPLES {
        let folder = sample.folder();
        let files: Vec<&str> = [sample.name].iter().chain(sample.beside).copied().collect();
        let whole: Vec<Vec<u8>> = files.iter().map(|name| fs::read(made(name)).unwrap()).collect();
        let ending = |name: &str| name.split('.').next_back().map(str::to_owned);
        let alike = SAMPLES.iter().filter(|other| ending(other.name) == ending(sample.name));
        let rounds = damage::rounds(1000) / alike.count();
        let mut read = 0;
        for round in 0..rounds {
            let part = round % files.len();
            let content = match round % 3 {
                // Every third round may change the length, the others a single byte: files of another length are mostly
                // refused at once.
                0 => damaged(&whole[part], &mut random),
                _ => {
                    let mut content = whole[part].clone();
                    let at = random(content.len());
                    content[at] = [0, 1, 0xFF, content[at] ^ 1][random(4)];
                    content
                }
            };
            folder.put(files[part], &content);
            let start = Instant::now();
            let read_again = mesh_or_error(&folder, sample);
            read += usize::from(read_again.is_some());
            if let Some(file) = read_again.filter(|_| round % 7 == 0) {
                let before = sample.bytes(&file);
                file.write(&folder.path(sample.name), file.points()).unwrap();
                assert!(sample.bytes(&file) == before, "{}", sample.name);
                let to = moved(&file, 1.0);
                file.write(&folder.path(sample.name), &to).unwrap();
                if let Ok(fields) = file.point_fields(None) {
                    assert!(fields.len() < 100);
                }
            }
            assert!(start.elapsed().as_secs() < 10, "{} takes forever", sample.name);
            // Restores the damaged file, and every seventh round all files, which the write may have changed.
            for (name, bytes) in files.iter().zip(&whole) {
                if name == &files[part] || round % 7 == 0 {
                    folder.put(name, bytes);
                }
            }
        }
        let few = rounds / 50;
        assert!((few..rounds - few).contains(&read), "{}: {read} of {rounds}", sample.name);
    }
}
