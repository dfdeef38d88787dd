//! Conversion of meshes to other formats.

use super::names;
use super::targets::{TARGETS, Target, WriteFunction};
use crate::compress::file::Compression;
use crate::detect;
use crate::disk::atomic;
use crate::disk::atomic::FileWrite;
use crate::error::{ReadError, WriteError};
use crate::export::content::{Content, ContentGroup, DataArray};
use crate::export::writer_input::WriterInput;
use crate::format::Format;
use crate::formats::boundary_codes::{self, BoundaryCodes};
use crate::formats::selafin::conditions;
use crate::formats::triangle::names::Names;
use crate::formats::write_grids;
use crate::mesh_file::mesh::MeshFile;
use crate::precision::Precision;
use crate::registry::FormatEntry;
use crate::visit::field::PointField;
use crate::visit::items::CellKind;
use std::collections::HashMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Loss of ids of vertices, for users.
const LARGE_IDS: &str = "the vertices' own numbers, of which some have more than 32 bits";

/// Encoding of the numbers in a written file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Text. VTK XML has its arrays in base64.
    Text,
    /// Numbers in binary: little byte order, in legacy VTK big.
    Binary,
    /// Numbers in binary, compressed by zlib.
    Compressed,
}

/// Mesh prepared for writing in another format.
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
    omissions: Vec<String>,
    creator: String,
    encoding: Encoding,
}

impl Conversion {
    /// Lists the target formats of conversions, each with a short name. Among formats with a common file ending, the
    /// usual format comes first.
    pub fn targets() -> impl Iterator<Item = (&'static str, Format)> {
        TARGETS.iter().map(|target| (target.name, target.format))
    }

    /// Returns the first format of [`targets`](Self::targets) with the ending of `path`. An ending of compressed files
    /// is ignored. `None` if no target has the ending.
    pub fn target_of(path: &Path) -> Option<Format> {
        let ends_so = |target: &&Target| FormatEntry::of(target.format).matches_extension(path);
        TARGETS.iter().find(ends_so).map(|target| target.format)
    }

    /// Returns the target that meshes of `format` are in, in any encoding. `None` if conversions do not write the format.
    pub fn target_like(format: Format) -> Option<Format> {
        let text = match format {
            Format::Gmsh22Binary => Format::Gmsh22,
            Format::Gmsh41Binary => Format::Gmsh41,
            Format::VtkBinary => Format::Vtk,
            Format::PlyBinary => Format::Ply,
            format => format,
        };
        TARGETS.iter().any(|target| target.format == text).then_some(text)
    }

    /// Returns whether conversions write quadrilaterals in a format. True for a format that conversions do not write.
    fn writes_quadrilaterals(format: Format) -> bool {
        let own = Self::target_like(format);
        let target = TARGETS.iter().find(|target| Some(target.format) == own);
        target.is_none_or(|target| target.capabilities.quadrilaterals)
    }

    /// Prepares a mesh for writing in the format `to`. The bytes of the file are parsed again for elements of all
    /// kinds, groups and data. `None` if `to` is no target of conversions.
    ///
    /// # Errors
    /// [`ReadError`] if names of groups, or other content that [`MeshFile::read`] skips, are damaged.
    pub fn new(file: &MeshFile, to: Format) -> Result<Option<Conversion>, ReadError> {
        Self::moved(file, to, file.points(), &[])
    }

    /// Prepares a mesh as [`new`](Self::new) does, with vertex `i` at `points[i]`, in the units of the file, and with the
    /// values of `fields`, which must come from the file. Fields that conversions leave out, such as centers of faces, are
    /// ignored.
    ///
    /// # Errors
    /// [`ReadError`] for the reasons of [`new`](Self::new).
    ///
    /// # Panics
    /// Panics if there is not one point per vertex.
    pub fn moved(
        file: &MeshFile,
        to: Format,
        points: &[[f64; 2]],
        fields: &[PointField],
    ) -> Result<Option<Conversion>, ReadError> {
        assert_eq!(points.len(), file.points().len(), "there must be one point per vertex");
        let Some(target) = TARGETS.iter().find(|target| target.format == to) else {
            return Ok(None);
        };
        // Regions of cell data stay data in a format without groups of surfaces.
        let stores_regions = target.capabilities.stores_groups_of_surfaces();
        let mut content = file.content_with(file.region_array().filter(|_| stores_regions))?;
        content.points = points.to_vec();
        set_fields(&mut content, fields);
        write_grids::match_depths(&mut content, file.format(), to);
        let has_lines = matches!(to, Format::Adcirc | Format::Sms2dm | Format::Selafin);
        if file.format() == Format::Mike && has_lines {
            boundary_codes::to_lines(&mut content);
        }
        let is_code = |(group, _): &(ContentGroup, _)| group.tag().is_some_and(|tag| tag != 0);
        let coded = match to {
            // Numbered groups of vertices are the codes of MIKE, if there are any.
            Format::Mike if !content.vertex_groups.iter().any(is_code) => {
                BoundaryCodes::new(&content).groups
            }
            Format::Selafin => BoundaryCodes::new(&content).groups,
            _ => Vec::new(),
        };
        let lost = target.capabilities.losses(&content, &coded);
        let omissions = target.capabilities.omissions(&content);
        let mut renamed = names::fit(&target.capabilities, &mut content);
        renamed.extend(target.capabilities.renumbered_zero(&content));
        renamed.extend(names::regions(&content, file.format(), to));
        let creator = "mesh-io".to_owned();
        let encoding = match target.write {
            WriteFunction::Binary(_) => Encoding::Binary,
            _ => Encoding::Text,
        };
        let (losses, renamings) = (lost, renamed);
        Ok(Some(Conversion { content, target, losses, renamings, omissions, creator, encoding }))
    }

