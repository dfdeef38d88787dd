//! Comparison of two mesh files, to prove that they differ only by moved vertices.

use crate::load::LoadedMesh;
use gpu_smooth::{
    MeshError, Slide, Topology,
    topology::{BadQuadrilateral, BadTriangle},
};
use mesh_io::Difference;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;

use crate::load::InterpolatedFields;
use crate::report::FileHash;

/// Largest number of listed vertices, of listed triangles, and of listed quadrilaterals.
const LISTED: usize = 10;

/// Result of comparing two mesh files. The result depends on the files alone, not on data of a run.
pub(crate) struct Proof {
    /// The first difference outside of coordinates and interpolated data; `None` if there is none.
    pub(crate) difference: Option<Difference>,
    /// Vertices whose coordinates differ in any bit, ascending.
    pub(crate) moved: Vec<u32>,
    /// Moved vertices that are not free, and vertices that left the plane of the mesh, ascending. With sliding, only
    /// vertices that left their line or plane.
    pub(crate) held: Vec<u32>,
    /// Number of vertices that slid along their line.
    pub(crate) slid: usize,
    /// Number of periodic pairs whose vertices slid together.
    pub(crate) pairs: usize,
    /// Number of pairs of vertices at the same place that slid together.
    pub(crate) coincident: usize,
    /// Inverted or flat triangles of the second file, by exact predicates.
    pub(crate) bad: Vec<BadTriangle>,
    /// Corners of quadrilaterals of the second file that are not convex, by exact predicates. Empty unless vertices of
    /// quadrilaterals may move.
    pub(crate) concave: Vec<BadQuadrilateral>,
}

/// A mesh before or after a run, with its interpolated fields.
#[derive(Clone, Copy)]
pub(crate) struct MeshVersion<'a> {
    pub(crate) file: &'a LoadedMesh,
    pub(crate) fields: &'a InterpolatedFields,
}

impl Proof {
    /// Compares two files of a mesh. The first file determines the movable vertices, `slide` the sliding ones.
    pub(crate) fn of(
        before: MeshVersion<'_>,
        after: MeshVersion<'_>,
        slide: Option<&Slide>,
    ) -> Result<Self, MeshError> {
        let fields = [before.fields, after.fields].map(InterpolatedFields::fields);
        let (before, after) = (before.file, after.file);
        let difference = before.source.difference_ignoring(&after.source, fields);
        Self::of_points(before, after, &before.mesh().points, difference, slide)
    }

    /// Compares a mesh with a file in another format or encoding, to which the mesh was converted, by positions and
    /// elements. Vertices that have moved by no more than the rounding of the other format stay.
    pub(crate) fn of_conversion(
        before: &LoadedMesh,
        after: &LoadedMesh,
        slide: Option<&Slide>,
    ) -> Result<Self, MeshError> {
        let difference = before.source.difference_of_elements(&after.source);
        let precision = after.source.precision();
        let rounded = |point: &[f64; 2]| point.map(|x| precision.rounded(x));
        let old: Vec<[f64; 2]> = before.mesh().points.iter().map(rounded).collect();
        Self::of_points(before, after, &old, difference, slide)
    }

