//! The mesh that a visitor builds from the items of a file.

use crate::content::constraints::Constraints;
use crate::content::faces::Faces;
use crate::content::remark::Remark;
use crate::edit::numbers::{CoordinateEncoding, EncodedArrays, Offsets};
use crate::format::Format;
use std::collections::HashSet;

/// Mesh of a file, with the encoding and the offsets of its coordinates.
pub(crate) struct ParsedMesh {
    pub(crate) format: Format,
    /// x and y of each vertex.
    pub(crate) points: Vec<[f64; 2]>,
    /// The vertices of each triangle.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Byte offset of each x in the file with the coordinates, ascending; in the decoded bytes if `encoded` is present.
    pub(crate) x_offsets: Offsets,
    /// The vertex of each offset in `x_offsets`; `None` if offset `i` belongs to vertex `i`.
    pub(crate) owners: Option<Vec<u32>>,
    /// Encoding of the coordinates.
    pub(crate) encoding: CoordinateEncoding,
    /// 0-based index of the file with the coordinates; the main file is 0, companions follow.
    pub(crate) file_index: usize,
    /// Encoded array of the points, if the file stores points in base64 or compressed.
    pub(crate) encoded: Option<Box<dyn EncodedArrays>>,
    /// The region of each triangle; `None` if all triangles have equal regions.
    pub(crate) regions: Option<Vec<u32>>,
    /// Name of the cell data that number the regions; `None` if the regions are entries of the format.
    pub(crate) region_array: Option<String>,
    /// Lines, points and periodic pairs of the file.
    pub(crate) constraints: Constraints,
    /// The vertices of each quadrilateral.
    pub(crate) quadrilaterals: Vec<[u32; 4]>,
    /// The region of each quadrilateral, by the numbers of the regions of triangles.
    pub(crate) quadrilateral_regions: Vec<u32>,
    /// Numbers of entries in the lists of constrained and of anchored vertices before those of quadrilaterals.
    pub(crate) beside_quadrilaterals: [usize; 2],
    /// The quadrilaterals and polygons of the file.
    pub(crate) other_faces: Faces,
    pub(crate) remarks: Vec<Remark>,
    /// Names of the arrays of real numbers on vertices besides x and y, each once.
    pub(crate) data: Vec<String>,
    /// Names of the arrays of one number for each cell, except those of regions, each once.
    pub(crate) cell_arrays: Vec<String>,
    /// Names among `cell_arrays` of data with a fraction, as far as the reader passed the numbers.
    pub(crate) fractional: HashSet<String>,
    /// Name of the cell data that mark ghosts; `None` if the reader has passed the ghosts of the file.
    pub(crate) ghost_array: Option<String>,
    /// Whether vertices have parameters on surfaces of a model (gmsh 4), which can be replaced.
    pub(crate) has_parameters: bool,
    /// Whether the file stores centers of faces or edges (UGRID).
    pub(crate) has_centers: bool,
    /// Whether points have third coordinates that differ.
    pub(crate) has_z: bool,
    /// Whether an array of data beside third coordinates has the name `z`.
    pub(crate) has_data_named_z: bool,
    /// Whether the file says that coordinates are longitude and latitude in degrees; `None` if it gives no unit.
    pub(crate) says_degrees: Option<bool>,
    /// Another array with bytes of the points, in messages; `None` if the points have bytes of their own.
    pub(crate) shared_with: Option<String>,
}

impl ParsedMesh {
    /// Lists the corners of each triangle, and then of each quadrilateral.
    pub(crate) fn elements(&self) -> impl Iterator<Item = &[u32]> + Clone {
        let triangles = self.triangles.iter().map(<[u32; 3]>::as_slice);
        triangles.chain(self.quadrilaterals.iter().map(<[u32; 4]>::as_slice))
    }

    /// Lists the region of each element in the order of [`elements`](Self::elements).
    pub(crate) fn element_regions(&self) -> impl Iterator<Item = u32> + Clone {
        let of_triangle = |t: usize| self.regions.as_ref().map_or(0, |regions| regions[t]);
        let of_triangles = (0..self.triangles.len()).map(of_triangle);
        of_triangles.chain(self.quadrilateral_regions.iter().copied())
    }
}
