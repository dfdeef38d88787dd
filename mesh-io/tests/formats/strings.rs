//! Arrays of strings, bits and 64-bit integers, which other programs write beside a mesh.

use super::Folder;
use mesh_io::MeshFile;
use std::fs;

const POINTS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.25, 0.0], [0.0, 1.0, 0.0]];
const NAMES: [&str; 4] = ["a & b", "", "POINTS", "x"];

/// Returns a string of a binary legacy VTK file, after its length in `bytes` bytes.
fn string(text: &str, bytes: usize) -> Vec<u8> {
    let mut length = (text.len() as u64).to_be_bytes()[8 - bytes..].to_vec();
    length[0] |= match bytes {
        1 => 0xC0,
        2 => 0x80,
        4 => 0x40,
        _ => 0,
    };
    length.extend_from_slice(text.as_bytes());
    length
}

/// Returns a legacy VTK file with strings and bits among its arrays, and materials after these arrays.
fn vtk(binary: bool) -> Vec<u8> {
    let mut file = Vec::new();
    let long = "long ".repeat(30);
    let text = |file: &mut Vec<u8>, text: &str| file.extend_from_slice(text.as_bytes());
    let numbers = |file: &mut Vec<u8>, numbers: &[i32]| match binary {
        true => numbers.iter().for_each(|n| file.extend_from_slice(&n.to_be_bytes())),
        false => numbers.iter().for_each(|n| file.extend_from_slice(format!("{n} ").as_bytes())),
    };
    text(&mut file, "# vtk DataFile Version 4.2\nt\n");
    text(&mut file, if binary { "BINARY\n" } else { "ASCII\n" });
    text(&mut file, "DATASET UNSTRUCTURED_GRID\nFIELD FieldData 2\ntitle 1 2 string\n");
    match binary {
        true => {
            file.extend([string("a & b", 8), string(&long, 2)].concat());
            text(&mut file, "\nmask 1 11 bit\n\x03\x40\n");
        }
        false => {
            text(&mut file, &format!("a%20&%20b\n{}\n", long.replace(' ', "%20")));
            text(&mut file, "mask 1 11 bit\n0 0 0 0 0 0 1 1 0 1 0\n");
        }
    }
    text(&mut file, "POINTS 4 double\n");
    for x in POINTS.iter().flatten() {
        match binary {
            true => file.extend_from_slice(&x.to_be_bytes()),
            false => text(&mut file, &format!("{x} ")),
        }
    }
    text(&mut file, "\nCELLS 2 8\n");
    numbers(&mut file, &[3, 0, 1, 2, 3, 0, 2, 3]);
    text(&mut file, "\nCELL_TYPES 2\n");
    numbers(&mut file, &[5, 5]);
    text(&mut file, "\nPOINT_DATA 4\nFIELD FieldData 3\nnames 1 4 string\n");
    for name in NAMES {
        match binary {
            true => file.extend(string(name, 1 << (name.len() % 4))),
            false => text(&mut file, &format!("{}\n", name.replace(' ', "%20"))),
        }
    }
    text(&mut file, "\nids 1 4 vtktypeuint64\n");
    for id in [1_u64, 2, 3, u64::MAX] {
        match binary {
            true => file.extend_from_slice(&id.to_be_bytes()),
            false => text(&mut file, &format!("{id} ")),
        }
    }
    text(&mut file, "\nflags 1 4 bit\n");
    text(&mut file, if binary { "\x50\n" } else { "0 1 0 1 \n" });
    text(&mut file, "CELL_DATA 2\nSCALARS MaterialIDs int 1\nLOOKUP_TABLE default\n");
    numbers(&mut file, &[7, 8]);
    text(&mut file, "\n");
    file
}

#[test]
fn strings_and_bits_of_vtk_are_passed_over() {
    for binary in [false, true] {
        let folder = Folder::new(&[]);
        let bytes = vtk(binary);
        fs::write(folder.path("a.vtk"), &bytes).unwrap();
        let file = folder.read("a.vtk");
        assert_eq!(file.points(), POINTS.map(|[x, y, _]| [x, y]));
        assert_eq!(file.regions(), Some(&[0, 1][..]), "binary: {binary}");
        file.write(&folder.path("out.vtk"), file.points()).unwrap();
        assert!(fs::read(folder.path("out.vtk")).unwrap() == bytes);
        let mut moved = file.points().to_vec();
        moved[2] = [1.5, 1.0];
        file.write(&folder.path("out.vtk"), &moved).unwrap();
        let out = folder.read("out.vtk");
        assert_eq!((out.points(), file.difference(&out)), (&moved[..], None));
        // The file is cut off at each byte of its strings.
        let end = memchr::memmem::find(&bytes, b"POINTS 4").unwrap();
        for cut in 0..end {
            assert!(
                MeshFile::from_bytes("a.vtk".as_ref(), bytes[..cut].to_vec()).is_err(),
                "{cut}"
            );
        }
    }
}

/// meshio writes an array of 64-bit integers as a property of a type that PLY does not define.
#[test]
fn ply_may_have_whole_numbers_of_64_bits() {
    let head = |form: &str| {
        format!(
            "ply\nformat {form} 1.0\nelement vertex 4\nproperty double x\nproperty double y\n\
             property int64 a\nproperty uint64 b\nelement face 2\nproperty list uint8 int64 vertex_indices\nend_header\n"
        )
    };
    let mut text = head("ascii").into_bytes();
    let mut binary = head("binary_big_endian").into_bytes();
    for [x, y, _] in POINTS {
        text.extend(format!("{x} {y} -9007199254740993 18446744073709551615\n").into_bytes());
        binary.extend([x.to_be_bytes(), y.to_be_bytes()].concat());
        binary
            .extend([(-9_007_199_254_740_993_i64).to_be_bytes(), u64::MAX.to_be_bytes()].concat());
    }
    for corners in [[0_i64, 1, 2], [0, 2, 3]] {
        let [a, b, c] = corners;
        text.extend(format!("3 {a} {b} {c}\n").into_bytes());
        binary.push(3);
        binary.extend(corners.map(i64::to_be_bytes).concat());
    }
    for bytes in [text, binary] {
        let folder = Folder::new(&[]);
        fs::write(folder.path("a.ply"), &bytes).unwrap();
        let file = folder.read("a.ply");
        assert_eq!(file.triangles(), [[0, 1, 2], [0, 2, 3]]);
        file.write(&folder.path("b.ply"), file.points()).unwrap();
        assert!(fs::read(folder.path("b.ply")).unwrap() == bytes);
        assert!(file.data_names().is_empty(), "whole numbers are not interpolated");
    }
}
