//! Makes a mesh from a file's nodes and elements.

use crate::content::constraints::{Constraints, PeriodicPairs};
use crate::content::decoded::decoded;
use crate::content::faces::Faces;
use crate::content::id_index::IdIndexBuilder;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::{Offsets, OffsetsBuilder};
use crate::error::ReadError;
use crate::text::cursor::{CORRECT, Cursor};
use crate::visit::element_regions::{ElementRegions, Regions};
use crate::visit::ghosts::vtk_ghosts;
use crate::visit::items::{CellKind, Element, PeriodicNodes};
use crate::visit::locate::{ItemList, ItemLocation, locate};
use crate::visit::parsed_mesh::ParsedMesh;
use crate::visit::reader::ReaderFunctions;
use crate::visit::records::{NodeRecords, TriangleRecords};
use crate::visit::storage::{CoordinateStorage, RepeatedVertices};
use crate::visit::visitor::MeshVisitor;
use std::collections::{HashMap, HashSet};

/// Largest number of arrays of cell data whose names are stored.
const MAX_CELL_ARRAYS: usize = 256;

/// Reads a mesh, long lists on all threads.
pub(crate) fn parse(reader: &ReaderFunctions, source: &Source) -> Result<ParsedMesh, ReadError> {
    parse_by(reader, source, true)
}

/// Reads a mesh: long lists on all threads if `takes_ahead` is true, otherwise every list item by item.
pub(crate) fn parse_by(
    reader: &ReaderFunctions,
    source: &Source,
    takes_ahead: bool,
) -> Result<ParsedMesh, ReadError> {
    let vertices_of = reader.vertices;
    let mut assembler =
        MeshBuilder { vertices_of, allows_parallel: takes_ahead, ..MeshBuilder::default() };
    let CoordinateStorage {
        format,
        encoding: numbers,
        encoded,
        repeated_vertices: copies,
        file_index,
        says_degrees,
        shared_with,
    } = (reader.visit)(source, &mut assembler)?;
    let (has_parameters, has_centers) = (assembler.has_parameters, assembler.has_centers);
    let (has_z, has_data_named_z) = (assembler.has_z, assembler.has_data_named_z);
    let MeshBuilder { mut points, triangles, x_offsets: x_at, regions, constraints, .. } =
        assembler;
    let MeshBuilder { quadrilaterals, mut remarks, data, on_lower, .. } = assembler;
    let MeshBuilder { cell_arrays, fractional, other_faces, .. } = assembler;
    let ghost_array = assembler.ghost_array.filter(|_| !assembler.has_ghosts);
    let mut constraints = constraints;
    let beside_quadrilaterals = [constraints.vertices.len(), constraints.anchored.len()];
    constraints.vertices.extend_from_slice(quadrilaterals.as_flattened());
    constraints.anchored.extend_from_slice(quadrilaterals.as_flattened());
    if !quadrilaterals.is_empty() {
        let count = quadrilaterals.len() as u64;
        remarks.insert(0, Remark::elements(count, "quadrilateral", ""));
    }
    if on_lower > 0 && on_lower == points.len() {
        remarks.push(Remark::AllOnModelCurves);
    }
    let precision = numbers.precision();
    for (vertex, point) in points.iter_mut().enumerate() {
        *point = point.map(|x| precision.rounded(x));
        if !point.iter().all(|x| x.is_finite()) {
            let ItemLocation { location, id: label, file_index } =
                locate(reader, source, ItemList::Nodes, &[vertex])[0];
            let source = source.files().nth(file_index).unwrap_or(source);
            let problem =
                format!("a coordinate of vertex {label} is too large for single precision");
            return Err(source.error_at(location, problem, CORRECT));
        }
    }
    let Regions { triangles: regions, quadrilaterals: quadrilateral_regions, has_counter } =
        regions.finish();
    if has_counter {
        remarks.push(Remark::CountedElements);
    }
    let (x_at, owners) = match copies {
        None => (x_at.finish(), None),
        Some(RepeatedVertices { x_at, vertices }) => (Offsets::List(x_at), Some(vertices)),
    };
    Ok(ParsedMesh {
        format,
        points,
        triangles,
        x_offsets: x_at,
        owners,
        encoding: numbers,
        file_index,
        encoded,
        regions,
        constraints,
        quadrilaterals,
        quadrilateral_regions,
        beside_quadrilaterals,
        other_faces,
        remarks,
        data,
        region_array: None,
        cell_arrays,
        fractional,
        ghost_array,
        has_parameters,
        has_centers,
        has_z,
        has_data_named_z,
        says_degrees,
        shared_with,
    })
}

