//! Rewrite of a mesh file with the coordinates of moved vertices.

use crate::compress::file::Compression;
use crate::detect;
use crate::disk::atomic;
use crate::disk::atomic::FileWrite;
use crate::disk::file_system::OsFileSystem;
use crate::disk::paths::same_file;
use crate::disk::source::Source;
use crate::edit::column::EditableColumn;
use crate::edit::numbers::{ByteEdit, EncodedArrays};
use crate::edit::rewrite::Rewrite;
use crate::error::WriteError;
use crate::formats::selafin::conditions;
use crate::mesh_file::mesh::MeshFile;
use crate::registry::FormatEntry;
use crate::text::token::quoted;
use crate::visit::field::PointField;
use crate::visit::storage::{ArrayLocation, ByteSpace};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// New coordinates and fields for a rewrite.
#[derive(Clone, Copy)]
struct Edits<'a> {
    points: &'a [[f64; 2]],
    fields: &'a [PointField],
}

impl MeshFile {
    /// Writes the file again with vertex `i` at `points[i]`, in the units of the file.
    ///
    /// Coordinates with unchanged bits keep their text. Changed coordinates are written with the fewest digits that
    /// parse back to equal bits. All files of a Triangle mesh get the name in `path`, which may lack an ending. `path`
    /// may name the file that was read. Existing files are replaced after all new content is on the disk, and symbolic
    /// links are followed. The list of boundary conditions beside a SELAFIN (`NAME.cli`) is copied beside `path`, unless such a
    /// file exists.
    ///
    /// If `path` ends in `.gz` or `.zst`, the file is compressed by gzip or zstd. Without any change, a file of equal
    /// compression keeps its compressed bytes.
    ///
    /// # Errors
    /// [`WriteError`] for the reasons of [`check_destination`](Self::check_destination), for points that are not finite
    /// or not one per vertex ([`WriteError::Points`]), and for errors of the operating system ([`WriteError::Io`]).
    /// [`WriteError::Changed`] if another program has changed a file to be replaced since this process read or wrote
    /// the file. After an error, existing files are unchanged.
    pub fn write(&self, path: &Path, points: &[[f64; 2]]) -> Result<(), WriteError> {
        self.write_with_fields(path, points, &[])
    }

