//! Arrays of cell data that tell the regions of cells, in VTK's formats and in XDMF.

use crate::visit::records::Region;

/// The most arrays of a file that tell regions.
pub(crate) const MAX_ARRAYS: usize = 2;

/// Names of arrays that tell the regions of cells, in lower case. They are those of gmsh and meshio, of VTK's own
/// readers, and of solvers, which call regions materials.
const NAMES: [&[u8]; 18] = [
    b"gmsh:physical",
    b"gmsh:geometrical",
    b"medit:ref",
    b"cell_tags",
    b"cellentityids",
    b"materialids",
    b"material",
    b"materials",
    b"material_id",
    b"elementblockids",
    b"blockid",
    b"region",
    b"regions",
    b"regionid",
    b"regionids",
    b"domain",
    b"subdomain",
    b"reference",
];

/// Whether an array of cell data with this name tells the regions of cells.
pub(crate) fn names_regions(name: &[u8]) -> bool {
    NAMES.contains(&name.to_ascii_lowercase().as_slice())
}

/// The numbers of cells in the arrays that tell their regions, array by array. Cells beyond the end of an array have the
/// number 0 there.
pub(crate) struct RegionNumbers(Vec<Vec<i64>>);

impl FromIterator<Vec<i64>> for RegionNumbers {
    fn from_iter<I: IntoIterator<Item = Vec<i64>>>(arrays: I) -> RegionNumbers {
        RegionNumbers(arrays.into_iter().collect())
    }
}

impl RegionNumbers {
    /// Returns the numbers of a cell. A number without an array is 0.
    pub(crate) fn of(&self, cell: usize) -> [i64; MAX_ARRAYS] {
        let number = |array| self.array(array)?.get(cell).copied();
        std::array::from_fn(|array| number(array).unwrap_or(0))
    }

    /// Returns the numbers of all cells from one on.
    pub(crate) fn from(&self, cell: usize) -> [Region<'_>; MAX_ARRAYS] {
        std::array::from_fn(|array| match self.array(array) {
            Some(numbers) => Region::List(numbers.get(cell..).unwrap_or_default()),
            None => Region::Same(0),
        })
    }

    fn array(&self, array: usize) -> Option<&[i64]> {
        self.0.get(array).map(Vec::as_slice)
    }
}
