//! The layout of an application's vertex buffer, and its coordinates.

use glam::DVec2;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::size::ALIGNMENT;
use crate::gpu::embed::window::Window;
use crate::layout::Problem;
use crate::parallel::pace::now;
use crate::topology::predicates::not_positive;

/// The layout and coordinates of an application's vertex buffer: x and y of vertex i are two f32 from byte `i * stride`
/// of a slice on. [`new`](Self::new) sets slice and stride; all other values have defaults.
///
/// Data behind y within the stride, such as a z, are neither read nor written.
#[derive(Clone, Copy, Debug)]
pub struct VertexBuffer<'a> {
    pub(crate) slice: wgpu::BufferSlice<'a>,
    pub(crate) stride: u64,
    origin: [f64; 2],
    scale: f64,
    is_projected: bool,
}

impl<'a> VertexBuffer<'a> {
    /// Describes vertices from the start of `slice` on, which is at a multiple of 4 bytes. The buffer needs the usage
    /// `STORAGE` in addition to the application's usages. `stride` is the distance between successive vertices in bytes: a
    /// multiple of 4, at least 8. Binding calls check both values.
    pub fn new(slice: wgpu::BufferSlice<'a>, stride: u64) -> Self {
        Self { slice, stride, origin: [0.0; 2], scale: 1.0, is_projected: false }
    }

    /// Sets the point of the mesh, in its unit, that becomes 0, 0 in the buffer: (0, 0) by default. Coordinates far
    /// from the origin have few digits in an f32: a mesh of a town, in meters of a country's grid, needs an origin in
    /// the town.
    pub fn origin(self, origin: [f64; 2]) -> Self {
        Self { origin, ..self }
    }