    /// Sets the program name in the titles of written files, `written by NAME`. The default name is `mesh-io`.
    pub fn set_creator(&mut self, name: &str) {
        name.clone_into(&mut self.creator);
    }

    /// Sets the encoding of the written file. Returns false, and changes nothing, if the format is not written in this
    /// encoding: gmsh, legacy VTK and PLY are written as text and in binary, VTK XML also compressed, and all other formats
    /// in one encoding.
    pub fn set_encoding(&mut self, encoding: Encoding) -> bool {
        let is_written = match (&self.target.write, encoding) {
            (WriteFunction::Encoded { compressed, .. }, Encoding::Compressed) => {
                compressed.is_some()
            }
            (WriteFunction::Encoded { .. }, _) => true,
            _ => encoding == self.encoding,
        };
        if is_written {
            self.encoding = encoding;
            self.losses.retain(|lost| lost != LARGE_IDS);
            if self.renumbers() && self.target.capabilities.keeps_vertex_ids {
                self.losses.push(LARGE_IDS.into());
            }
        }
        is_written
    }

    /// Returns whether vertices have ids that a binary file cannot hold.
    fn renumbers(&self) -> bool {
        let is_large = |&id: &u64| i32::try_from(id).is_err();
        self.encoding != Encoding::Text && self.content.vertex_ids.iter().any(is_large)
    }

    /// Lists the parts of the mesh that the format cannot store, one line each. Comments, titles and element numbers
    /// are always lost, and not listed.
    pub fn losses(&self) -> &[String] {
        &self.losses
    }

    /// Lists changes of names that the format cannot spell or cannot distinguish: one line each for groups, groups of
    /// vertices, data of vertices and data of elements. Distinct groups and arrays stay distinct.
    pub fn renamings(&self) -> &[String] {
        &self.renamings
    }

    /// Lists what the format does not store, although no vertex, element or number depends on it, one line each: names of
    /// groups without elements, and the numbers of components of data that zeros fill up.
    pub fn omissions(&self) -> &[String] {
        &self.omissions
    }

    /// Lists the files that [`write`](Self::write) to `path` may create. The `.poly` of a Triangle mesh is always
    /// listed, but written only for a mesh with lines. The list of boundary conditions beside a SELAFIN is not listed.
    pub fn destinations(&self, path: &Path) -> Vec<PathBuf> {
        Self::destinations_in(self.target.format, path)
    }

    /// Lists the files that a conversion to the format `to` may create at `path`, as [`destinations`](Self::destinations)
    /// does.
    pub fn destinations_in(to: Format, path: &Path) -> Vec<PathBuf> {
        let target = TARGETS.iter().find(|target| target.format == to);
        match target.map(|target| &target.write) {
            Some(WriteFunction::Several(_)) => {
                let Names { node, ele, poly } = Names::of(path);
                vec![node, ele, poly]
            }
            _ => vec![path.to_owned()],
        }
    }

    /// Returns the precision with which the format stores coordinates.
    pub fn precision(&self) -> Precision {
        self.target.capabilities.precision
    }

    /// Returns the format to which the mesh is converted.
    pub fn format(&self) -> Format {
        self.target.format
    }

    /// Returns whether the format holds quadrilaterals.
    pub fn holds_quadrilaterals(&self) -> bool {
        self.target.capabilities.quadrilaterals
    }

    /// Checks, without writing, whether [`write`](Self::write) to `path` can succeed.
    ///
    /// # Errors
    /// [`WriteError`] for the reasons of [`write`](Self::write).
    pub fn check_destination(&self, path: &Path) -> Result<(), WriteError> {
        let destinations = self.destinations(path);
        let refused = |problem: String, remedy: &str| {
            let (path, remedy) = (path.to_owned(), remedy.to_owned());
            Err(WriteError::Format { path, problem, remedy })
        };
        let family = FormatEntry::of(self.target.format);
        if let Some(owner) = detect::format_name_of_extension(path)
            && !family.matches_extension(path)
        {
            let problem = format!("the ending belongs to {owner}, not to {}", self.target.format);
            return refused(problem, &format!("End the name in {}", family.extensions[0]));
        }
        if Compression::of(path).is_some() && destinations.len() > 1 {
            let problem = "a Triangle mesh is of several files, which are not written compressed";
            return refused(problem.into(), "End the name in .node");
        }
        // A Triangle mesh without lines has no outline.
        let has_all = !matches!(self.target.write, WriteFunction::Several(_))
            || self.input().count(CellKind::Line) > 0;
        let left = destinations.get(2).filter(|left| !has_all && left.exists());
        if let Some(left) = left {
            let problem = format!(
                "{} exists, belongs to another mesh, and would be read with the new files",
                left.display()
            );
            return refused(problem, "Remove it, or take another name");
        }
        if let Some((list, text)) = self.conditions(path) {
            if fs::read(&list).is_ok_and(|old| old != text.as_bytes()) {
                let problem = format!(
                    "{} exists, with other boundary conditions than the mesh",
                    list.display()
                );
                return refused(problem, "Remove it, or take another name");
            }
            atomic::ensure_writable(&list)?;
        }
        destinations.iter().try_for_each(|path| atomic::ensure_writable(path))
    }

