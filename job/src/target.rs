//! The desired shape and size of elements, by the words of all front ends.

use gpu_smooth::front_ends::Chart;
use gpu_smooth::targets::{OutsideReport, Surface};
use gpu_smooth::{Mesh, MeshError, Metric, Smoother, TargetField, Targets};

/// The desired shape and size of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TargetKind {
    /// Equilateral, of any size.
    Equilateral,
    /// Equilateral, of the present sizes.
    KeepSize,
    /// Of the present size, stretching and orientation.
    KeepShape,
    /// Equilateral, of a given size for each vertex.
    Sizes,
    /// Equilateral under a given tensor (xx, xy, yy) for each vertex.
    Tensors,
}

impl TargetKind {
    /// Returns the name of the kind: `equilateral`, `keep-size`, `keep-shape`, `size` or `metric`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Equilateral => "equilateral",
            Self::KeepSize => "keep-size",
            Self::KeepShape => "keep-shape",
            Self::Sizes => "size",
            Self::Tensors => "metric",
        }
    }

    /// Returns whether the target keeps sizes or shapes of the mesh itself.
    pub fn keeps(self) -> bool {
        matches!(self, Self::KeepSize | Self::KeepShape)
    }

    /// Returns the metric of a run without a scheme. A metric of shapes alone would ignore targets of sizes.
    pub fn default_metric(self) -> Metric {
        match self {
            Self::KeepSize => Metric::Tmop94,
            Self::Sizes => Metric::SoftSize,
            Self::Equilateral | Self::KeepShape | Self::Tensors => Metric::Imr,
        }
    }

    /// Returns the usual number of rings of neighbors over which kept sizes or shapes are averaged.
    pub fn default_rings(self) -> u32 {
        if self == Self::KeepSize { 0 } else { 1 }
    }

    /// Returns whether the target has sizes but no shapes. A metric that sees no sizes would ignore such a target.
    pub fn is_of_sizes(self) -> bool {
        matches!(self, Self::KeepSize | Self::Sizes)
    }

    /// Returns the count of given numbers for each vertex; 0 for targets without given numbers.
    pub fn components(self) -> usize {
        match self {
            Self::Sizes => 1,
            Self::Tensors => 3,
            Self::Equilateral | Self::KeepSize | Self::KeepShape => 0,
        }
    }

    /// Makes targets from [`components`](Self::components) given numbers for each vertex, in the order of the vertices.
    ///
    /// # Errors
    /// [`MeshError::Target`] if a size is not positive or a tensor not positive definite, or if the target has no numbers.
    pub fn of_numbers(self, numbers: &[f64]) -> Result<Targets, MeshError> {
        match self {
            Self::Tensors => Targets::tensors(numbers.as_chunks().0),
            _ => Targets::sizes(numbers),
        }
    }

    /// Makes the field of targets on a background mesh from given numbers for its vertices. The numbers are lengths on
    /// `surface`.
    ///
    /// # Errors
    /// The errors of [`of_numbers`](Self::of_numbers) and of [`TargetField::new`].
    pub fn field(
        self,
        background: &Mesh,
        numbers: &[f64],
        surface: Surface,
    ) -> Result<TargetField, MeshError> {
        let field = TargetField::new(background, &self.of_numbers(numbers)?)?;
        Ok(field.seen_on(surface))
    }
}

/// The source of the numbers of a target.
#[derive(Debug)]
#[non_exhaustive]
pub enum TargetSource {
    /// The mesh itself, or no numbers.
    Mesh,
    /// [`TargetKind::components`] numbers for each vertex of the mesh, without the copies of a chart.
    Vertices(Vec<f64>),
    /// A background mesh or view; see [`TargetKind::field`].
    Background(Box<TargetField>),
}

/// The targets of a run.
#[derive(Debug)]
pub struct TargetRequest {
    /// The desired shape and size of elements.
    pub kind: TargetKind,
    /// The source of given sizes or tensors.
    pub source: TargetSource,
    /// The number of rings of neighbors over which kept sizes or shapes are averaged; `None` for the usual number.
    pub rings: Option<u32>,
    /// Whether targets belong to places, and are evaluated again at the new positions of vertices. `None` stands for targets of
    /// places on a background, and of vertices otherwise.
    pub of_places: Option<bool>,
    /// The surface on which sizes are lengths.
    pub surface: Surface,
}

