//! Sizes or tensors at the vertices of a mesh, read from a separate file: Medit's `.sol` or a metric file of BAMG.

use std::path::Path;

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::{float, quoted};

/// Numbers for the vertices of a mesh, in the order of the mesh file: for each vertex a size in the unit of the mesh,
/// or three components xx, xy, yy of a symmetric tensor.
#[derive(Clone, Debug, PartialEq)]
pub struct MeditSolution {
    components: usize,
    values: Vec<f64>,
}

impl MeditSolution {
    /// Reads a `.sol` file of Medit with one solution at vertices, or a metric file of BAMG. A metric file starts with
    /// the number of vertices and the number of components, 1 or 3. The components of each vertex follow.
    ///
    /// # Errors
    /// [`ReadError`] if the file cannot be read, or is in neither format.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let source = Source::load(path)?;
        let mut cursor = Cursor::new(&source);
        let is_medit = cursor.next_row() && cursor.is_at_letter();
        match is_medit {
            true => medit(cursor),
            false => bamg(Cursor::new(&source)),
        }
    }

    /// Returns the number of components per vertex: 1 for sizes, 3 for tensors.
    pub fn components(&self) -> usize {
        self.components
    }

    /// Returns the numbers of all vertices, [`components`](Self::components) for each vertex.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// The numbers by which `.sol` files name a scalar and a symmetric tensor. A vector is 2.
const SCALAR: u64 = 1;
const TENSOR: u64 = 3;

fn medit(mut cursor: Cursor<'_>) -> Result<MeditSolution, ReadError> {
    const REMEDY: &str = "Give a solution at the vertices of a mesh of two dimensions";
    loop {
        match cursor.token().unwrap_or_default() {
            b"MeshVersionFormatted" => {
                word(&mut cursor, "the version")?;
            }
            b"Dimension" => match word(&mut cursor, "the dimension")? {
                2 => {}
                other => {
                    let problem = format!("the solution is of a mesh of dimension {other}");
                    return Err(cursor.error(problem, REMEDY));
                }
            },
            b"SolAtVertices" => {
                let count = word(&mut cursor, "the number of vertices")?;
                let kinds = word(&mut cursor, "the number of solutions")?;
                if kinds != 1 {
                    let problem = format!("there are {kinds} solutions, not one");
                    return Err(cursor.error(problem, "Give a file with one of them"));
                }
                let components = match word(&mut cursor, "the kind of solution")? {
                    SCALAR => 1,
                    TENSOR => 3,
                    kind => {
                        let problem = format!("the solution is of kind {kind}");
                        let remedy = "Give one of kind 1, sizes, or 3, symmetric tensors";
                        return Err(cursor.error(problem, remedy));
                    }
                };
                return numbers(cursor, count, components);
            }
            _ => {}
        }
        if !cursor.next_word() {
            return Err(cursor.error("there is no SolAtVertices", REMEDY));
        }
    }
}

fn bamg(mut cursor: Cursor<'_>) -> Result<MeditSolution, ReadError> {
    let count = word(&mut cursor, "the number of vertices")?;
    match word(&mut cursor, "the number of numbers of a vertex")? {
        1 => numbers(cursor, count, 1),
        3 => numbers(cursor, count, 3),
        other => {
            let problem = format!("a vertex has {other} numbers, not 1, a size, or 3, a tensor");
            Err(cursor.error(problem, CORRECT))
        }
    }
}

/// The remedy if more numbers follow than the vertices need.
const COUNT: &str = "Correct the number of vertices, or remove the excess numbers";

/// Reads the next whole number, on the current row or a later row.
fn word(cursor: &mut Cursor<'_>, what: &str) -> Result<u64, ReadError> {
    cursor.next_word();
    cursor.integer(what)
}

/// Reads `components` numbers for each of `count` vertices. Keywords may follow, but no further number.
fn numbers(
    mut cursor: Cursor<'_>,
    count: u64,
    components: usize,
) -> Result<MeditSolution, ReadError> {
    let wanted = count.saturating_mul(components as u64);
    let mut values = Vec::with_capacity(cursor.capacity(wanted, 2));
    for i in 0..wanted {
        if !cursor.next_word() {
            let vertex = i / components as u64;
            let problem = format!("the file ends after {vertex} of {count} vertices");
            return Err(cursor.error(problem, crate::text::cursor::CUT_OFF));
        }
        values.push(cursor.real("a value")?);
    }
    if cursor.next_word()
        && let Some(word) = cursor.clone().token().filter(|word| float(word).is_some())
    {
        let all = if components == 1 { "one number" } else { "three numbers" };
        let problem =
            format!("`{}` follows after {all} for each of {count} vertices", quoted(word));
        return Err(cursor.error(problem, COUNT));
    }
    Ok(MeditSolution { components, values })
}