    /// Writes the file as [`write`](Self::write) does, and also replaces data of vertices by the values of `fields`.
    /// Fields must come from [`point_fields`](Self::point_fields), [`plane_parameters`](Self::plane_parameters) or
    /// [`centers`](Self::centers) of this file. Numbers with unchanged bits keep their text.
    ///
    /// # Errors
    /// [`WriteError`] for the reasons of [`write`](Self::write).
    pub fn write_with_fields(
        &self,
        path: &Path,
        points: &[[f64; 2]],
        fields: &[PointField],
    ) -> Result<(), WriteError> {
        self.check_points(path, points)?;
        self.check_shared(path, Edits { points, fields })?;
        self.check_files(path)?;
        let packs = self.compression_of(path);
        let renamed = &(self.reader().renames)(self.source(), path);
        let file_write = |(part, destination)| -> FileWrite<'_> {
            let edits = Edits { points, fields };
            (
                destination,
                Box::new(move |out| match part {
                    0 if !renamed.is_empty() => self.put_plain(0, edits, renamed, out),
                    _ => self.put(part, edits, packs, out),
                }),
            )
        };
        let destinations = self.destinations(path)?;
        let parts = self.files().into_iter().zip(&destinations);
        let in_place: Vec<&Source> = parts
            .filter(|(part, destination)| same_file(&part.path, destination))
            .map(|(part, _)| part)
            .collect();
        let mut writes: Vec<_> = destinations.iter().cloned().enumerate().map(file_write).collect();
        if let Some((list, destination)) = self.copy_beside(path) {
            writes.push((destination, Box::new(move |out| out.write_all(list.stored()))));
        }
        // The first entry is the main file, which is renamed last: readers never see a mix of old and new files. If the
        // main file is unchanged, the file with the coordinates becomes the first entry, and the main file stays in
        // place.
        if self.file_index() > 0 && self.is_written(&writes[0].0, renamed) {
            writes.swap(0, self.file_index());
        }
        atomic::write_all_if(&OsFileSystem, &writes, &|| match in_place
            .iter()
            .find(|part| part.known.has_changed(&part.path, part.stored()))
        {
            Some(changed) => Err(WriteError::Changed { path: changed.path.clone() }),
            None => Ok(()),
        })?;
        in_place.iter().for_each(|part| part.known.note_written(&part.path));
        Ok(())
    }

    /// Returns the list of boundary conditions beside a SELAFIN, with the path to which a write to `path` copies the list. `None`
    /// if there is no list, if `path` is a device, or if a list exists beside `path`: users edit their lists.
    fn copy_beside(&self, path: &Path) -> Option<(&Source, PathBuf)> {
        let list = self.source().beside.as_deref()?;
        let destination = conditions::path_beside(path);
        let is_file = !path.exists() || path.is_file();
        (is_file && !destination.exists()).then_some((list, destination))
    }

    /// Returns whether the destination of the main file already has exactly the bytes of the rewrite.
    fn is_written(&self, path: &Path, renamed: &[ByteEdit]) -> bool {
        let mut new = Vec::new();
        let bytes = &self.source().bytes;
        let written = Rewrite { bytes, columns: &[], edits: renamed }.write(&mut new);
        written.is_ok() && std::fs::read(path).is_ok_and(|old| old == new)
    }

    /// Writes the file as [`write`](Self::write) does, to any writer such as the standard output. The output is
    /// compressed if the original file is compressed.
    ///
    /// # Errors
    /// [`WriteError`] if the points are not finite or not one per vertex, if the mesh has several files, or if `out`
    /// reports an error. Messages use `name` as the name of the output.
    pub fn write_to(
        &self,
        name: &Path,
        out: &mut (dyn Write + Send),
        points: &[[f64; 2]],
    ) -> Result<(), WriteError> {
        self.write_to_with_fields(name, out, points, &[])
    }

    /// Writes the file and `fields` as [`write_with_fields`](Self::write_with_fields) does, to any writer as
    /// [`write_to`](Self::write_to) does.
    ///
    /// # Errors
    /// [`WriteError`] for the reasons of [`write_to`](Self::write_to).
    pub fn write_to_with_fields(
        &self,
        name: &Path,
        out: &mut (dyn Write + Send),
        points: &[[f64; 2]],
        fields: &[PointField],
    ) -> Result<(), WriteError> {
        self.check_points(name, points)?;
        self.check_shared(name, Edits { points, fields })?;
        if self.files().len() > 1 {
            let problem = "the mesh is of several files".to_owned();
            let remedy = "Name a file to write to".to_owned();
            return Err(WriteError::Format { path: name.to_owned(), problem, remedy });
        }
        let packs = self.source().compressed.as_ref().map(|packed| packed.compression);
        self.put(0, Edits { points, fields }, packs, out).and_then(|()| out.flush()).map_err(
            |source| {
                let remedy = "Write to a file instead".to_owned();
                WriteError::Io { path: name.to_owned(), source, remedy }
            },
        )
    }

    /// Returns the compression for a rewrite to `path`, given by the extension. If neither `path` nor the original path
    /// has a compression's extension, the original compression is kept.
    fn compression_of(&self, path: &Path) -> Option<Compression> {
        let source = self.source();
        match Compression::of(path) {
            None if Compression::of(&source.path).is_none() => {
                source.compressed.as_ref().map(|packed| packed.compression)
            }
            by_ending => by_ending,
        }
    }

    /// Writes the file with index `part`, compressed by `packs`.
    fn put(
        &self,
        part: usize,
        edits: Edits<'_>,
        packs: Option<Compression>,
        out: &mut (dyn Write + Send),
    ) -> io::Result<()> {
        let Edits { points, fields } = edits;
        let Some(packing) = packs else { return self.put_plain(part, edits, &[], out) };
        let is_same = || self.is_unmoved(points) && !fields.iter().any(PointField::is_changed);
        match &self.files()[part].compressed {
            // The original bytes are kept: another program may have compressed equal content to other bytes.
            Some(packed) if packed.compression == packing && is_same() => {
                out.write_all(&packed.bytes)
            }
            _ => packing.compress(out, |out| self.put_plain(part, edits, &[], out)),
        }
    }

    /// Writes the file with index `part` uncompressed. `renamed` holds the edits for new names of companions.
    fn put_plain(
        &self,
        part: usize,
        edits: Edits<'_>,
        renamed: &[ByteEdit],
        out: &mut (dyn Write + Send),
    ) -> io::Result<()> {
        let Edits { points, fields } = edits;
        let bytes = &self.files()[part].bytes[..];
        let has_points = part == self.file_index();
        let coordinates = || {
            EditableColumn::of_points(
                self.x_offsets(),
                self.offset_vertices(),
                self.encoding(),
                self.points(),
                points,
            )
        };
        // Columns of numbers in the file itself and in the decoded points. Columns of other encoded arrays become
        // edits.
        let (mut in_file, mut in_points) = (Vec::new(), Vec::new());
        let mut in_others: Vec<(&Arc<dyn EncodedArrays>, Vec<EditableColumn<'_>>)> = Vec::new();
        let (mut edits, mut end) = (renamed.to_vec(), bytes.len());
        let mut again =
            |array: &dyn EncodedArrays, columns: &[EditableColumn<'_>]| -> io::Result<()> {
                let old = array.bytes();
                let mut new = Vec::with_capacity(old.len());
                Rewrite { bytes: old, columns, edits: &[] }.write(&mut new)?;
                edits.extend(array.edits(bytes, &new, &mut end));
                Ok(())
            };
        let own =
            |field: &&PointField| field.location().is_some_and(|stored| stored.file_index == part);
        let mut shared_ranges = Vec::new();
        for field in fields.iter().filter(own).filter(|field| field.is_changed()) {
            let (Some(column), Some(ArrayLocation { space: home, shared, .. })) =
                (field.column(), field.location())
            else {
                continue;
            };
            // Fields with the same bytes have equal new numbers, which are written once.
            if let Some(shared) = shared {
                if shared_ranges.contains(&&shared.range) {
                    continue;
                }
                shared_ranges.push(&shared.range);
            }
            match home {
                ByteSpace::File => in_file.push(column),
                ByteSpace::Points => in_points.push(column),
                ByteSpace::Encoded(array) => {
                    match in_others.iter_mut().find(|(other, _)| Arc::ptr_eq(array, other)) {
                        Some((_, columns)) => columns.push(column),
                        None => in_others.push((array, vec![column])),
                    }
                }
            }
        }
        in_others.iter().try_for_each(|(array, columns)| again(&***array, columns))?;
        let encoded = self.encoded_points().filter(|_| has_points);
        match encoded {
            None if has_points => in_file.extend(coordinates()),
            None => {}
            Some(array) => {
                in_points.extend(coordinates());
                again(array, &in_points)?;
            }
        }
        let homes = fields.iter().filter(own);
        let homes = homes.filter_map(|field| field.location().map(|stored| &stored.space));
        let arrays = encoded.into_iter().chain(homes.filter_map(|home| match home {
            ByteSpace::Encoded(array) => Some(&**array),
            _ => None,
        }));
        let mut more: Vec<ByteEdit> = Vec::new();
        for array in arrays {
            for own in array.dependent_edits(bytes, &edits, end) {
                if more.iter().all(|edit| edit.range != own.range) {
                    more.push(own);
                }
            }
        }
        edits.extend(more);
        edits.sort_by_key(|edit| edit.range.start);
        Rewrite { bytes, columns: &in_file, edits: &edits }.write(out)
    }

    /// Returns whether all points, rounded to the file's precision, equal the original points.
    fn is_unmoved(&self, points: &[[f64; 2]]) -> bool {
        let bits = |x: f64| self.precision().rounded(x).to_bits();
        let mut pairs = points.iter().flatten().zip(self.points().iter().flatten());
        pairs.all(|(&new, &old)| bits(new) == old.to_bits())
    }

    /// Checks, without writing, whether [`write`](Self::write) to `path` can succeed. `path` must not have the ending
    /// of another format, its directory must exist and accept new files, and no directory or read-only file may block a
    /// destination. No other array of the file may have bytes of the points, as new points would change the array.
    ///
    /// # Errors
    /// [`WriteError`] if the file cannot be written, with the reason.
    pub fn check_destination(&self, path: &Path) -> Result<(), WriteError> {
        self.check_shared_points(path)?;
        self.check_files(path)
    }

    /// Checks, without writing, whether all files of a write to `path` can be replaced or made.
    fn check_files(&self, path: &Path) -> Result<(), WriteError> {
        self.destinations(path)?
            .iter()
            .try_for_each(|destination| atomic::ensure_writable(destination))
    }

    /// Lists the files that [`write`](Self::write) to `path` writes, in the order of [`paths`](Self::paths).
    ///
    /// # Errors
    /// [`WriteError::Format`] if `path` is no file name or has the ending of another format, or if an existing file
    /// would be read instead of the new Triangle mesh or together with the new mesh.
    pub fn destinations(&self, path: &Path) -> Result<Vec<PathBuf>, WriteError> {
        let usual = FormatEntry::of(self.format()).extensions[0];
        let refused = |problem: String, remedy: String| {
            Err(WriteError::Format { path: path.to_owned(), problem, remedy })
        };
        let ends_in_separator =
            path.to_string_lossy().chars().next_back().is_none_or(std::path::is_separator);
        // A device takes a single file, not several.
        let is_device = path.exists() && !path.is_file() && self.files().len() > 1;
        if path.is_dir() || is_device || ends_in_separator || path.file_name().is_none() {
            return refused("not the name of a file".into(), format!("Add a name like out{usual}"));
        }
        if let Some(owner) = detect::format_name_of_extension(path)
            && !FormatEntry::of(self.format()).matches_extension(path)
        {
            let problem =
                format!("the ending belongs to {owner}, but the mesh is {}", self.format());
            return refused(
                problem,
                format!("The format is kept: end the name in {usual}, or convert the mesh"),
            );
        }
        (self.reader().destinations)(self.source(), path)
    }

    /// Checks that no other array has bytes of the points, as new points would change the array.
    fn check_shared_points(&self, path: &Path) -> Result<(), WriteError> {
        let Some(other) = self.shared_with() else { return Ok(()) };
        let (path, name) = (path.to_owned(), self.source().name());
        let problem =
            format!("the points of {name} have the bytes of {other} too, and would change both");
        let remedy = "Convert the mesh first: the new file has separate bytes for each".to_owned();
        Err(WriteError::Format { path, problem, remedy })
    }

    /// Checks that the changes of a write change no other array. Data with the same bytes may change together, to the same
    /// numbers. A write without changes passes.
    fn check_shared(&self, path: &Path, edits: Edits<'_>) -> Result<(), WriteError> {
        let Edits { points, fields } = edits;
        // Third coordinates are a field with bytes of the points.
        if fields.iter().any(PointField::is_changed) || !self.is_unmoved(points) {
            self.check_shared_points(path)?;
        }
        for field in fields.iter().filter(|field| field.is_changed()) {
            let Some(shared) = field.location().and_then(|stored| stored.shared.as_ref()) else {
                continue;
            };
            let copies = fields.iter().filter(|other| other.is_copy_of(field)).count();
            if copies <= shared.others {
                let (own, other) = (quoted(field.name().as_bytes()), &shared.other);
                let problem =
                    format!("'{own}' has the bytes of {other} too, and would change both");
                let remedy = "Interpolate both or neither, or convert the mesh first: the new file has separate bytes for each"
                    .to_owned();
                return Err(WriteError::Format { path: path.to_owned(), problem, remedy });
            }
        }
        Ok(())
    }

    fn check_points(&self, path: &Path, points: &[[f64; 2]]) -> Result<(), WriteError> {
        let refused = |problem| Err(WriteError::Points { path: path.to_owned(), problem });
        let vertices = self.points().len();
        if points.len() != vertices {
            return refused(format!("{} points given for {vertices} vertices", points.len()));
        }
        let precision = self.precision();
        let is_finite = |&x: &f64| precision.rounded(x).is_finite();
        match points.iter().position(|point| !point.iter().all(is_finite)) {
            Some(index) => {
                let [x, y] = points[index];
                refused(format!("the point given for vertex index {index} is ({x}, {y})"))
            }
            None => Ok(()),
        }
    }
}
