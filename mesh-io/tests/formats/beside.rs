//! Meshes with numbers in companion files: an XDMF with HDF5 or raw files.

use super::facts::fixed;
use super::hdf5::{SAMPLES, bits, made, moved, refused};
use mesh_io::{Conversion, MeshFile, ReadError, ReadOptions};
use std::fs;
use std::path::{Path, PathBuf};

/// If a mesh is written under another name, its companion files are renamed accordingly, in the XDMF too.
#[test]
fn files_beside_a_mesh_are_renamed_with_it() {
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
            assert_eq!(bits(again.points()), bits(&to));
            let own: Vec<PathBuf> = again.paths().map(Path::to_path_buf).collect();
            assert_eq!(own, destinations);
            assert_eq!(file.difference(&again), None);
            assert_eq!(again.difference(&file), None);
            // The input files are unchanged.
            for name in [sample.name].iter().chain(sample.beside) {
                assert!(fs::read(folder.path(name)).unwrap() == fs::read(made(name)).unwrap());
            }
            // Written back under the old name with the old points, the XDMF has its original text.
            fs::create_dir_all(folder.path("back")).unwrap();
            let back = folder.path("back").join(sample.name);
            again.write(&back, file.points()).unwrap();
            assert!(fs::read(&back).unwrap() == fs::read(made(sample.name)).unwrap());
        }
    }
}

#[test]
fn missing_files_beside_a_mesh_are_errors() {
    let sample = &SAMPLES[0];
    let folder = sample.folder();
    let path = folder.path(sample.name);
    let text = fs::read_to_string(&path).unwrap();
    let bytes = text.clone().into_bytes();
    refused(MeshFile::from_bytes(&path, bytes), &["in the file dolfin.h5", "Name the file"]);
    let read = |text: String| {
        fs::write(&path, text).unwrap();
        MeshFile::read(&path)
    };
    let with = |to: &str| read(text.replace("dolfin.h5:/Mesh/mesh/geometry", to));
    refused(
        with("gone.h5:/a"),
        &["dolfin.xdmf:10: its numbers are in gone.h5, which does not exist"],
    );
    refused(with("dolfin.xdmf:/a"), &["it names itself"]);
    refused(with("dolfin.h5:/Mesh/b"), &["dolfin.xdmf:10: dolfin.h5 has no dataset /Mesh/b"]);
    refused(with("dolfin.h5:/Mesh/mesh"), &["dolfin.h5 has no dataset /Mesh/mesh"]);
    refused(with("dolfin.h5:/Mesh/mesh/topology"), &["announce 60 numbers, but dolfin.h5 has 120"]);
    refused(with("dolfin.h5"), &["names no dataset"]);
    refused(read(text.replace("30 2", "30 3")), &["announce 90 numbers, but dolfin.h5 has 60"]);
    refused(read(text.replace("40 3\" NumberType", "4 3\" NumberType")), &["announce 12 numbers"]);
    refused(
        read(text.replace("Format=\"HDF\"", "Format=\"TIFF\"")),
        &["numbers of the format TIFF"],
    );
    fs::write(folder.path("text.h5"), "not HDF5").unwrap();
    refused(with("text.h5:/a"), &["text.h5 is not HDF5"]);
    // A companion that the text names by two spellings counts as one file.
    let file = with("./dolfin.h5:/Mesh/mesh/geometry").unwrap();
    assert_eq!(file.paths().count(), 2);
    file.write(&folder.path("out.xdmf"), file.points()).unwrap();
    assert!(folder.text("out.xdmf").contains("\">out.h5:/Mesh/mesh/geometry<"));
    folder.read("out.xdmf");
}

/// If one file cannot be replaced, all files keep their old content.
#[test]
fn all_files_are_replaced_or_none() {
    let sample = &SAMPLES[0];
    let folder = sample.folder();
    let file = folder.read(sample.name);
    let to = moved(&file, 1.0);
    file.write(&folder.path("out.xdmf"), file.points()).unwrap();
    let old = ["out.xdmf", "out.h5"].map(|name| fs::read(folder.path(name)).unwrap());
    let count = folder.count();
    // The XDMF at the destination first has the text that is written, then another text.
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
    assert_eq!(bits(folder.read("out.xdmf").points()), bits(&to));
    assert_eq!(folder.count(), count);
}

/// A write that would replace another file of the mesh is refused before any file is written.
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
    let error = file.write(&folder.path("x.xdmf"), file.points()).unwrap_err().to_string();
    assert!(error.contains("x.bin, from which the mesh was read, would be overwritten"), "{error}");
    assert!(!folder.path("x.xdmf").exists());
    let error = file.write(&folder.path("y.xdmf.gz"), file.points()).unwrap_err();
    assert!(error.to_string().contains("not written compressed"), "{error}");
    let mut out = Vec::new();
    let error = file.write_to(Path::new("-"), &mut out, file.points()).unwrap_err();
    assert!(error.to_string().contains("of several files"), "{error}");
}

