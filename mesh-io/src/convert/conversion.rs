//! Writes a mesh in another format than it was read in.

use super::names;
use super::targets::{TARGETS, Target, WriteFunction};
use crate::compress::file::Compression;
use crate::detect;
use crate::disk::atomic;
use crate::disk::atomic::FileWrite;
use crate::error::{ReadError, WriteError};
use crate::export::content::Content;
use crate::export::writer_input::WriterInput;
use crate::format::Format;
use crate::formats::triangle::names::Names;
use crate::formats::write_grids;
use crate::mesh_file::mesh::MeshFile;
use crate::registry::FormatEntry;
use std::io;
use std::path::{Path, PathBuf};

/// A mesh that is to be written in another format.
///
/// ```no_run
/// # use mesh_io::{Conversion, Format, MeshFile};
/// # use std::path::Path;
/// # fn f() -> Result<(), Box<dyn std::error::Error>> {
/// let file = MeshFile::read(Path::new("part.msh"))?;
/// let conversion = Conversion::new(&file, Format::Su2)?.ok_or("SU2 is not written")?;
/// println!("lost: {}", conversion.losses().join("; "));
/// conversion.write(Path::new("part.su2"))?;
/// # Ok(())
/// # }
/// ```
pub struct Conversion {
    content: Content,
    target: &'static Target,
    losses: Vec<String>,
    renamings: Vec<String>,
    creator: String,
}

impl Conversion {
    /// Lists the formats that meshes are converted to, each with a short name. Of formats whose files end the same way,
    /// the usual one comes first.
    pub fn targets() -> impl Iterator<Item = (&'static str, Format)> {
        TARGETS.iter().map(|target| (target.name, target.format))
    }

    /// Returns the format of [`targets`](Self::targets) whose files end as this path does. An ending of compressed
    /// files is ignored. `None` if no format ends so.
    pub fn target_of(path: &Path) -> Option<Format> {
        let ends_so = |target: &&Target| FormatEntry::of(target.format).matches_extension(path);
        TARGETS.iter().find(ends_so).map(|target| target.format)
    }

    /// Makes a mesh ready to be written in another format. The file's content is searched again for elements of all
    /// kinds, groups and data. `None` if meshes are not converted to this format.
    ///
    /// # Errors
    /// [`ReadError`] if the names of groups, or other parts that reading the mesh does not need, are damaged.
    pub fn new(file: &MeshFile, to: Format) -> Result<Option<Conversion>, ReadError> {
        let Some(target) = TARGETS.iter().find(|target| target.format == to) else {
            return Ok(None);
        };
        let mut content = file.content()?;
        write_grids::match_depths(&mut content, file.format(), to);
        let lost = target.capabilities.losses(&content);
        let renamed = names::fit(&target.capabilities, &mut content);
        let creator = "mesh-io".to_owned();
        Ok(Some(Conversion { content, target, losses: lost, renamings: renamed, creator }))
    }

    /// Sets the name of the program that titles of written files give: `written by NAME`. Without this call, the name is
    /// `mesh-io`.
    pub fn set_creator(&mut self, name: &str) {
        name.clone_into(&mut self.creator);
    }

    /// Lists what the format does not hold of the mesh, one line each. Comments, titles and the numbers of elements are
    /// always lost, and not listed.
    pub fn losses(&self) -> &[String] {
        &self.losses
    }

    /// Lists the names that change, as the format cannot hold them, or cannot tell them from others: one line for the
    /// groups of each dimension and for each kind of data. Groups and data that were different stay so.
    pub fn renamings(&self) -> &[String] {
        &self.renamings
    }

    /// Lists the files that [`write`](Self::write) to `path` writes. A Triangle mesh without lines has no `.poly`,
    /// which is listed all the same.
    pub fn destinations(&self, path: &Path) -> Vec<PathBuf> {
        match self.target.write {
            WriteFunction::One(_) | WriteFunction::Binary(_) => vec![path.to_owned()],
            WriteFunction::Several(_) => {
                let Names { node, ele, poly } = Names::of(path);
                vec![node, ele, poly]
            }
        }
    }

    /// Writes the mesh, compressed if `path` ends in `.gz` or `.zst`. Existing files are replaced once all is written.
    ///
    /// # Errors
    /// [`WriteError`] if the system refuses, if the ending is that of another format, or if several files are to be written
    /// under a compressed name.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        let destinations = self.destinations(path);
        let contents = self.contents();
        let packs = Compression::of(path);
        let refused = |problem: String, remedy: &str| {
            let (path, remedy) = (path.to_owned(), remedy.to_owned());
            Err(WriteError::Format { path, problem, remedy })
        };
        let family = FormatEntry::of(self.target.format);
        if let Some(owner) = detect::format_name_of_extension(path)
            && !family.matches_extension(path)
        {
            let problem =
                format!("its ending is that of {owner}, and not of {}", self.target.format);
            return refused(problem, &format!("End the name in {}", family.extensions[0]));
        }
        if packs.is_some() && destinations.len() > 1 {
            let problem = "a Triangle mesh is of several files, which are not written compressed";
            return refused(problem.into(), "End the name in .node");
        }
        if let Some(left) = destinations.get(contents.len()).filter(|left| left.exists()) {
            let problem = format!(
                "{} of another mesh is there, and would be read with this one",
                left.display()
            );
            return refused(problem, "Remove it, or take another name");
        }
        destinations.iter().try_for_each(|path| atomic::ensure_writable(path))?;
        let mut writes: Vec<FileWrite<'_>> = Vec::new();
        for (path, content) in destinations.into_iter().zip(&contents) {
            writes.push((path, Box::new(move |out| put(content, packs, out))));
        }
        atomic::write_all(&writes)
    }

    /// Returns the content of the file if it is text. `None` for binary formats, and for a Triangle mesh, which has
    /// several files.
    pub fn text(&self) -> Option<String> {
        match self.target.write {
            WriteFunction::One(write) => Some(write(&self.input())),
            WriteFunction::Binary(_) | WriteFunction::Several(_) => None,
        }
    }

    /// Returns the content of the file, text or binary. `None` for a Triangle mesh, which has several files.
    pub fn bytes(&self) -> Option<Vec<u8>> {
        match self.target.write {
            WriteFunction::One(_) | WriteFunction::Binary(_) => self.contents().pop(),
            WriteFunction::Several(_) => None,
        }
    }

    fn contents(&self) -> Vec<Vec<u8>> {
        match self.target.write {
            WriteFunction::One(write) => vec![write(&self.input()).into_bytes()],
            WriteFunction::Binary(write) => vec![write(&self.input())],
            WriteFunction::Several(write) => {
                write(&self.input()).into_iter().map(String::into_bytes).collect()
            }
        }
    }

    fn input(&self) -> WriterInput<'_> {
        WriterInput::new(&self.content, self.target.capabilities, &self.creator)
    }
}

fn put(
    bytes: &[u8],
    packs: Option<Compression>,
    out: &mut (dyn io::Write + Send),
) -> io::Result<()> {
    match packs {
        Some(packing) => packing.compress(out, |out| out.write_all(bytes)),
        None => out.write_all(bytes),
    }
}
