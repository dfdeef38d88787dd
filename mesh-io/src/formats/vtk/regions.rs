//! Arrays of cell data that number the regions of a mesh, in VTK's formats and in XDMF.

use crate::content::remark::Remark;
use crate::text::token::quoted;
use crate::visit::records::Region;

/// Limit on the region arrays of a file. Further ones are read as plain cell data.
pub(crate) const MAX_ARRAYS: usize = 2;

/// Names of region arrays, in lower case. gmsh, meshio, VTK's own readers and solvers write them; solvers call regions
/// materials.
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

/// Returns whether cell data of this name, in any case, number regions.
pub(crate) fn names_regions(name: &[u8]) -> bool {
    NAMES.contains(&name.to_ascii_lowercase().as_slice())
}

/// Makes the remark that an array with a usual name of regions cannot be read.
pub(crate) fn unread_regions(name: &[u8]) -> Remark {
    Remark::Text(format!(
        "the cell data `{}` number no regions, as not all are finite numbers that can be read",
        quoted(name)
    ))
}

/// Region numbers of all cells of a list, array by array. A cell beyond the end of an array has the number 0.
pub(crate) struct RegionNumbers(Vec<Vec<i64>>);

impl FromIterator<Vec<i64>> for RegionNumbers {
    fn from_iter<I: IntoIterator<Item = Vec<i64>>>(arrays: I) -> RegionNumbers {
        RegionNumbers(arrays.into_iter().collect())
    }
}

impl RegionNumbers {
    /// Returns the region numbers of a cell; 0 for each array that the file lacks.
    pub(crate) fn of(&self, cell: usize) -> [i64; MAX_ARRAYS] {
        let number = |array| self.array(array)?.get(cell).copied();
        std::array::from_fn(|array| number(array).unwrap_or(0))
    }

    /// Returns the region numbers from a cell to the end of the list, for bulk visits of triangles.
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
