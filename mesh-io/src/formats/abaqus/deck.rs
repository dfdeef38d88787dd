//! Selects the blocks of an input file that describe the mesh: blocks of the model itself, and of the parts and instances
//! that contain elements.

use super::blocks::{self, Block};
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::token::quoted;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// The keyword blocks of an input file, assigned to the model, the assembly, parts and instances.
pub(super) struct Deck<'a> {
    /// The keyword blocks in file order, with the number of the scope that contains each block.
    pub(super) blocks: Vec<(Block<'a>, usize)>,
    /// The scopes of the mesh, ascending: the scopes with elements, else the first scope with nodes, else [`MODEL`].
    meshes: Vec<usize>,
    /// The number that is added to the ids of nodes and elements of each scope in `meshes`, so that no id occurs in two scopes.
    offsets: Vec<u64>,
    /// The name of each scope, which is empty for the model and the assembly.
    names: Vec<Vec<u8>>,
    /// Maps the name of an instance, in capital letters, to the scope of the mesh that the instance is or refers to.
    instances: HashMap<Vec<u8>, usize>,
    /// Remarks for the user.
    pub(super) notes: Vec<String>,
}

/// The scope of blocks outside of parts and assemblies. Parts and instances have scopes from 2 on, in file order.
const MODEL: usize = 0;
/// The scope of an assembly's own blocks, outside of instances.
pub(super) const ASSEMBLY: usize = 1;

/// Keywords that generate or move nodes or elements, so that the rows of `*NODE` and `*ELEMENT` alone do not give the
/// mesh.
const GENERATING_KEYWORDS: [&str; 8] =
    ["NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SYMMETRICMODELGENERATION"];
/// Limit on the depth of nested includes.
const MAX_INCLUDE_DEPTH: u32 = 8;

impl<'a> Deck<'a> {
    pub(super) fn read(source: &'a Source) -> Result<Deck<'a>, ReadError> {
        let blocks = blocks::blocks(source);
        let mut deck = Deck {
            blocks: Vec::new(),
            meshes: Vec::new(),
            offsets: vec![0],
            names: vec![Vec::new(), Vec::new()],
            instances: HashMap::new(),
            notes: Vec::new(),
        };
        // For each instance: its name and the name of its part, both in capital letters, and its scope.
        let mut instances = Vec::new();
        let mut part_names = HashMap::new();
        let mut scope = MODEL;
        let mut first = None;
        for block in blocks {
            let name = |parameter| block.name(parameter).unwrap_or_default();
            match &block.keyword[..] {
                b"PART" | b"INSTANCE" => {
                    let own = deck.names.len();
                    deck.names.push(name("NAME").to_vec());
                    let key = name("NAME").to_ascii_uppercase();
                    match block.is("PART") {
                        true => drop(part_names.insert(key, own)),
                        false => instances.push((key, name("PART").to_ascii_uppercase(), own)),
                    }
                    scope = own;
                }
                b"ENDPART" | b"ENDASSEMBLY" => scope = MODEL,
                b"ASSEMBLY" | b"ENDINSTANCE" => scope = ASSEMBLY,
                b"ELEMENT" if scope != ASSEMBLY => deck.meshes.push(scope),
                b"NODE" => first = first.or(Some(scope)),
                _ => {}
            }
            check(source, &block)?;
            deck.blocks.push((block, scope));
        }
        deck.meshes.sort_unstable();
        deck.meshes.dedup();
        if deck.meshes.is_empty() {
            deck.meshes.push(first.unwrap_or(MODEL));
        }
        for (name, part, own) in instances {
            let scopes = [Some(own), part_names.get(&part).copied()].into_iter().flatten();
            if let Some(of_mesh) = scopes.into_iter().find(|scope| deck.is_mesh(*scope)) {
                deck.instances.insert(name, of_mesh);
            }
        }
        deck.check_included(source)?;
        deck.tell_ids_apart(source);
        Ok(deck)
    }

    /// Finds the offsets of ids if several scopes have elements. The offsets are multiples of a power of ten above all ids, so the
    /// last digits of a raised id are the id in the file.
    fn tell_ids_apart(&mut self, source: &Source) {
        let count = self.meshes.len();
        if count == 1 {
            return;
        }
        let lists = self.of_mesh("NODE").chain(self.of_mesh("ELEMENT"));
        let largest = lists.flat_map(|(block, _)| block.first_numbers(source)).max().unwrap_or(0);
        let mut step: u64 = 10;
        while step <= largest {
            step = step.saturating_mul(10);
        }
        self.offsets = (0..count as u64).map(|place| step.saturating_mul(place)).collect();
        let names: Vec<String> = self.meshes.iter().map(|&scope| self.shown(scope)).collect();
        let first = names[..count.min(3)].join(", ");
        let more = if count > 3 { ", …" } else { "" };
        self.notes.push(format!(
            "{count} parts have elements ({first}{more}): each is read in coordinates of its own, without the position of its instance"
        ));
    }

    /// Returns the name of a scope of the mesh for messages.
    fn shown(&self, scope: usize) -> String {
        match scope {
            MODEL => "the model".to_owned(),
            _ => quoted(&self.names[scope]),
        }
    }

    /// Returns whether nodes and elements of a scope belong to the mesh.
    fn is_mesh(&self, scope: usize) -> bool {
        self.meshes.binary_search(&scope).is_ok()
    }

    /// Returns the number that is added to ids of a scope of the mesh.
    pub(super) fn offset(&self, scope: usize) -> u64 {
        self.meshes.binary_search(&scope).map_or(0, |place| self.offsets[place])
    }

    /// Returns the name of the part or instance that a scope is, if several scopes have elements.
    pub(super) fn name(&self, scope: usize) -> Option<&[u8]> {
        (self.meshes.len() > 1).then(|| &self.names[scope][..])
    }

    /// Lists the blocks of the mesh with the given keyword, each with its scope.
    pub(super) fn of_mesh(&self, keyword: &str) -> impl Iterator<Item = (&Block<'a>, usize)> {
        let own = self.blocks.iter().filter(move |(block, scope)| {
            block.keyword == keyword.as_bytes() && self.is_mesh(*scope)
        });
        own.map(|(block, scope)| (block, *scope))
    }

    /// Lists the section blocks of the mesh, which assign materials to sets of elements, each with its scope.
    pub(super) fn sections(&self) -> impl Iterator<Item = (&Block<'a>, usize)> {
        let own =
            self.blocks.iter().filter(|(block, scope)| is_section(block) && self.is_mesh(*scope));
        own.map(|(block, scope)| (block, *scope))
    }

    /// Lists the blocks of the assembly with the given keyword; none if the file has no assembly.
    pub(super) fn of_assembly(&self, keyword: &str) -> impl Iterator<Item = &Block<'a>> {
        let own = self.blocks.iter().filter(move |(block, scope)| {
            *scope == ASSEMBLY && block.keyword == keyword.as_bytes()
        });
        own.map(|(block, _)| block)
    }

