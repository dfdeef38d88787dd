//! Random damage to files, and its test with the samples of Triangle and gmsh.

use super::binary::{msh22, msh41};
use super::facts::mesh_of;
use super::{ELE, GMSH22, GMSH41, NODE, POLY, triangle};
use mesh_io::{Location, MeshFile, SourceLocation};
use std::fs;

/// Returns a generator of random numbers below its argument, by SplitMix64.
pub(crate) fn random(seed: u64) -> impl FnMut(usize) -> usize {
    let mut state = seed;
    move |below: usize| {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % below as u64) as usize
    }
}

/// Returns the number of damaged files per format: `usual`, or `GPU_SMOOTH_DAMAGES` for a longer test.
pub(crate) fn rounds(usual: usize) -> usize {
    let wanted = std::env::var("GPU_SMOOTH_DAMAGES").ok();
    wanted.map_or(usual, |wanted| wanted.parse().expect("GPU_SMOOTH_DAMAGES is a number"))
}

/// Returns the content with up to three random pieces cut, replaced or doubled.
pub(crate) fn damaged(content: &[u8], mut random: impl FnMut(usize) -> usize) -> Vec<u8> {
    let bytes = b"0123456789 \n\r\t#$.-+eEdDnaifE\"\0\xFF";
    let mut damaged = content.to_vec();
    for _ in 0..=random(3) {
        let at = random(damaged.len());
        match random(5) {
            0 => damaged.truncate(at + 1),
            1 => damaged[at] = bytes[random(bytes.len())],
            2 => damaged.insert(at, bytes[random(bytes.len())]),
            3 => damaged.extend_from_within(at..),
            _ => drop(damaged.drain(at..(at + 1 + random(9)).min(damaged.len() - 1).max(at))),
        }
    }
    damaged
}

/// A file with random bytes cut, replaced or doubled gives an error or a mesh with all locations, never a panic.
#[test]
fn damaged_files_never_panic() {
    let mut random = random(7);
    let folder = triangle();
    folder.put("a.msh", "");
    let binary = [msh22(false), msh22(true), msh41(false), msh41(true)];
    let samples: [(&str, &[u8]); 9] = [
        ("la.1.node", NODE.as_bytes()),
        ("la.1.ele", ELE.as_bytes()),
        ("la.1.poly", POLY.as_bytes()),
        ("a.msh", GMSH22.as_bytes()),
        ("a.msh", GMSH41.as_bytes()),
        ("a.msh", &binary[0]),
        ("a.msh", &binary[1]),
        ("a.msh", &binary[2]),
        ("a.msh", &binary[3]),
    ];
    let inside = |place: SourceLocation| match place.location {
        Location::Line(line) => line > 1,
        Location::Byte(at) => at > 20,
        Location::Unknown => false,
    };
    let mut read = 0;
    let rounds = samples.len() * rounds(800);
    for round in 0..rounds {
        let (name, content) = samples[round % samples.len()];
        let damaged = damaged(content, &mut random);
        folder.put(name, &damaged);
        let given = if name == "la.1.poly" { "la.1" } else { name };
        if let Ok(file) = MeshFile::read(&folder.path(given)) {
            read += 1;
            let mesh = mesh_of(&file);
            for vertex in 0..mesh.points.len() {
                assert!(inside(file.vertex_location(vertex as u32)));
            }
            for triangle in 0..mesh.triangles.len() {
                assert!(inside(file.triangle_location(triangle)));
            }
            let vertices = mesh.triangles.iter().flatten().chain(&mesh.fixed);
            assert!(vertices.into_iter().all(|&vertex| (vertex as usize) < mesh.points.len()));
            if round % 63 == 0 {
                file.write(&folder.path("out"), &mesh.points).unwrap();
                let out = if name == "a.msh" { "out" } else { &name.replace("la.1", "out") };
                assert_eq!(fs::read(folder.path(out)).unwrap(), damaged);
            }
        }
        folder.put(name, content);
    }
    let few = rounds / 10;
    assert!((few..rounds - few).contains(&read), "{read} of {rounds} damaged files were read");
}