impl Default for TargetRequest {
    fn default() -> Self {
        let (kind, source) = (TargetKind::Equilateral, TargetSource::Mesh);
        Self { kind, source, rings: None, of_places: None, surface: Surface::Plane }
    }
}

/// Facts about the targets of a smoother.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct TargetFacts {
    /// The vertices outside of the background; `None` without a background.
    pub outside: Option<OutsideReport>,
    /// Factor of the term of size in the base metric; `None` for targets other than [`TargetKind::KeepSize`], and for metrics
    /// without this factor.
    pub size_weight: Option<f64>,
}

impl TargetRequest {
    /// Returns whether targets belong to places.
    pub fn is_of_places(&self) -> bool {
        let is_background = matches!(self.source, TargetSource::Background(_));
        self.kind != TargetKind::Equilateral && self.of_places.unwrap_or(is_background)
    }

    /// Sets the targets of a smoother, for a run with the base metric `metric`. The mesh of the smoother is that of `chart` if
    /// longitudes are continued. A mesh on a sphere must have its projection.
    ///
    /// # Errors
    /// [`MeshError`] if a number is no valid size or part of a tensor, or if the count of numbers does not fit the vertices.
    pub fn set(
        self,
        smoother: &mut Smoother<'_>,
        chart: Option<&Chart>,
        metric: Metric,
    ) -> Result<TargetFacts, MeshError> {
        let is_of_places = self.is_of_places();
        if let TargetSource::Background(field) = self.source {
            let outside = match is_of_places {
                true => smoother.set_target_field(*field)?,
                false => {
                    let (targets, outside) = field.at(&smoother.mesh().points)?;
                    smoother.set_targets(&targets)?;
                    outside
                }
            };
            return Ok(TargetFacts { outside: Some(outside), size_weight: None });
        }
        let Some(targets) = self.targets(smoother, chart)? else {
            return Ok(TargetFacts::default());
        };
        // Shapes are kept as they appear in coordinates, also on the sphere.
        let is_shape = self.kind == TargetKind::KeepShape;
        let surface = if is_shape { Surface::Plane } else { self.surface };
        let has_weight = self.kind == TargetKind::KeepSize && metric.has_size_weight();
        let size_weight = has_weight.then(|| targets.size_weight());
        if is_of_places {
            let mesh = Mesh { fixed: Vec::new(), ..smoother.mesh().clone() };
            let field = TargetField::new(&mesh, &targets)?.seen_on(surface);
            smoother.set_target_field(field)?;
        } else {
            let (points, topology) = (&smoother.mesh().points, smoother.topology());
            let targets = targets.seen_on(surface, points, topology.corners())?;
            smoother.set_targets(&targets)?;
        }
        Ok(TargetFacts { outside: None, size_weight })
    }

    /// Returns the targets of the vertices; `None` for equilateral targets in the plane.
    fn targets(
        &self,
        smoother: &Smoother<'_>,
        chart: Option<&Chart>,
    ) -> Result<Option<Targets>, MeshError> {
        let (topology, points) = (smoother.topology(), &smoother.mesh().points);
        let rings = self.rings.unwrap_or(self.kind.default_rings());
        let targets = match (self.kind, &self.source) {
            (TargetKind::Equilateral, _) if self.surface == Surface::Plane => return Ok(None),
            (TargetKind::Equilateral, _) => Targets::equilateral(points.len()),
            (TargetKind::KeepSize, _) => Targets::keep_size(topology, points, self.surface, rings)?,
            (TargetKind::KeepShape, _) => Targets::keep_shape(topology, points, rings)?,
            (kind, TargetSource::Vertices(numbers)) => match chart {
                Some(chart) => kind.of_numbers(&chart.extended(numbers, kind.components()))?,
                None => kind.of_numbers(numbers)?,
            },
            (kind, _) => kind.of_numbers(&[])?,
        };
        Ok(Some(targets))
    }
}
