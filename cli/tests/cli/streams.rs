//! Meshes through standard input and output, and compressed meshes.

use super::{Folder, Run, assert_holds, assert_smoothed, disturbed, small};
use gpu_smooth::Mesh;
use mesh_io::MeshFile;
use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::Stdio;

/// Runs with `input` on standard input. Returns the run, and its output as bytes, because a mesh may be
/// binary.
fn piped(folder: &Folder, args: &str, input: &[u8]) -> (Run, Vec<u8>) {
    let mut command = folder.command();
    command.args(args.split_whitespace()).stdin(Stdio::piped());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    (Run { code: output.status.code(), out: String::new(), err }, output.stdout)
}

fn mesh_of(bytes: Vec<u8>) -> Mesh {
    support::mesh_of(&MeshFile::from_bytes(Path::new("out"), bytes).unwrap())
}

#[test]
fn a_mesh_goes_in_and_out_through_pipes() {
    let folder = Folder::new(&[]);
    let text = support::write_msh22(&disturbed());
    let big = support::write_msh41_binary(&disturbed(), true);
    for bytes in [text.clone().into_bytes(), big] {
        let before = mesh_of(bytes.clone());
        let (run, out) = piped(&folder, "- - --engine cpu", &bytes);
        assert_eq!(run.code, Some(0), "{}", run.err);
        // Standard output receives the mesh, so the summary goes to standard error.
        assert_holds(&run.err, &["99 vertices (63 free", "converged after"]);
        assert_smoothed(&before, &mesh_of(out.clone()));

        let (run, quiet) = piped(&folder, "- - --engine cpu --quiet", &bytes);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        assert!(quiet == out, "the output is the mesh alone");
        let (run, file) = piped(&folder, "- out.msh --engine cpu --quiet", &bytes);
        assert_eq!((run.code, file.as_slice()), (Some(0), &b""[..]));
        assert!(fs::read(folder.path("out.msh")).unwrap() == out);
    }
    let (run, _) = piped(&folder, "- out.node", b"3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n");
    assert_eq!(run.code, Some(3));
    assert_holds(&run.err, &["standard input: the vertices of a Triangle mesh", "several files"]);
    let (run, told) = piped(&folder, "groups - --json", text.as_bytes());
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&String::from_utf8(told).unwrap(), &["\"standard input\"", "gmsh 2.2 ASCII"]);
    assert_eq!(fs::read_dir(folder.path(".")).unwrap().count(), 1);
}

#[test]
fn pipes_without_a_mesh_are_errors() {
    let folder = small();
    let (run, out) = piped(&folder, "- - --engine cpu", b"");
    assert_eq!((run.code, out.len()), (Some(3), 0));
    assert_holds(&run.err, &["error: standard input: the file is empty"]);
    let before = folder.content();
    folder.line("in.node - --engine cpu").refused(&["cannot go to standard output: name OUT"]);
    let (run, _) = piped(&folder, "- - --engine cpu", folder.text("in.node").as_bytes());
    assert_eq!(run.code, Some(3), "{}", run.err);
    assert!(folder.content() == before);
}

#[test]
fn compressed_meshes_are_smoothed() {
    let folder = Folder::new(&[]);
    let text = support::write_msh22(&disturbed());
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(text.as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    fs::write(folder.path("in.msh.gz"), &packed).unwrap();
    fs::write(folder.path("in.msh"), &text).unwrap();
    folder.line("in.msh.gz out.msh.gz --engine cpu").clean();
    folder.line("in.msh plain.msh --engine cpu").clean();
    let mut out = String::new();
    let bytes = fs::read(folder.path("out.msh.gz")).unwrap();
    flate2::read::GzDecoder::new(&bytes[..]).read_to_string(&mut out).unwrap();
    assert!(out == folder.text("plain.msh"));
    folder.line("compare in.msh.gz out.msh.gz").clean();
    folder.line("compare in.msh.gz plain.msh").clean();
    let (run, through) = piped(&folder, "- - --engine cpu", &packed);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(through == bytes, "what came in compressed goes out so");
    folder.line("in.msh out.su2.gz --engine cpu").clean();
    folder.line("quality out.su2.gz").clean();
    let bomb = {
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        packed.write_all(&vec![b' '; 20 << 20]).unwrap();
        packed.finish().unwrap()
    };
    fs::write(folder.path("bomb.msh.gz"), bomb).unwrap();
    folder.line("quality bomb.msh.gz").refused(&["bomb.msh.gz: it unpacks to more than 200 times"]);
}