    /// Compares the positions of two files of a mesh, unless they have a `difference`. `old` holds the points of `before`, as
    /// the second file stores them.
    fn of_points(
        before: &LoadedMesh,
        after: &LoadedMesh,
        old: &[[f64; 2]],
        difference: Option<Difference>,
        slide: Option<&Slide>,
    ) -> Result<Self, MeshError> {
        let (mut moved, mut held) = (Vec::new(), Vec::new());
        let (mut bad, mut concave) = (Vec::new(), Vec::new());
        let (mut slid, mut pairs, mut coincident) = (0, 0, 0);
        if difference.is_none() {
            let topology = Topology::new(before.mesh())?;
            let new = &after.mesh().points;
            let bits = |point: &[f64; 2]| point.map(f64::to_bits);
            let differ = |&(_, (old, new)): &(u32, (&[f64; 2], &[f64; 2]))| bits(old) != bits(new);
            moved = (0..).zip(old.iter().zip(new)).filter(differ).map(|(v, _)| v).collect();
            let strays = match (before.plane(), after.plane()) {
                (Some(plane), Some(other)) => plane.strays(other),
                _ => Vec::new(),
            };
            held = moved.iter().copied().filter(|&v| !topology.free()[v as usize]).collect();
            if let Some(slide) = slide {
                let rounding = |size: f64| before.rounding(size).max(after.rounding(size));
                let misplaced = slide.misplaced_within(&topology, old, new, &rounding);
                slid = held.len() - misplaced.len();
                held.retain(|v| misplaced.binary_search(v).is_err());
                pairs = pairs_among(slide, &held);
                coincident = coincident_among(old, &held);
                held = misplaced;
            }
            held.extend(strays);
            held.sort_unstable();
            held.dedup();
            let of = |topology: &Topology<'_>| -> Result<_, MeshError> {
                Ok((topology.bad_triangles(new)?, topology.bad_quadrilaterals(new)?))
            };
            (bad, concave) = of(&topology)?;
            if !bad.is_empty() || !concave.is_empty() {
                // If more than half of the elements were inverted before, the windings derived from `before` are reversed.
                (bad, concave) = of(&Topology::new(after.mesh())?)?;
            }
        }
        Ok(Self { difference, moved, held, slid, pairs, coincident, bad, concave })
    }

    /// Returns a sentence on the problems found; `None` if the proof succeeds.
    pub(crate) fn problem(&self) -> Option<String> {
        if let Some(Difference { location, other_location, description }) = &self.difference {
            return Some(format!(
                "{location} and {other_location}: the files differ in more than coordinates: {description}"
            ));
        }
        let mut problems = Vec::new();
        match self.held.len() {
            0 => {}
            1 => problems.push("1 vertex has moved that must not".to_owned()),
            count => problems.push(format!("{count} vertices have moved that must not")),
        }
        match self.bad.len() {
            0 => {}
            1 => problems.push("1 triangle is inverted or flat".to_owned()),
            count => problems.push(format!("{count} triangles are inverted or flat")),
        }
        match self.concave.len() {
            0 => {}
            1 => problems.push("1 corner of a quadrilateral is not convex".to_owned()),
            count => problems.push(format!("{count} corners of quadrilaterals are not convex")),
        }
        (!problems.is_empty()).then(|| problems.join(", "))
    }

    /// Lists the vertices, triangles and quadrilaterals of the problems, by their places in the second file.
    pub(crate) fn places(&self, after: &LoadedMesh) -> Vec<String> {
        let Self { held, bad, concave, .. } = self;
        let mut list = Vec::new();
        for place in after.vertex_places(held.iter().copied().take(LISTED)).values() {
            list.push(format!("{place}: vertex {}", place.id));
        }
        let triangles = bad.iter().map(|bad| bad.triangle).take(LISTED);
        for place in after.source.triangle_locations(triangles).values() {
            list.push(format!("{place}: triangle {}", place.id));
        }
        let concave = concave.iter().map(|bad| bad.quadrilateral).take(LISTED);
        for place in after.source.quadrilateral_locations(concave).values() {
            list.push(format!("{place}: quadrilateral {}", place.id));
        }
        list
    }
}

/// Counts the periodic pairs with both vertices in `vertices`, which must be ascending.
fn pairs_among(slide: &Slide, vertices: &[u32]) -> usize {
    let has = |v: &u32| vertices.binary_search(v).is_ok();
    let all = slide.periodic.iter().flat_map(|periodic| &periodic.pairs);
    let among = all.filter(|pair| pair.iter().all(has));
    among.map(|&[a, b]| [a.min(b), a.max(b)]).collect::<BTreeSet<_>>().len()
}

/// Counts the vertices with the position of an earlier vertex of the list.
fn coincident_among(points: &[[f64; 2]], vertices: &[u32]) -> usize {
    // A sum with zero turns -0 into 0.
    let place = |&v: &u32| points[v as usize].map(|x| (x + 0.0).to_bits());
    vertices.len() - vertices.iter().map(place).collect::<BTreeSet<_>>().len()
}

/// Returns the hash of each file of a mesh, computed from the bytes that were read.
pub(crate) fn hashes(file: &LoadedMesh) -> Vec<FileHash> {
    let hash = |(path, bytes): (&std::path::Path, &[u8])| {
        let hex = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        FileHash { path: path.display().to_string(), sha256: hex }
    };
    file.source.contents().map(hash).collect()
}
