//! Targets of places, on a mesh of their own.

use crate::error::MeshError;
use crate::interpolate::Background;
use crate::mesh::Mesh;
use crate::parallel::collect;
use crate::targets::Targets;
use crate::targets::tensor::Tensor;

/// What elements are to look like at each place: targets at the vertices of some mesh, which may be the one that is smoothed or
/// another, and in its triangles linear in their logarithms. Outside of the mesh, the target is that of its nearest place.
///
/// ```
/// use gpu_smooth::{Mesh, TargetField, Targets};
///
/// // Elements on the right are to be four times as large as on the left; in the middle twice.
/// let points = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]];
/// let background = Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]], fixed: vec![] };
/// let field = TargetField::new(&background, &Targets::sizes(&[1.0, 4.0, 4.0, 1.0])?)?;
/// let (targets, outside) = field.at(&[[0.0, 0.5], [2.0, 0.5]])?;
/// assert_eq!(outside.count, 0);
/// # Ok::<(), gpu_smooth::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct TargetField {
    background: Background,
    /// The logarithm of the target map of each vertex of the background.
    logarithms: Vec<Tensor>,
}

/// The places that are not within the mesh of a [`TargetField`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outside {
    /// How many there are, but for those that rounding may have put there.
    pub count: usize,
    /// The largest distance, in the unit of the mesh.
    pub most: f64,
}

impl TargetField {
    /// A field on a mesh, by targets for its vertices.
    ///
    /// # Errors
    /// [`MeshError::ValueCount`] if there is not one target for each vertex, those of [`Topology::new`](crate::Topology::new), and
    /// [`MeshError::Infeasible`] if triangles of the mesh are inverted or flat.
    pub fn new(mesh: &Mesh, targets: &Targets) -> Result<Self, MeshError> {
        targets.check_count(mesh.points.len())?;
        let maps = targets.maps();
        let logarithms = collect(maps.len(), |v| maps[v].ln());
        Ok(Self { background: Background::new(mesh)?, logarithms })
    }

    /// The targets of these places.
    ///
    /// # Errors
    /// [`MeshError::NotFinite`] for a place that is not finite.
    pub fn at(&self, places: &[[f64; 2]]) -> Result<(Targets, Outside), MeshError> {
        let spots = self.background.find(places)?;
        let map = |i: usize| {
            let value =
                |k: usize| self.background.value(&spots[i], |v| self.logarithms[v as usize].0[k]);
            Tensor([0, 1, 2].map(value)).exp()
        };
        let maps = collect(spots.len(), map);
        let rounding = 1e-9 * self.background.extent();
        let far = spots.iter().map(|spot| spot.outside).filter(|outside| *outside > rounding);
        let outside = far.fold(Outside::default(), |all, outside| Outside {
            count: all.count + 1,
            most: all.most.max(outside),
        });
        Ok((Targets::of_maps(maps), outside))
    }
}
