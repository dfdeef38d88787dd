//! Targets as a function of position, given on a background mesh.

use crate::error::MeshError;
use crate::interpolate::{Background, Spot};
use crate::mesh::Mesh;
use crate::parallel::collect;
use crate::targets::Targets;
use crate::targets::surface::Surface;
use crate::targets::tensor::Tensor;

/// Targets of elements at each point of the plane. Targets are given at the vertices of a background mesh, the smoothed
/// mesh or another. Logarithms of the targets are interpolated linearly in the triangles of the background. Points
/// outside of the background have the target of its nearest point.
///
/// ```
/// use gpu_smooth::{Mesh, TargetField, Targets};
///
/// // Elements on the right are to be four times as large as on the left; in the middle twice.
/// let points = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]];
/// let background = Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
/// let field = TargetField::new(&background, &Targets::sizes(&[1.0, 4.0, 4.0, 1.0])?)?;
/// let (targets, outside) = field.at(&[[0.0, 0.5], [2.0, 0.5]])?;
/// assert_eq!(outside.count, 0);
/// # Ok::<(), gpu_smooth::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct TargetField {
    background: Background,
    /// Logarithm of the target map at each vertex of the background.
    logarithms: Vec<Tensor>,
    size_weight: f64,
    /// Surface on which targets are lengths; [`Surface::Plane`] if targets are in coordinates.
    surface: Surface,
}

/// A full turn, in degrees.
const TURN: f64 = 360.0;

/// Summary of the points that are outside of the mesh of a [`TargetField`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutsideReport {
    /// Number of points outside, not counting points that rounding may have moved there.
    pub count: usize,
    /// Largest distance of a point from the mesh, in the unit of the mesh.
    pub most: f64,
}

impl TargetField {
    /// Makes a field from a background mesh and the targets of its vertices.
    ///
    /// # Errors
    /// [`MeshError::ValueCount`] if `targets` does not have one target per vertex, [`MeshError::Infeasible`] if
    /// triangles of the mesh are inverted or flat, or an error of [`Topology::new`](crate::Topology::new).
    pub fn new(mesh: &Mesh, targets: &Targets) -> Result<Self, MeshError> {
        targets.check_count(mesh.points.len())?;
        let maps = targets.maps();
        let logarithms = collect(maps.len(), |v| maps[v].ln());
        let (background, size_weight) = (Background::new(mesh)?, targets.size_weight());
        Ok(Self { background, logarithms, size_weight, surface: Surface::Plane })
    }

    /// Converts the field to coordinates on a surface: lengths on the surface become lengths in its coordinates at each
    /// point. Longitudes that differ by whole turns denote equal points. A mesh and the background of its targets may
    /// therefore use different ranges of longitudes, and may be continued across the line where longitudes jump, as by
    /// a [`Chart`](crate::front_ends::Chart). Do not convert targets already given in coordinates, by
    /// [`Targets::seen_on`] or otherwise.
    pub fn seen_on(self, surface: Surface) -> Self {
        Self { surface, ..self }
    }

    /// Locates points in the background. Among longitudes that differ by whole turns, the longitude inside or nearest
    /// to the background is used.
    fn find(&self, places: &[[f64; 2]]) -> Result<Vec<Spot>, MeshError> {
        if self.surface == Surface::Plane {
            return self.background.find(places);
        }
        let [west, east] = self.background.breadth();
        // Distance between a longitude and the range of longitudes of the background: a lower bound on the distance of
        // the point, known before the point is located.
        let apart = |x: f64| (west - x).max(x - east).max(0.0);
        let turned = |i: usize| {
            let [x, y] = places[i];
            // A point within the background's range of longitudes is first located there, unchanged.
            let east_of_west = x + TURN * ((west - x) / TURN).ceil();
            let mut turns = [x, east_of_west, east_of_west - TURN, east_of_west + TURN];
            turns.sort_by(|a, b| apart(*a).total_cmp(&apart(*b)));
            turns.map(|x| [x, y])
        };
        let turned = collect(places.len(), turned);
        let mut spots = self.background.find(&turned.iter().map(|t| t[0]).collect::<Vec<_>>())?;
        let rounding = self.rounding();
        for next in 1..4 {
            let may_be_nearer = |&i: &usize| {
                let [before, turn] = [next - 1, next].map(|k| turned[i][k][0]);
                let outside = spots[i].outside;
                outside > rounding && apart(turn) < outside && turn != before
            };
            let left: Vec<usize> = (0..places.len()).filter(may_be_nearer).collect();
            let others: Vec<[f64; 2]> = left.iter().map(|&i| turned[i][next]).collect();
            for (i, spot) in left.into_iter().zip(self.background.find(&others)?) {
                if spot.outside < spots[i].outside {
                    spots[i] = spot;
                }
            }
        }
        Ok(spots)
    }

    /// Returns all data as words, from whose hash a checkpoint recognizes the field of its run.
    pub(crate) fn words(&self) -> Vec<u64> {
        let Self { background, logarithms, surface, .. } = self;
        let mut words = background.words();
        words.extend(logarithms.iter().flat_map(|tensor| &tensor.0).map(|x| x.to_bits()));
        words.push((*surface == Surface::Plane).into());
        words
    }

    /// Returns the largest distance by which rounding may move a point out of the background.
    fn rounding(&self) -> f64 {
        1e-9 * self.background.extent()
    }

    /// Returns the targets at the given points, and a summary of the points outside of the field's background.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] if a coordinate of a point is infinite or NaN. The error's `vertex` is the index of the
    /// point in `places`. [`MeshError::OutOfRange`] if a coordinate exceeds 1e100.
    pub fn at(&self, places: &[[f64; 2]]) -> Result<(Targets, OutsideReport), MeshError> {
        let spots = self.find(places)?;
        let map = |i: usize| {
            let value =
                |k: usize| self.background.value(&spots[i], |v| self.logarithms[v as usize].0[k]);
            let map = Tensor([0, 1, 2].map(value)).exp();
            match self.surface {
                Surface::Plane => map,
                surface => map.squared().stretched(surface.lengths(places[i][1])).sqrt(),
            }
        };
        let maps = collect(spots.len(), map);
        let rounding = self.rounding();
        let far = spots.iter().map(|spot| spot.outside).filter(|outside| *outside > rounding);
        let outside = far.fold(OutsideReport::default(), |all, outside| OutsideReport {
            count: all.count + 1,
            most: all.most.max(outside),
        });
        Ok((Targets { maps, size_weight: self.size_weight }, outside))
    }
}