    /// Sets the factor, above 0, by which differences from the origin are multiplied in the buffer: 1 by default.
    pub fn scale(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Declares that the buffer has coordinates of the Mercator projection, in which vertices of a mesh on the sphere move
    /// ([`Smoother::project_from_sphere`](crate::Smoother::project_from_sphere)). x is the longitude λ in degrees, and y
    /// is asinh(tan φ) · 180/π for the latitude φ. The latitude at y is atan(sinh(y · π/180)). The origin is in these
    /// coordinates too.
    ///
    /// A device has no functions that convert to longitude and latitude with enough digits. So a mesh on the sphere takes
    /// only buffers with this declaration, and other meshes only buffers without it.
    /// [`DeviceMesh::read_points`](crate::gpu::DeviceMesh::read_points) returns longitudes and latitudes.
    pub fn in_mercator_projection(self) -> Self {
        Self { is_projected: true, ..self }
    }

    /// Returns the `max_storage_buffer_binding_size`, in bytes, that a device needs to bind the coordinates of this
    /// many vertices, for [`Gpu::required_limits`](crate::gpu::Gpu::required_limits). The vertices begin at byte `offset` of
    /// the buffer. If a buffer holds several meshes, only the vertices of this mesh are bound, so `offset` matters only
    /// modulo 256. If the size overflows, returns [`u64::MAX`].
    pub fn binding_size(vertices: usize, stride: u64, offset: u64) -> u64 {
        // A binding starts at a multiple of the device's alignment, at most 256 bytes.
        (vertices.saturating_sub(1) as u64)
            .saturating_mul(stride)
            .saturating_add(8 + offset % ALIGNMENT)
    }

    /// Returns the coordinate system of the buffer, after a check of the problem's triangles in single precision.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] under the conditions of [`unjudged_coordinates`](Self::unjudged_coordinates), or if rounding to
    /// single precision would invert or flatten a triangle of the problem.
    pub(crate) fn coordinates(&self, problem: &Problem) -> Result<Coordinates, GpuError> {
        let given = self.unjudged_coordinates(problem)?;
        let (center, size) = problem.normalization();
        let bad = match given.inverted_by_rounding(problem) {
            Some(0) => return Ok(given),
            bad => bad,
        };
        let problem_text = match bad {
            None => "coordinates leave the range of single precision".to_owned(),
            Some(1) => "1 triangle would be inverted or flat in single precision".to_owned(),
            Some(bad) => format!("{bad} triangles would be inverted or flat in single precision"),
        };
        let [x, y] = center.to_array();
        let centered = Coordinates { center: DVec2::ZERO, scale: size / self.scale };
        let remedy = match (bad, centered.inverted_by_rounding(problem)) {
            (None, _) => "set a scale".to_owned(),
            (_, Some(0)) => format!("set an origin in the mesh, such as {x}, {y}"),
            _ => "single precision has too few digits for this mesh, wherever the origin is"
                .to_owned(),
        };
        Err(GpuError::Buffer(format!("{problem_text}: {remedy}")))
    }

    /// Returns the coordinate system of the buffer, even if rounding inverts triangles of the problem.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] unless the origin is finite, the scale is positive and finite, and the buffer has coordinates
    /// of the projection exactly if the vertices of the problem move in the projection.
    pub(crate) fn unjudged_coordinates(&self, problem: &Problem) -> Result<Coordinates, GpuError> {
        let refuse = |problem: String| Err(GpuError::Buffer(problem));
        let Self { origin, scale, is_projected, .. } = *self;
        match (problem.is_projected(), is_projected) {
            (true, false) => return refuse(
                "the vertices move in the Mercator projection of the sphere, and a device does not convert them to longitude \
                 and latitude: fill the buffer with coordinates of the projection and declare them by \
                 VertexBuffer::in_mercator_projection, or draw the points of DeviceMesh::read_points"
                    .to_owned(),
            ),
            (false, true) => return refuse(
                "it has coordinates of the Mercator projection, but the vertices of the mesh move in the mesh's own \
                 coordinates: leave out VertexBuffer::in_mercator_projection"
                    .to_owned(),
            ),
            _ => {}
        }
        if !origin.iter().all(|x| x.is_finite()) {
            return refuse(format!("the origin is {origin:?}, not a point"));
        }
        if !(scale > 0.0 && scale.is_finite()) {
            return refuse(format!("the scale is {scale}, not a number above 0"));
        }
        let (center, size) = problem.normalization();
        let center = (center - DVec2::from(origin)) * scale;
        Ok(Coordinates { center, scale: size / scale })
    }

    /// Returns the stride in words of four bytes.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the stride is not a multiple of 4, below 8 bytes, or above 16 GiB.
    pub(crate) fn words(&self) -> Result<u32, GpuError> {
        let stride = self.stride;
        if !stride.is_multiple_of(4) || stride < 8 {
            let problem =
                format!("the stride is {stride} bytes, not a multiple of 4 of at least 8");
            return Err(GpuError::Buffer(problem));
        }
        u32::try_from(stride / 4).map_err(|_| {
            GpuError::Buffer(format!("the stride is {stride} bytes, which is more than 16 GiB"))
        })
    }

    /// Returns the window on this many vertices of the buffer.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] or [`GpuError::Limit`] if the window cannot be bound.
    pub(crate) fn window(&self, gpu: &Gpu, vertices: usize) -> Result<Window<'a>, GpuError> {
        let steps = vertices.saturating_sub(1) as u64;
        let bytes = steps.saturating_mul(self.stride).saturating_add(8);
        Window::new(gpu, self.slice, bytes)
    }
}

/// The coordinate system of a vertex buffer, in which a normalized position p is stored as `center + p / scale`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coordinates {
    pub(crate) center: DVec2,
    pub(crate) scale: f64,
}

impl Coordinates {
    /// Counts the corners that are counter-clockwise until rounding to single precision inverts or flattens them.
    /// `None` if a rounded coordinate is not finite, or if the scale or its reciprocal is no normal float.
    fn inverted_by_rounding(&self, problem: &Problem) -> Option<usize> {
        let is_usable = |x: f64| (x as f32).is_normal();
        if !is_usable(self.scale) || !is_usable(1.0 / self.scale) {
            return None;
        }
        let rounded: Vec<[f64; 2]> = problem
            .positions()
            .iter()
            .map(|&p| (self.center + p / self.scale).as_vec2().as_dvec2().to_array())
            .collect();
        if !rounded.as_flattened().iter().all(|x| x.is_finite()) {
            return None;
        }
        let bad = |points: &[[f64; 2]]| now(not_positive(points, problem.corners().all())).len();
        let inverted = bad(&rounded);
        if inverted == 0 {
            return Some(0);
        }
        let positions: Vec<[f64; 2]> = problem.positions().iter().map(DVec2::to_array).collect();
        Some(inverted.saturating_sub(bad(&positions)))
    }
}
