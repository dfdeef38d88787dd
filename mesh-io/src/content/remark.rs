//! Remarks on a mesh file.

use std::fmt;

/// Fact about a mesh file for the user of the mesh. [`Display`](fmt::Display) states the fact in one line.
///
/// This crate does not decide which vertices move. Programs may word every variant except `Text` by their treatment of
/// the vertices.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remark {
    /// The file has elements other than triangles, or ghosts of other pieces of the mesh, whose vertices are among
    /// [`Constraints::vertices`](crate::Constraints::vertices).
    OtherElements {
        /// Number of the elements.
        count: u64,
        /// Name of the elements, in the plural if `count` is not 1: `quadrilaterals`, `segment of la.poly`.
        name: String,
    },
    /// All vertices lie on points or curves of the model (gmsh 4), and are therefore among
    /// [`Constraints::vertices`](crate::Constraints::vertices).
    AllOnModelCurves,
    /// Periodic pairs name nodes that the file does not list. The vertex of a listed partner is among
    /// [`Constraints::anchored`](crate::Constraints::anchored).
    UnlistedPairs {
        /// Number of pairs with an unlisted node.
        count: u64,
        /// The name of the file's list of nodes, such as `$Nodes`.
        list: String,
    },
    /// The regions of the elements are those of cell data under a name that is not usual for regions.
    RegionArray {
        /// Name of the array.
        array: String,
        /// Names of further arrays that look like regions, in file order.
        others: Vec<String>,
    },
    /// The regions of the elements are those of the format, or of cell data under a usual name. Cell data under other
    /// names, which look like regions too, divide these regions further.
    FurtherRegionArrays(Vec<String>),
    /// Numbers in the place of regions differ for nearly every element. The numbers count elements, and are neither regions
    /// nor groups.
    CountedElements,
    /// The file lists edges and no faces (UGRID and nets of Delft3D FM), so cells were found from the edges. An island of
    /// three to six edges counts as a cell.
    CellsOfEdges {
        /// Number of cells of four to six edges with a triangle at each edge, which may be islands.
        islands: u64,
    },
    /// The file says that coordinates are longitude and latitude in degrees (UGRID).
    Degrees,
    /// Any other fact, as a sentence.
    Text(String),
}

impl Remark {
    /// Makes the remark that a file has `count` elements. `name` is their name in the singular; `of` follows the name.
    pub(crate) fn elements(count: u64, name: &str, of: &str) -> Remark {
        let s = if count == 1 { "" } else { "s" };
        Remark::OtherElements { count, name: format!("{name}{s}{of}") }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Remark::OtherElements { count, name } => write!(f, "{count} {name}"),
            Remark::AllOnModelCurves => {
                write!(f, "every vertex lies on a point or curve of the model")
            }
            Remark::UnlistedPairs { count, list } => {
                write!(f, "periodic pairs that name a node which {list} does not list: {count}")
            }
            Remark::RegionArray { array, .. } => {
                write!(f, "the cell data `{array}` number the regions")
            }
            Remark::FurtherRegionArrays(names) => {
                write!(f, "the cell data `{}` divide the regions further", names.join("`, `"))
            }
            Remark::CountedElements => f.write_str(
                "numbers that differ for nearly every element count elements, and are no regions",
            ),
            Remark::CellsOfEdges { islands } => {
                f.write_str("cells were found from edges, as the file lists no faces, and an island of three to six edges counts as a cell")?;
                match islands {
                    0 => Ok(()),
                    1 => f.write_str(": 1 cell among triangles alone may be an island"),
                    n => write!(f, ": {n} cells among triangles alone may be islands"),
                }
            }
            Remark::Degrees => f.write_str("coordinates are longitude and latitude in degrees"),
            Remark::Text(text) => f.write_str(text),
        }
    }
}