    /// Returns the scope of the mesh that an instance is or refers to, given its name in capital or small letters. `None` for
    /// instances without a mesh.
    pub(super) fn instance(&self, name: &[u8]) -> Option<usize> {
        self.instances.get(&name.to_ascii_uppercase()).copied()
    }

    /// Inspects the files of all `*INCLUDE` blocks. Adds a remark if included files have sets, sections or surfaces, or
    /// cannot be read.
    ///
    /// # Errors
    /// If an included file holds nodes or elements. [`ReadError::Outside`] as for [`included`].
    fn check_included(&mut self, source: &Source) -> Result<(), ReadError> {
        let mut seen = HashSet::new();
        let (mut with_sets, mut unknown) = (Vec::new(), Vec::new());
        for (at, (block, _)) in self.blocks.iter().enumerate() {
            let Some(name) = block.name("INPUT").filter(|_| block.is("INCLUDE")) else { continue };
            let before = at.checked_sub(1).map(|before| &self.blocks[before].0);
            let continues = before.is_some_and(|before| before.is("NODE") || before.is("ELEMENT"));
            let place = Inclusion { from: source, at: block.at, name };
            match included(source, place, continues, &mut seen, MAX_INCLUDE_DEPTH)? {
                Included::Mesh => {
                    let shown = quoted(name);
                    let problem =
                        format!("{shown}, which is included here, holds nodes or elements");
                    return Err(block.error(source, problem, "Put its text in place of this line"));
                }
                Included::Sets => with_sets.push(name),
                Included::Unknown => unknown.push(name),
                Included::Other => {}
            }
        }
        let told = |names: &[&[u8]], one: &str, several: &str| {
            let first = names.first().map(|name| quoted(name))?;
            Some(match names.len() {
                1 => format!("{first}, which is included, {one}"),
                count => format!("{count} files such as {first}, which are included, {several}"),
            })
        };
        self.notes.extend(told(
            &with_sets,
            "has sets, sections or surfaces: they are not read",
            "have sets, sections or surfaces: they are not read",
        ));
        self.notes.extend(told(
            &unknown,
            "does not exist: its content is not part of the mesh",
            "do not exist: their content is not part of the mesh",
        ));
        Ok(())
    }
}

