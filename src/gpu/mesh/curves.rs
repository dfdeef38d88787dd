//! The buffers of sliding vertices: their curves, the triangles around them, and their places on the curves.

use std::mem::offset_of;
use std::ops::Range;

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::{filled, write_by_pieces, zeroed};
use crate::gpu::device::pending::Waiting;
use crate::gpu::device::readback;
use crate::gpu::device::size::check_limit;
use crate::gpu::kernels::uniforms::{
    CurvePlace, Knot, NO_GUARD, SlidingVertex, pair, split, unpair,
};
use crate::gpu::mesh::bounds::RESERVE;
use crate::gpu::scope::scoped;
use crate::layout::Problem;
use crate::run::multilevel::NONE;
use crate::slide::{self, CurveTable, OnCurves, Place};

/// The vertices of a mesh that slide along curves.
pub(crate) struct Curves {
    /// The sliding vertices by color.
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) knots: wgpu::Buffer,
    pub(crate) corners: wgpu::Buffer,
    /// The present place of each vertex of a curve.
    pub(crate) places: wgpu::Buffer,
    /// The places in the best state; a single entry if a run does not keep the best state.
    pub(crate) best: wgpu::Buffer,
    /// Ranges of the sliding vertices of each color.
    pub(crate) colors: Vec<Range<u32>>,
    /// Each sliding vertex and its partner ([`NONE`] without one), in the order of `vertices`.
    pub(crate) pairs: Vec<[u32; 2]>,
    /// Number of entries in `places`.
    pub(crate) count: usize,
    /// Whether an application may move the vertices.
    pub(crate) is_of_application: bool,
    /// The state that the host last set, which has all digits of parameters.
    set: OnCurves,
}

impl Curves {
    /// Uploads the sliding vertices of a mesh that stays in an application.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub(crate) fn of_application(
        gpu: &Gpu,
        problem: &Problem,
        on_curves: &OnCurves,
    ) -> Result<Self, GpuError> {
        let curves = Self::new(gpu, problem, on_curves, false)?;
        Ok(Self { is_of_application: true, ..curves })
    }

    /// Uploads sliding vertices. With `keeps_best`, there is room for the best state.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the curves do not fit a binding of the device, or another [`GpuError`] if the device fails.
    pub(crate) fn new(
        gpu: &Gpu,
        problem: &Problem,
        on_curves: &OnCurves,
        keeps_best: bool,
    ) -> Result<Self, GpuError> {
        let CurveTable { knots, vertices, colors, mut corners } = on_curves.table(problem);
        let knots: Vec<Knot> = knots.iter().map(uploaded_knot).collect();
        let vertices: Vec<SlidingVertex> = vertices.iter().map(uploaded_vertex).collect();
        // An empty buffer cannot be bound.
        corners.resize(corners.len().max(1), [NONE; 2]);
        let places = uploaded_places(&on_curves.places(problem));
        let most = gpu.device.limits().max_storage_buffer_binding_size;
        let largest = size_of_val(&knots[..]).max(size_of_val(&vertices[..]));
        let largest = largest.max(size_of_val(&corners[..])) as u64;
        let what = || format!("the buffer of {} sliding vertices", vertices.len());
        check_limit("max_storage_buffer_binding_size", most, &what, largest)?;
        let kept = if keeps_best { places.len() } else { 1 };
        scoped(&gpu.device, || {
            let usage = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
            let bytes = (kept * size_of::<CurvePlace>()) as u64;
            Self {
                vertices: filled(
                    gpu,
                    "sliding vertices",
                    &vertices,
                    Usage::STORAGE | Usage::COPY_DST,
                ),
                knots: filled(gpu, "curves", &knots, Usage::STORAGE),
                corners: filled(gpu, "triangles of sliding vertices", &corners, Usage::STORAGE),
                places: filled(gpu, "curve parameters", &places, usage),
                best: zeroed(gpu, "best curve parameters", bytes, usage),
                colors,
                pairs: vertices.iter().map(|vertex| vertex.vertices).collect(),
                is_of_application: false,
                count: places.len(),
                set: on_curves.clone(),
            }
        })
    }

    /// Pins or releases a sliding vertex with its partner, given by the index in `pairs`. To be called in an error scope.
    pub(crate) fn pin(&self, gpu: &Gpu, index: usize, is_pinned: bool) {
        let at = index * size_of::<SlidingVertex>() + offset_of!(SlidingVertex, pinned);
        gpu.queue.write_buffer(&self.vertices, at as u64, &u32::from(is_pinned).to_le_bytes());
    }

    /// Returns the state that the host last set.
    pub(crate) fn set(&self) -> &OnCurves {
        &self.set
    }

    /// Reads back the present state, or the best state.
    pub(crate) async fn read(
        &self,
        gpu: &Gpu,
        problem: &Problem,
        state: &wgpu::Buffer,
        waiting: Waiting,
    ) -> Result<OnCurves, GpuError> {
        let found: Vec<CurvePlace> = readback::read(gpu, state, self.count, waiting).await?;
        Ok(self.at(problem, &found))
    }

    /// Returns the state with the places that were read back.
    pub(crate) fn at(&self, problem: &Problem, found: &[CurvePlace]) -> OnCurves {
        let mut places = self.set.places(problem);
        for (place, found) in places.iter_mut().zip(found) {
            // A vertex that has not moved keeps all digits, of which the device has 48.
            if found.param != pair(place.param) {
                place.param = unpair(found.param);
            }
            place.presses = found.presses as i8;
        }
        self.set.at_places(problem, &places)
    }

    /// Sets the present state, and the best state if given.
    pub(crate) fn write(
        &mut self,
        gpu: &Gpu,
        problem: &Problem,
        on_curves: &OnCurves,
        best: Option<&OnCurves>,
    ) -> Result<(), GpuError> {
        let written = |buffer, state: &OnCurves| {
            let places = uploaded_places(&state.places(problem));
            write_by_pieces(gpu, buffer, 0, bytemuck::cast_slice(&places));
        };
        self.set = on_curves.clone();
        scoped(&gpu.device, || {
            written(&self.places, on_curves);
            best.into_iter().for_each(|best| written(&self.best, best));
        })
    }
}

fn uploaded_places(places: &[Place]) -> Vec<CurvePlace> {
    let uploaded = |&Place { param, own, presses }: &Place| CurvePlace {
        param: pair(param),
        piece: own,
        presses: presses.into(),
    };
    places.iter().map(uploaded).collect()
}

fn uploaded_knot(knot: &slide::Knot) -> Knot {
    Knot {
        at: split(knot.point),
        param: pair(knot.param),
        slopes: knot.slopes.map(|slope| slope as f32),
        length: knot.length as f32,
        bound: (knot.bound * (1.0 - RESERVE)) as f32,
        padding: [0; 2],
    }
}

fn uploaded_vertex(of: &slide::SlidingVertex) -> SlidingVertex {
    let [own, partner] = &of.corners;
    SlidingVertex {
        vertices: [of.vertex, of.partner.unwrap_or(NONE)],
        place: of.place,
        low: of.neighbors[0],
        high: of.neighbors[1],
        knots: of.knots.start,
        knot_count: of.knots.end - of.knots.start,
        is_closed: of.is_closed.into(),
        own: of.own,
        first_corner: own.start,
        partner_corner: own.end,
        last_corner: partner.end,
        reach: (of.reach * (1.0 - RESERVE)).min(NO_GUARD) as f32,
        pinned: 0,
        masked: 0,
        padding: 0,
    }
}