/// Visitor that builds a [`ParsedMesh`].
#[derive(Default)]
struct MeshBuilder {
    /// Whether readers may parse long lists on all threads.
    allows_parallel: bool,
    points: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
    x_offsets: OffsetsBuilder,
    ids: IdIndexBuilder,
    regions: ElementRegions,
    constraints: Constraints,
    other_faces: Faces,
    quadrilaterals: Vec<[u32; 4]>,
    remarks: Vec<Remark>,
    /// Names of the arrays of real numbers on vertices besides x and y, each once.
    data: Vec<String>,
    /// The names in `data` as a set, as a damaged file may announce very many names.
    named: HashSet<String>,
    /// Names of the cell data with one number for each cell, except marks of ghosts. Each name is listed once.
    cell_arrays: Vec<String>,
    /// Names among `cell_arrays` of data with a fraction, which cannot number regions.
    fractional: HashSet<String>,
    /// Name of the cell data whose numbers come next.
    announced: Option<String>,
    /// Name of the cell data that mark ghosts.
    ghost_array: Option<String>,
    /// Whether the reader has passed ghosts.
    has_ghosts: bool,
    /// Whether nodes have parameters on surfaces of the model that can be replaced.
    has_parameters: bool,
    has_centers: bool,
    /// Whether third coordinates differ.
    has_z: bool,
    /// Whether an array of data beside third coordinates has the name `z`.
    has_data_named_z: bool,
    /// Name of the file's list of vertices in messages.
    vertices_of: &'static str,
    /// Number of nodes on points and curves of the model.
    on_lower: usize,
}

impl MeshBuilder {
    /// Lists the name of an array, and declines its numbers.
    fn announce(&mut self, name: &[u8], is_real: bool) -> bool {
        let name = decoded(name);
        if is_real && self.named.insert(name.clone()) {
            self.data.push(name);
        }
        false
    }

    /// Returns the index of a node of an element, or an error that names the element.
    #[inline]
    fn index(
        &self,
        cursor: &Cursor<'_>,
        kind: CellKind,
        id: u64,
        node: u64,
    ) -> Result<u32, ReadError> {
        self.ids.index(node).ok_or_else(|| {
            let (kind, list) = (kind.name(), self.vertices_of);
            let problem = format!("{kind} {id} has node {node}, which {list} does not list");
            cursor.error(problem, CORRECT)
        })
    }
}

impl MeshVisitor for MeshBuilder {
    fn allows_parallel(&self) -> bool {
        self.allows_parallel
    }

    fn expect_nodes(&mut self, count: usize) {
        self.points.reserve_exact(count);
        self.x_offsets.expect(count);
        self.ids.list().expect(count);
    }

    #[inline]
    fn node(&mut self, _: &Cursor<'_>, id: u64, dimension: u64, x_at: usize, at: [f64; 2]) {
        if dimension < 2 {
            // The node lies on a point or curve of the model. A curve inside the domain, such as the interface of two
            // surfaces, may be saved without line elements.
            self.on_lower += 1;
            self.constraints.vertices.push(self.points.len() as u32);
        }
        if dimension == 0 {
            self.constraints.anchored.push(self.points.len() as u32);
        }
        self.ids.push(id);
        self.x_offsets.push(x_at);
        self.points.push(at);
    }

    fn node_records(&mut self, records: &NodeRecords<'_>) -> usize {
        if !self.allows_parallel {
            return 0;
        }
        records.read(&mut self.points, self.ids.list(), &mut self.x_offsets)
    }

    fn polygon(
        &mut self,
        cursor: &Cursor<'_>,
        id: u64,
        _: [i64; 2],
        corners: &[u64],
    ) -> Result<(), ReadError> {
        let index = |&node: &u64| self.index(cursor, CellKind::Polygon, id, node);
        let corners = corners.iter().map(index).collect::<Result<Vec<u32>, _>>()?;
        self.constraints.vertices.extend_from_slice(&corners);
        self.constraints.anchored.extend_from_slice(&corners);
        self.other_faces.push(&corners);
        Ok(())
    }