    /// Returns the path and the text of the list of boundary conditions beside a SELAFIN at `path`. `None` without boundaries,
    /// or if `path` is a device.
    fn conditions(&self, path: &Path) -> Option<(PathBuf, String)> {
        let is_file = !path.exists() || path.is_file();
        if self.format() != Format::Selafin || !is_file {
            return None;
        }
        Some((conditions::path_beside(path), conditions::write_conditions(&self.input())?))
    }

    /// Writes the mesh, compressed if `path` ends in `.gz` or `.zst`. Existing files are replaced after all new content
    /// is on the disk. A SELAFIN with boundaries gets a list of boundary conditions beside it, `NAME.cli`.
    ///
    /// # Errors
    /// [`WriteError`] for errors of the operating system, if `path` has the ending of another format, if a Triangle
    /// mesh gets a compressed name, if an existing `.poly` would be read with a new Triangle mesh without lines, or if an
    /// existing list of boundary conditions differs from the new list.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        self.check_destination(path)?;
        let (destinations, contents) = (self.destinations(path), self.contents());
        let packs = Compression::of(path);
        let mut writes: Vec<FileWrite<'_>> = Vec::new();
        for (path, content) in destinations.into_iter().zip(&contents) {
            writes.push((path, Box::new(move |out| put(content, packs, out))));
        }
        if let Some((list, text)) = self.conditions(path) {
            writes.push((list, Box::new(move |out| out.write_all(text.as_bytes()))));
        }
        atomic::write_all(&writes)
    }

    /// Returns the content of a single text file. `None` for binary formats, and for the several files of a Triangle
    /// mesh.
    pub fn text(&self) -> Option<String> {
        match self.target.write {
            WriteFunction::One(write) => Some(write(&self.input())),
            WriteFunction::Encoded { text, .. } if self.encoding == Encoding::Text => {
                Some(text(&self.input()))
            }
            _ => None,
        }
    }

    /// Returns the content of a single file, text or binary. `None` for the several files of a Triangle mesh.
    pub fn bytes(&self) -> Option<Vec<u8>> {
        match self.target.write {
            WriteFunction::Several(_) => None,
            _ => self.contents().pop(),
        }
    }

    fn contents(&self) -> Vec<Vec<u8>> {
        let input = &self.input();
        match self.target.write {
            WriteFunction::One(write) => vec![write(input).into_bytes()],
            WriteFunction::Binary(write) => vec![write(input)],
            WriteFunction::Encoded { text, binary, compressed } => {
                let bytes = match (self.encoding, compressed) {
                    (Encoding::Compressed, Some(compressed)) => compressed(input),
                    (Encoding::Text, _) => text(input).into_bytes(),
                    _ => binary(input),
                };
                vec![bytes]
            }
            WriteFunction::Several(write) => {
                write(input).into_iter().map(String::into_bytes).collect()
            }
        }
    }

    fn input(&self) -> WriterInput<'_> {
        let input = WriterInput::new(&self.content, self.target.capabilities, &self.creator);
        if self.renumbers() { input.renumbered() } else { input }
    }
}

/// Sets the values of fields of the file in its content. The time steps of a result are fields with equal names, and
/// distinct arrays of the content.
impl MeshFile {
    /// Returns whether the format of the file can hold quadrilaterals. A conversion to another format loses them.
    pub fn holds_quadrilaterals(&self) -> bool {
        Conversion::writes_quadrilaterals(self.format())
    }
}

fn set_fields(content: &mut Content, fields: &[PointField]) {
    let mut uses: HashMap<&str, usize> = HashMap::new();
    for field in fields {
        let step = uses.entry(field.name()).or_default();
        if field.is_third_of_points() && !content.z_values.is_empty() {
            content.z_values = field.values().to_vec();
            continue;
        }
        *step += 1;
        let name = match *step {
            1 => field.name().to_owned(),
            step => format!("{} {step}", field.name()),
        };
        let is_own =
            |data: &&mut DataArray| data.name == name && data.values.len() == field.values().len();
        if let Some(data) = content.point_data.iter_mut().find(is_own) {
            data.set_stored(field.values());
        }
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
