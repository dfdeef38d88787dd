//! The choice of layers that a run keeps.

use std::collections::HashSet;
use std::str::FromStr;

use crate::error::MeshError;
use crate::layers::elements::Elements;
use crate::layers::result::Layers;

/// The layers that a run keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum KeepLayers {
    /// Layers that [`Elements::layers`] finds.
    #[default]
    Auto,
    /// None.
    None,
    /// The first rows above walls; see [`Elements::rows`].
    Rows(u32),
    /// The vertices within a distance of walls; see [`Elements::within`].
    Within(f64),
}

impl KeepLayers {
    /// Finds the layers whose vertices a run must keep in place: a caller lists the vertices in
    /// [`Mesh::fixed`](crate::Mesh::fixed). `walls` are the vertices of the walls above which layers are searched; `None`
    /// stands for all walls at which layers may begin. Vertices of inverted and flat triangles and of
    /// quadrilaterals that are not convex are left out, so that the elements can be untangled.
    ///
    /// # Errors
    /// Those of [`Elements::layers`].
    pub fn find(self, elements: &Elements<'_>, walls: Option<&[u32]>) -> Result<Layers, MeshError> {
        let mut layers = match self {
            Self::Auto => elements.layers(walls)?,
            Self::None => return Ok(Layers::default()),
            Self::Rows(count) => elements.rows(count as usize, walls)?,
            Self::Within(distance) => elements.within(distance, walls)?,
        };
        if layers.vertices.is_empty() && layers.sides.is_empty() {
            return Ok(layers);
        }
        let triangles = elements.topology.bad_triangles(elements.points)?;
        let quadrilaterals = elements.topology.bad_quadrilaterals(elements.points)?;
        if !triangles.is_empty() || !quadrilaterals.is_empty() {
            let of_triangles = triangles.iter().flat_map(|bad| bad.vertices);
            let bad: HashSet<u32> =
                of_triangles.chain(quadrilaterals.iter().flat_map(|bad| bad.vertices)).collect();
            layers.vertices.retain(|v| !bad.contains(v));
            layers.sides.retain(|v| !bad.contains(v));
        }
        Ok(layers)
    }
}

impl FromStr for KeepLayers {
    type Err = &'static str;

    /// Reads `auto`, `none`, `rows=N` with N from 1 to 1000, or `within=DISTANCE` with a positive distance.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let rows = |text: &str| text.parse().ok().filter(|n| (1..=1000).contains(n));
        let distance = |text: &str| text.parse().ok().filter(|d: &f64| *d > 0.0 && d.is_finite());
        match (text, text.split_once('=')) {
            ("auto", _) => Ok(Self::Auto),
            ("none", _) => Ok(Self::None),
            (_, Some(("rows", count))) => {
                rows(count).map(Self::Rows).ok_or("give a number of rows from 1 to 1000")
            }
            (_, Some(("within", size))) => {
                distance(size).map(Self::Within).ok_or("give a positive distance")
            }
            _ => Err("give auto, none, rows=N or within=DISTANCE"),
        }
    }
}
