//! Processes that are killed at random moments while they write.
#![cfg(unix)]

use super::{Folder, disturbed, finish};
use mesh_io::MeshFile;
use std::fs;
use std::io::Write;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};
use support::SplitMix64;

const PARTS: [&str; 3] = ["out.node", "out.ele", "out.poly"];

/// Returns the contents of the output files; `None` for missing files.
fn parts(folder: &Folder) -> [Option<Vec<u8>>; 3] {
    PARTS.map(|name| fs::read(folder.path(name)).ok())
}

fn start(folder: &Folder, input: &str) -> Child {
    let mut command = folder.command();
    command.args([input, "out.node", "--engine", "cpu", "--max-sweeps", "2", "-q"]);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Kills a process that writes a mesh of three files, both over an earlier state of the mesh and into an empty
/// folder. The environment variable KILLS is the number of kills.
#[test]
fn a_killed_process_leaves_all_files_old_or_all_new() {
    let kills: usize = std::env::var("KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(20);
    let [node, ele] = support::triangle_text(&disturbed(), "made for a test");
    // A .poly without segments and holes.
    let poly = "0 2 0 0\n0 0\n0\n";
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele), ("in.poly", poly)]);
    // The first run provides the expected output and its duration. The replaced mesh has equal triangles.
    let began = Instant::now();
    assert!(start(&folder, "in").wait().unwrap().success());
    let whole = began.elapsed();
    let new = parts(&folder);
    assert!(new.iter().all(Option::is_some));
    let old = ["in.node", "in.ele", "in.poly"].map(|name| fs::read(folder.path(name)).ok());
    assert_ne!(old[0], new[0]);
    let mut random = SplitMix64::new(5);
    let (mut left_old, mut left_new, mut left_none, mut temporaries) = (0, 0, 0, 0);
    for kill in 0..kills {
        let replaces = kill % 2 == 0;
        for (name, content) in PARTS.iter().zip(&old) {
            let path = folder.path(name);
            match content.as_ref().filter(|_| replaces) {
                Some(content) => fs::write(path, content).unwrap(),
                None => drop(fs::remove_file(path)),
            }
        }
        let mut run = start(&folder, "in");
        // With few sweeps, a run spends most of its time on writing or shortly before.
        let after: Duration = whole.mul_f64(random.range(0.3, 1.1));
        std::thread::sleep(after);
        let _ = run.kill();
        run.wait().unwrap();
        let found = parts(&folder);
        if replaces {
            // The two meshes differ only in the .node, so each moment must leave the old or the new mesh.
            assert!(found == old || found == new, "kill {kill} left a mixture");
            *(if found == new { &mut left_new } else { &mut left_old }) += 1;
        } else if found == new {
            left_new += 1;
        } else {
            // Without its .node, the mesh does not exist, and the other files must be complete.
            assert!(found[0].is_none(), "kill {kill} left a part of a mesh");
            assert!(MeshFile::read(&folder.path("out.node")).is_err());
            for (found, new) in found.iter().zip(&new) {
                assert!(found.is_none() || found == new);
            }
            left_none += 1;
        }
        // A temporary file may remain. Its name is unique, and the next run ignores the file.
        for entry in fs::read_dir(&folder.0).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            if name.ends_with(".tmp") {
                assert!(name.starts_with(".mesh-io-"));
                fs::remove_file(folder.path(&name)).unwrap();
                temporaries += 1;
            }
        }
    }
    let _ = writeln!(
        std::io::stdout(),
        "{kills} kills: {left_old} left the old mesh, {left_new} the new one, {left_none} none; \
         {temporaries} temporary files stayed"
    );
    assert_eq!(left_old + left_new + left_none, kills);
}

/// A new mesh replaces one with other triangles. A kill must leave the old mesh, the new mesh, or no readable mesh.
#[test]
fn a_killed_process_leaves_no_mixture_of_two_meshes() {
    let kills: usize = std::env::var("KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let [node, ele] = support::triangle_text(&disturbed(), "made for a test");
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    let began = Instant::now();
    assert!(start(&folder, "in").wait().unwrap().success());
    let whole = began.elapsed();
    let new = ["out.node", "out.ele"].map(|name| fs::read(folder.path(name)).ok());
    // Equal vertices with other triangles, so that a mixture of both meshes could be read.
    let mut other = disturbed();
    other.triangles.rotate_left(7);
    let old = support::triangle_text(&other, "another").map(|text| Some(text.into_bytes()));
    let (mut left_old, mut left_new, mut left_none) = (0, 0, 0);
    let mut random = SplitMix64::new(6);
    for kill in 0..kills {
        for (name, content) in PARTS.iter().zip(&old) {
            fs::write(folder.path(name), content.as_ref().unwrap()).unwrap();
        }
        let mut run = start(&folder, "in");
        std::thread::sleep(whole.mul_f64(random.range(0.5, 1.1)));
        let _ = run.kill();
        run.wait().unwrap();
        let found = ["out.node", "out.ele"].map(|name| fs::read(folder.path(name)).ok());
        if found == old {
            left_old += 1;
        } else if found == new {
            left_new += 1;
        } else {
            assert!(found[0].is_none(), "kill {kill} left a mixture");
            left_none += 1;
            // The old files still exist under temporary names.
            let entries =
                fs::read_dir(&folder.0).unwrap().map(|entry| fs::read(entry.unwrap().path()).ok());
            let there: Vec<_> = entries.collect();
            assert!(
                old.iter().all(|content| there.contains(content)),
                "kill {kill} lost the old mesh"
            );
        }
        for (path, _) in folder.content() {
            if path.extension().is_some_and(|ending| ending == "tmp") {
                fs::remove_file(path).unwrap();
            }
        }
    }
    let _ = writeln!(
        std::io::stdout(),
        "{kills} kills: {left_old} left the old mesh, {left_new} the new one, {left_none} neither, with the old files kept"
    );
    assert_eq!(left_old + left_new + left_none, kills);
}

/// A limit on file sizes simulates a full disk. `tests/full-disk` tests a real full disk, which requires root.
#[test]
fn a_mesh_that_does_not_fit_on_the_disk_leaves_the_old_one() {
    let [node, ele] = support::triangle_text(&disturbed(), "made for a test");
    let old = [("out.node", "old node\n"), ("out.ele", "old ele\n")];
    let folder = Folder::new(&[&[("in.node", &*node), ("in.ele", &*ele)][..], &old].concat());
    let kept = folder.content();
    // The limit is one or two kilobytes: a block has 512 or 1024 bytes, depending on the shell.
    let line = "ulimit -f 2; exec \"$0\" in out.node --engine cpu --force";
    let mut command = std::process::Command::new("sh");
    command.current_dir(&folder.0).args(["-c", line, env!("CARGO_BIN_EXE_gpu-smooth")]);
    finish(&mut command).refused(&["out.node: ", "Let files be larger (ulimit -f)"]);
    assert!(folder.content() == kept);
}
