//! Reads and writes meshes. The name `-` stands for the standard input or output.

use std::io::Read;
use std::path::Path;

use mesh_io::{MeshFile, PointField, ReadError, ReadOptions};

use crate::args::ReadArgs;
use crate::load::LoadedMesh;
use crate::terminal::tell;

/// Reads a mesh from a file, or from the standard input if its name is `-`.
pub(crate) fn read(path: &Path, args: ReadArgs) -> Result<LoadedMesh, String> {
    read_source(path, args).map(LoadedMesh::new)
}

fn read_source(path: &Path, args: ReadArgs) -> Result<MeshFile, String> {
    let options = ReadOptions::new().weld(args.weld);
    if !is_standard(path) {
        return options.read(path).map_err(worded);
    }
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes).map_err(|error| format!("standard input: {error}"))?;
    options.from_bytes(Path::new("standard input"), bytes).map_err(worded)
}

/// Words an error of reading. A remedy names the option of the command line.
fn worded(error: ReadError) -> String {
    error.to_string().replace("ReadOptions::weld", "--weld")
}

/// Whether a name stands for the standard input or output.
pub(crate) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Writes a mesh with these data to a file, or to the standard output if its name is `-`.
pub(crate) fn write(
    file: &LoadedMesh,
    out: &Path,
    points: &[[f64; 2]],
    fields: &[PointField],
) -> Result<(), String> {
    let written = match is_standard(out) {
        true => {
            let name = Path::new("standard output");
            file.write_to_with(name, &mut std::io::stdout(), points, fields)
        }
        false => file.write_with(out, points, fields),
    };
    written.map_err(|error| error.to_string())
}

/// Prints a text to the standard output, or to the standard error if the mesh goes to the standard output.
pub(crate) fn say_beside(out: &Path, text: &str) {
    match is_standard(out) {
        true => tell::aside(text),
        false => tell::say(text),
    }
}