    fn polyline(
        &mut self,
        cursor: &Cursor<'_>,
        id: u64,
        _: [i64; 2],
        nodes: &[u64],
    ) -> Result<(), ReadError> {
        let index = |&node: &u64| self.index(cursor, CellKind::Point, id, node);
        let vertices = nodes.iter().map(index).collect::<Result<Vec<u32>, _>>()?;
        self.constraints.lines.extend(vertices.windows(2).map(|pair| [pair[0], pair[1]]));
        self.constraints.vertices.extend(vertices);
        Ok(())
    }

    fn held_line(
        &mut self,
        cursor: &Cursor<'_>,
        id: u64,
        nodes: [u64; 2],
    ) -> Result<(), ReadError> {
        for node in nodes {
            let vertex = self.index(cursor, CellKind::Line, id, node)?;
            self.constraints.anchored.push(vertex);
        }
        Ok(())
    }

    fn asks_for_periodic_pairs(&self) -> bool {
        true
    }

    fn periodic_pairs(&mut self, pairs: Option<Vec<PeriodicNodes>>) {
        let Constraints { anchored, periodic, motions, has_unread_pairs, .. } =
            &mut self.constraints;
        *has_unread_pairs |= pairs.is_none();
        let mut unlisted = 0;
        for PeriodicNodes { motion, nodes, .. } in pairs.into_iter().flatten() {
            motions.extend(motion.filter(|_| nodes.is_empty()));
            let mut pairs = Vec::with_capacity(nodes.len());
            for [a, b] in nodes {
                match (self.ids.index(a), self.ids.index(b)) {
                    (Some(a), Some(b)) => pairs.push([a, b]),
                    (a, b) => {
                        // Without its partner, the listed node of the pair cannot move along its curve.
                        unlisted += 1;
                        anchored.extend(a.into_iter().chain(b));
                    }
                }
            }
            if !pairs.is_empty() {
                periodic.push(PeriodicPairs { pairs, motion });
            }
        }
        if unlisted > 0 {
            let list = self.vertices_of.to_owned();
            self.remark(Remark::UnlistedPairs { count: unlisted, list });
        }
    }

    fn weir(&mut self, pairs: &[[u64; 2]]) {
        let index = |&[a, b]: &[u64; 2]| Some([self.ids.index(a)?, self.ids.index(b)?]);
        let pairs: Vec<[u32; 2]> = pairs.iter().filter_map(index).collect();
        if !pairs.is_empty() {
            self.constraints.weirs.push(pairs);
        }
    }

    fn asks_for_ghosts(&self) -> bool {
        true
    }

    fn ghosts(&mut self, name: &'static str, count: u64, nodes: &[u64]) {
        let vertices = nodes.iter().filter_map(|&node| self.ids.index(node));
        let vertices: Vec<u32> = vertices.collect();
        self.constraints.vertices.extend_from_slice(&vertices);
        self.constraints.anchored.extend_from_slice(&vertices);
        self.remark(Remark::elements(count, name, ""));
        self.has_ghosts = true;
    }

    fn pieces(&mut self, first_nodes: &[u64]) {
        let starts: Vec<u32> = first_nodes.iter().filter_map(|&id| self.ids.index(id)).collect();
        let piece = |vertex: usize| starts.partition_point(|&start| start as usize <= vertex);
        // Adding zero makes a negative zero positive.
        let place = |at: &[f64; 2]| at.map(|x| (x + 0.0).to_bits());
        let mut first: HashMap<[u64; 2], u32> = HashMap::with_capacity(self.points.len());
        for (vertex, at) in self.points.iter().enumerate() {
            let other = *first.entry(place(at)).or_insert(vertex as u32);
            if piece(other as usize) != piece(vertex) {
                self.constraints.anchored.extend([other, vertex as u32]);
            }
        }
    }

    fn remark(&mut self, remark: Remark) {
        if !self.remarks.contains(&remark) {
            self.remarks.push(remark);
        }
    }

    fn parameters(&mut self, _: i64) -> bool {
        self.has_parameters = true;
        false
    }

