//! Selects the blocks of an input file that describe the mesh: blocks of the model itself, or of the only part or
//! instance that contains elements.

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
    /// The scope of the mesh: the scope with elements, else the first scope with nodes, else [`MODEL`].
    pub(super) mesh: usize,
    /// Maps the name of an instance, in capital letters, to true if the instance holds the mesh or refers to the part
    /// that holds the mesh.
    instances: HashMap<Vec<u8>, bool>,
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
        let mut deck =
            Deck { blocks: Vec::new(), mesh: MODEL, instances: HashMap::new(), notes: Vec::new() };
        // The name of each scope, by number, for messages.
        let mut names = vec!["the model".to_owned(), "the assembly".to_owned()];
        let mut with_elements: Option<usize> = None;
        // For each instance: its name and the name of its part, both in capital letters, and its scope.
        let mut instances = Vec::new();
        let mut part_names = HashMap::new();
        let mut scope = MODEL;
        let mut first = None;
        for block in blocks {
            let name = |parameter| block.name(parameter).unwrap_or_default();
            match &block.keyword[..] {
                b"PART" | b"INSTANCE" => {
                    let (what, own) =
                        (if block.is("PART") { "part" } else { "instance" }, names.len());
                    names.push(format!("{what} {}", quoted(name("NAME"))));
                    let key = name("NAME").to_ascii_uppercase();
                    match block.is("PART") {
                        true => drop(part_names.insert(key, own)),
                        false => instances.push((key, name("PART").to_ascii_uppercase(), own)),
                    }
                    scope = own;
                }
                b"ENDPART" | b"ENDASSEMBLY" => scope = MODEL,
                b"ASSEMBLY" | b"ENDINSTANCE" => scope = ASSEMBLY,
                b"ELEMENT" if scope != ASSEMBLY => match with_elements {
                    Some(other) if other != scope => {
                        let [a, b] = [other, scope].map(|scope| &names[scope]);
                        let problem =
                            format!("{b} has elements beside {a}, each with numbers of its own");
                        let remedy = "Write the input file without parts and assemblies, or one part at a time";
                        return Err(block.error(source, problem, remedy));
                    }
                    _ => with_elements = Some(scope),
                },
                b"NODE" => first = first.or(Some(scope)),
                _ => {}
            }
            check(source, &block)?;
            deck.blocks.push((block, scope));
        }
        deck.mesh = with_elements.or(first).unwrap_or(MODEL);
        for (name, part, own) in instances {
            let is_of_mesh = own == deck.mesh || part_names.get(&part) == Some(&deck.mesh);
            deck.instances.insert(name, is_of_mesh);
        }
        deck.check_included(source)?;
        Ok(deck)
    }

    /// Lists the blocks of the mesh with the given keyword.
    pub(super) fn of_mesh(&self, keyword: &str) -> impl Iterator<Item = &Block<'a>> {
        let own = self.blocks.iter().filter(move |(block, scope)| {
            *scope == self.mesh && block.keyword == keyword.as_bytes()
        });
        own.map(|(block, _)| block)
    }

    /// Lists the blocks of the assembly with the given keyword; none if the file has no assembly.
    pub(super) fn of_assembly(&self, keyword: &str) -> impl Iterator<Item = &Block<'a>> {
        let own = self.blocks.iter().filter(move |(block, scope)| {
            *scope == ASSEMBLY && block.keyword == keyword.as_bytes()
        });
        own.map(|(block, _)| block)
    }

    /// Returns whether `instance`, in capital or small letters, names an instance of the mesh.
    pub(super) fn is_of_mesh(&self, instance: &[u8]) -> bool {
        self.instances.get(&instance.to_ascii_uppercase()) == Some(&true)
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
pub(super) fn is_section(block: &Block<'_>) -> bool {
    block.keyword.ends_with(b"SECTION") && block.name("ELSET").is_some()
}