/// Regions, groups and data in companion files of meshio, and in files of the newest HDF5 layouts.
#[test]
fn attributes_in_files_beside_a_mesh_are_read() {
    let file = MeshFile::read(&made("meshio.xdmf")).unwrap();
    assert_eq!(file.data_names(), ["T"]);
    let groups = file.groups().unwrap();
    assert_eq!(groups.find("region:surface:2").unwrap().triangles().len(), 10);
    assert_eq!(groups.find("9").unwrap().vertices(), [7, 8]);
    assert_eq!(file.point_array("n").unwrap()[7], 7.0);
    assert!(fixed(&file).contains(&7));
    let file = MeshFile::read(&made("latest.xdmf")).unwrap();
    assert_eq!(file.data_names(), ["T", "u", "c", "w"]);
    assert_eq!(file.regions().unwrap()[29..31], [0, 1]);
    assert_eq!(file.vertex_location(14).path, made("latest.h5"));
    let place = MeshFile::read(&made("dolfin.xdmf")).unwrap().triangle_location(3);
    assert_eq!((place.path, place.id), (made("dolfin.h5"), 3));
    for name in ["meshio.xdmf", "latest.xdmf"] {
        let file = MeshFile::read(&made(name)).unwrap();
        for (_, format) in Conversion::targets() {
            assert!(Conversion::new(&file, format).unwrap().is_some());
        }
    }
}

#[test]
fn files_outside_of_the_directory_of_a_mesh_are_errors_without_leave() {
    let sample = &SAMPLES[0];
    let folder = sample.folder();
    fs::create_dir_all(folder.path("sub/deep")).unwrap();
    let text = folder.text(sample.name);
    let write = |at: &str, file: &str| {
        fs::write(folder.path(at), text.replace("dolfin.h5", file)).unwrap();
        folder.path(at)
    };
    let path = write("sub/in.xdmf", "../dolfin.h5");
    match MeshFile::read(&path) {
        Err(ReadError::Outside { names, target, .. }) => {
            assert_eq!(names, "../dolfin.h5");
            assert_eq!(target, fs::canonicalize(folder.path("dolfin.h5")).unwrap());
        }
        other => panic!("{other:?}"),
    }
    refused(MeshFile::read(&path), &["sub/in.xdmf:7: it names", "ReadOptions::allow_outside"]);
    ReadOptions::new().allow_outside(true).read(&path).unwrap();
    // A subdirectory is inside, and so is a path that leaves the directory and comes back.
    fs::copy(folder.path("dolfin.h5"), folder.path("sub/deep/v.h5")).unwrap();
    MeshFile::read(&write("sub/below.xdmf", "deep/v.h5")).unwrap();
    MeshFile::read(&write("sub/back.xdmf", "../sub/deep/v.h5")).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        // A mesh behind a symbolic link may also name files beside the link's target.
        write("sub/y.xdmf", "y.h5");
        fs::copy(folder.path("dolfin.h5"), folder.path("sub/y.h5")).unwrap();
        for name in ["y.xdmf", "y.h5"] {
            symlink(format!("../{name}"), folder.path(&format!("sub/deep/{name}"))).unwrap();
        }
        MeshFile::read(&folder.path("sub/deep/y.xdmf")).unwrap();
        symlink("v.h5", folder.path("sub/deep/w.h5")).unwrap();
        MeshFile::read(&write("sub/deep/in.xdmf", "w.h5")).unwrap();
        symlink("../dolfin.h5", folder.path("sub/x.h5")).unwrap();
        refused(MeshFile::read(&write("sub/x.xdmf", "x.h5")), &["names x.h5, which is "]);
    }
}

#[test]
fn a_solution_beside_a_medit_mesh_is_told_and_a_loss_of_conversions() {
    let mesh = "MeshVersionFormatted 2\nDimension 2\nVertices 3\n0 0 0\n1 0 0\n0 1 0\nTriangles 1\n1 2 3 0\nEnd\n";
    let folder = super::Folder::new(&[("in.mesh", mesh), ("alone.mesh", mesh), ("in.sol", "any")]);
    let remark = "in.sol beside the mesh stays as it is, although its numbers belong to the vertices of this mesh";
    let file = folder.read("in.mesh");
    assert_eq!(super::facts::remarks(&file), [remark]);
    let losses = |file: &MeshFile| {
        Conversion::new(file, mesh_io::Format::Vtk).unwrap().unwrap().losses().to_vec()
    };
    assert_eq!(losses(&file), ["the solution in in.sol beside the mesh"]);
    for (name, solution) in [("b.mesh.gz", "b.solb"), ("C.MESH", "C.SOL"), ("D.MESH.GZ", "D.sol")] {
        fs::write(folder.path(name), mesh).unwrap();
        fs::write(folder.path(solution), "any").unwrap();
        let told = super::facts::remarks(&folder.read(name));
        assert_eq!(told, [remark.replace("in.sol", solution)], "{name}");
    }
    let alone = folder.read("alone.mesh");
    assert!(super::facts::remarks(&alone).is_empty() && losses(&alone).is_empty());
}

#[test]
fn texture_coordinates_are_told() {
    let obj = "v 0 0\nv 1 0\nv 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    let folder =
        super::Folder::new(&[("in.obj", obj), ("plain.obj", "v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n")]);
    let remark = "texture coordinates (vt) stay as they are where vertices move";
    assert_eq!(super::facts::remarks(&folder.read("in.obj")), [remark]);
    assert!(super::facts::remarks(&folder.read("plain.obj")).is_empty());
}