    fn center_array(&mut self, _: &[u8], _: usize) -> bool {
        self.has_centers = true;
        false
    }

    fn asks_for_cell_arrays(&self) -> bool {
        true
    }

    /// Asks for real numbers, as cell data with a fraction need no second reading of the file.
    fn cell_array(&mut self, name: &[u8], components: u64, is_real: bool) -> bool {
        self.announced = None;
        let is_ghosts = vtk_ghosts(name).is_some();
        let name = decoded(name);
        if is_ghosts {
            self.ghost_array = Some(name).filter(|_| components == 1);
            return false;
        }
        // Beyond this number, an array without a usual name is not looked for among the others.
        if components == 1
            && self.cell_arrays.len() < MAX_CELL_ARRAYS
            && !self.cell_arrays.contains(&name)
        {
            self.cell_arrays.push(name.clone());
            self.announced = Some(name).filter(|_| is_real);
        }
        self.announced.is_some()
    }

    fn cell_numbers(&mut self, numbers: Vec<f64>, _: Option<Vec<u64>>) {
        // A fraction of NaN is NaN, which stands for a missing value.
        let is_fractional = numbers.iter().any(|number| number.fract().abs() > 0.0);
        self.fractional.extend(self.announced.take().filter(|_| is_fractional));
    }

    fn z_array(&mut self, name: &[u8]) -> bool {
        self.has_z |= name == b"z";
        self.announce(name, true)
    }

    fn point_array(&mut self, name: &[u8], _: u64, is_real: bool) -> bool {
        self.has_data_named_z |= name == b"z" && is_real;
        self.announce(name, is_real)
    }

    fn end_nodes(&mut self, cursor: &Cursor<'_>) -> Result<(), ReadError> {
        let Err((id, second)) = self.ids.finish() else { return Ok(()) };
        let problem = format!("node {id} is listed a second time");
        let location = cursor.location_of(self.x_offsets.at(second));
        Err(cursor.source.error_at(location, problem, "Give each node a different tag"))
    }

    fn expect_elements(&mut self, count: usize) {
        self.triangles.reserve(count);
    }

    fn triangle_records(&mut self, records: &TriangleRecords<'_>) -> usize {
        let Self { ids, allows_parallel: true, triangles, regions, .. } = self else {
            return 0;
        };
        let Some(map) = ids.map() else { return 0 };
        records.read(map, triangles, |region, count| regions.triangles.push(region, count))
    }

    fn further_region(&mut self, kind: CellKind, region: [i64; 2]) {
        match kind {
            CellKind::Triangle => self.regions.triangles.extend_last(region[0]),
            CellKind::Quadrilateral => self.regions.quadrilaterals.extend_last(region[0]),
            _ => {}
        }
    }

    #[inline]
    fn visit_element(&mut self, cursor: &Cursor<'_>, element: &Element) -> Result<(), ReadError> {
        let &Element { id, kind, region, nodes } = element;
        let nodes = &nodes[..kind.nodes()];
        let mut vertices = [0; 4];
        for (vertex, &node) in vertices.iter_mut().zip(nodes) {
            *vertex = self.index(cursor, kind, id, node)?;
        }
        let [a, b, c, _] = vertices;
        match kind {
            CellKind::Triangle if a == b || b == c || c == a => {
                let twice = if b == c { nodes[1] } else { nodes[0] };
                let problem = format!("triangle {id} lists node {twice} twice");
                Err(cursor.error(problem, "Remove the triangle, or correct its nodes"))
            }
            CellKind::Triangle => {
                self.triangles.push([a, b, c]);
                self.regions.triangles.push(region, 1);
                Ok(())
            }
            CellKind::Point | CellKind::Polygon | CellKind::Line => {
                let fixed = &vertices[..nodes.len()];
                self.constraints.vertices.extend_from_slice(fixed);
                match kind {
                    CellKind::Line => self.constraints.lines.push([a, b]),
                    _ => self.constraints.anchored.extend_from_slice(fixed),
                }
                Ok(())
            }
            CellKind::Quadrilateral => {
                self.quadrilaterals.push(vertices);
                self.regions.quadrilaterals.push(region, 1);
                self.other_faces.push(&vertices);
                Ok(())
            }
        }
    }
}