/// Refuses a block whose own rows do not give all nodes or elements: a keyword that generates or moves nodes, rows in
/// another file (`INPUT`), or a `SYSTEM` other than Cartesian. `*SYSTEM` without data ends a local system, and is
/// accepted.
fn check(source: &Source, block: &Block<'_>) -> Result<(), ReadError> {
    let shown = String::from_utf8_lossy(&block.keyword).into_owned();
    let has_data = || block.items(source).any(|(item, _)| !item.is_empty());
    let is_generator = GENERATING_KEYWORDS.iter().any(|keyword| block.is(keyword));
    if is_generator && (!block.is("SYSTEM") || has_data()) {
        let what = if block.is("SYSTEM") || block.is("NMAP") {
            "moves nodes"
        } else {
            "makes nodes or elements"
        };
        let problem =
            format!("*{shown} {what}, so some nodes or elements are not in rows of the file");
        return Err(block.error(
            source,
            problem,
            "Write the mesh with a row for each node and element",
        ));
    }
    let is_list = block.is("NODE") || block.is("ELEMENT");
    if let Some(file) = block.parameter("INPUT").filter(|_| is_list) {
        let problem = format!("the rows of *{shown} are in another file, {}", quoted(file));
        return Err(block.error(source, problem, "Put its text below this line, without INPUT"));
    }
    if let Some(system) = block.name("SYSTEM").filter(|_| block.is("NODE"))
        && !system.eq_ignore_ascii_case(b"R")
    {
        let problem = format!("nodes are in the coordinates of SYSTEM={}", quoted(system));
        return Err(block.error(source, problem, "Write them in x and y (SYSTEM=R)"));
    }
    Ok(())
}

/// The most important content of an included file. Later variants outrank earlier variants.
#[derive(PartialEq, PartialOrd)]
enum Included {
    /// Other keywords, such as materials and loads, or a file inspected before.
    Other,
    /// Unknown content: the file cannot be read, or the includes are nested too deep.
    Unknown,
    /// Sets, surfaces or sections, but neither nodes nor elements.
    Sets,
    Mesh,
}

/// An `*INCLUDE` line of the mesh file or of an included file.
#[derive(Clone, Copy)]
struct Inclusion<'a> {
    from: &'a Source,
    /// The offset of the keyword in the bytes of `from`.
    at: usize,
    /// The name of the included file.
    name: &'a [u8],
}

/// Returns the content of the file that an `*INCLUDE` line names, including files named there. Files in `seen` are not
/// inspected again. If `continues`, rows before the file's first keyword belong to the node or element list before the
/// `*INCLUDE`. `depth` limits how many nested files are opened. `mesh` is the main file.
///
/// # Errors
/// [`ReadError::Outside`] if the file is outside of the directory of `mesh`, unless the options of `mesh` allow other
/// directories.
fn included(
    mesh: &Source,
    Inclusion { from, at, name }: Inclusion<'_>,
    continues: bool,
    seen: &mut HashSet<(PathBuf, bool)>,
    depth: u32,
) -> Result<Included, ReadError> {
    let path = from.path.parent().unwrap_or(Path::new(""));
    let path = path.join(String::from_utf8_lossy(name).into_owned());
    if !seen.insert((path.clone(), continues)) {
        return Ok(Included::Other);
    }
    from.check_inside(mesh, &path, &quoted(name), at)?;
    let is_file = std::fs::metadata(&path).is_ok_and(|about| about.is_file());
    let loaded = if is_file && depth > 0 { Source::load(&path).ok() } else { None };
    let Some(source) = loaded else { return Ok(Included::Unknown) };
    let blocks = blocks::blocks(&source);
    let first = blocks.first().map_or(source.bytes.len(), |block| block.at);
    let mut rows = source.bytes[source.begin()..first].split(|&byte| byte == b'\n');
    if continues && rows.any(|row| !matches!(row.trim_ascii(), [] | [b'*', ..])) {
        return Ok(Included::Mesh);
    }
    let mut found = Included::Other;
    for block in &blocks {
        let is_mesh =
            ["NODE", "ELEMENT", "PART", "INSTANCE"].iter().any(|keyword| block.is(keyword))
                || GENERATING_KEYWORDS.iter().any(|keyword| block.is(keyword));
        let is_set = ["ELSET", "NSET", "SURFACE"].iter().any(|keyword| block.is(keyword));
        let own = match block.name("INPUT").filter(|_| block.is("INCLUDE")) {
            Some(name) => {
                let place = Inclusion { from: &source, at: block.at, name };
                included(mesh, place, false, seen, depth - 1)?
            }
            None if is_mesh => return Ok(Included::Mesh),
            None if is_set || is_section(block) => Included::Sets,
            None => Included::Other,
        };
        if own > found {
            found = own;
        }
    }
    Ok(found)
}

/// Returns whether a block is a section, such as `*SOLID SECTION`, which assigns a material to a set of elements.
fn is_section(block: &Block<'_>) -> bool {
    block.keyword.ends_with(b"SECTION") && block.name("ELSET").is_some()
}
