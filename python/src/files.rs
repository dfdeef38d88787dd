//! Mesh files: a file in memory with its points, triangles, groups and data, and conversions.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use gpu_smooth_job::options::Settings;
use mesh_io::{
    Conversion, Encoding, FieldError, MeshFile as File, PointField, ReadError, ReadOptions,
    WriteError,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::error;
use crate::threads;
use crate::values::Given;

/// A mesh file in memory.
#[pyclass(frozen, module = "gpu_smooth._native")]
pub(crate) struct MeshFile(Arc<File>);

/// The reason why a file cannot be written with other points.
enum Refused {
    Reading(ReadError),
    Field(FieldError),
    Writing(WriteError),
}

/// Returns indices as an array.
fn indices<'py>(py: Python<'py>, list: &[u32]) -> Bound<'py, PyArray1<i64>> {
    PyArray1::from_vec(py, list.iter().map(|&index| i64::from(index)).collect())
}

#[pymethods]
impl MeshFile {
    #[new]
    #[pyo3(signature = (path, *, weld, allow_outside, regions))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        weld: &Bound<'_, PyAny>,
        allow_outside: &Bound<'_, PyAny>,
        regions: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let weld = Given { name: "weld", value: weld }.flag()?;
        let allow_outside = Given { name: "allow_outside", value: allow_outside }.flag()?;
        let regions = regions.map(|value| Given { name: "regions", value }.text()).transpose()?;
        let options = ReadOptions::new().weld(weld).allow_outside(allow_outside).regions(regions);
        let options = options.allow_quadrilaterals_alone(true);
        let file = threads::detached(py, || options.read(&path))?;
        Ok(Self(Arc::new(file.map_err(|error| error::of_reading(py, &error))?)))
    }

    #[getter]
    fn path(&self) -> PathBuf {
        self.0.path().to_owned()
    }

    #[getter]
    fn format(&self) -> String {
        self.0.format().to_string()
    }

    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let points = self.0.points();
        arrays::matrix(py, points.as_flattened().to_vec(), [points.len(), 2])
    }

    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let triangles = self.0.triangles();
        let numbers = triangles.as_flattened().iter().map(|&v| i64::from(v)).collect();
        arrays::matrix(py, numbers, [triangles.len(), 3])
    }

    /// The quadrilaterals of four different vertices.
    #[getter]
    fn quadrilaterals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let all = self.0.proper_quadrilaterals().flat_map(|(_, corners)| corners);
        let numbers: Vec<i64> = all.map(|&v| i64::from(v)).collect();
        let rows = numbers.len() / 4;
        arrays::matrix(py, numbers, [rows, 4])
    }

    /// The regions of the triangles, then those of the quadrilaterals of four different vertices.
    #[getter]
    fn regions<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<i64>>> {
        let file = &self.0;
        let of_triangles = match file.regions() {
            Some(regions) => regions.to_vec(),
            None => vec![0; file.triangles().len()],
        };
        let of_file = file.quadrilateral_regions();
        let others = file.proper_quadrilaterals().map(|(index, _)| of_file[index]);
        let all: Vec<i64> = of_triangles.into_iter().chain(others).map(i64::from).collect();
        let is_one = all.windows(2).all(|pair| pair[0] == pair[1]);
        (!is_one).then(|| PyArray1::from_vec(py, all))
    }

    #[getter]
    fn lines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let lines = &self.0.constraints().lines;
        let numbers = lines.as_flattened().iter().map(|&v| i64::from(v)).collect();
        arrays::matrix(py, numbers, [lines.len(), 2])
    }

    #[getter]
    fn anchored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let ends = threads::detached(py, || self.0.group_ends())?;
        let mut anchored = ends.map_err(|error| error::of_reading(py, &error))?;
        anchored.extend(&self.0.constraints_beside_quadrilaterals().anchored);
        anchored.sort_unstable();
        anchored.dedup();
        Ok(indices(py, &anchored))
    }

    /// The vertices that neither move nor slide, without the ends of groups.
    #[getter]
    fn anchored_alone<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        indices(py, &self.0.constraints_beside_quadrilaterals().anchored)
    }

    /// The vertices that the file constrains, apart from those of quadrilaterals: vertices on lines, and vertices that neither move
    /// nor slide.
    #[getter]
    fn constrained<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        indices(py, &self.0.constraints_beside_quadrilaterals().vertices)
    }

    #[getter]
    fn has_third_coordinates(&self) -> bool {
        self.0.has_third_coordinates()
    }

    /// Returns the points with their third coordinates, of shape (n, 3); of shape (n, 2) if these are equal.
    fn points_in_space<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let space = threads::detached(py, || gpu_smooth_job::points_in_space(&self.0))?;
        match space.map_err(|error| error::of_reading(py, &error))? {
            Some(space) => arrays::matrix(py, space.as_flattened().to_vec(), [space.len(), 3]),
            None => self.points(py),
        }
    }

    #[getter]
    fn periodic<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mesh_io::Constraints { periodic, weirs, .. } = self.0.constraints();
        let pairs = periodic.iter().map(|list| &list.pairs).chain(weirs).flatten();
        let numbers: Vec<i64> = pairs.flatten().map(|&v| i64::from(v)).collect();
        let rows = numbers.len() / 2;
        arrays::matrix(py, numbers, [rows, 2])
    }

    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.0.remarks().iter().map(ToString::to_string).collect()
    }

    #[getter]
    fn data_names(&self) -> Vec<String> {
        self.0.data_names().to_vec()
    }

    /// Returns the groups, as a dict of keyword arguments each.
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let groups = threads::detached(py, || self.0.groups())?;
        let groups = groups.map_err(|error| error::of_reading(py, &error))?;
        let proper: HashMap<u32, u32> =
            self.0.proper_quadrilaterals().map(|(index, _)| index as u32).zip(0..).collect();
        let row = |group: &mesh_io::Group| {
            let row = PyDict::new(py);
            row.set_item("kind", &group.kind)?;
            row.set_item("dimension", group.dimension)?;
            row.set_item("name", &group.name)?;
            row.set_item("tag", group.tag)?;
            row.set_item("vertices", indices(py, group.vertices()))?;
            row.set_item("triangles", indices(py, group.triangles()))?;
            let quadrilaterals: Vec<u32> =
                group.quadrilaterals().iter().filter_map(|q| proper.get(q).copied()).collect();
            row.set_item("quadrilaterals", indices(py, &quadrilaterals))?;
            Ok(row)
        };
        groups.iter().map(row).collect()
    }

    /// Returns an array of data of the vertices.
    fn data<'py>(&self, py: Python<'py>, name: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let name = Given { name: "name", value: name }.text()?;
        let fields = threads::detached(py, || self.0.point_fields(Some(&[name])))?;
        let fields = fields.map_err(|error| error::of_reading(py, &error))?;
        let is_coordinate =
            |field: &&PointField| field.is_third_of_points() && self.0.has_third_coordinates();
        let Some(field) = fields.iter().find(is_coordinate).or(fields.last()) else {
            return Err(error::file(py, "the file has no data of this name"));
        };
        let (values, rows) = (field.values().to_vec(), self.0.points().len());
        match field.components() {
            1 => Ok(PyArray1::from_vec(py, values).into_any()),
            each => arrays::matrix(py, values, [rows, each]),
        }
    }

    /// Writes the file with its vertices at other points. Third coordinates are written if those of the file differ.
    #[pyo3(signature = (path, points, *, slide, free_lines, moved_fixed))]
    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        points: &Bound<'_, PyAny>,
        slide: &Bound<'_, PyAny>,
        free_lines: &Bound<'_, PyAny>,
        moved_fixed: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let points = arrays::points("points", points)?;
        let mut settings = Settings::default();
        settings.slides = Given { name: "slide", value: slide }.flag()?;
        settings.frees_lines = Given { name: "free_lines", value: free_lines }.flag()?;
        if !(Given { name: "moved_fixed", value: moved_fixed }.flag()?) {
            let stored = points.form.stored();
            let moved = threads::detached(py, || {
                gpu_smooth_job::moved_fixed_vertex(&self.0, &points.xy, stored, &settings)
            })?;
            if let Some(vertex) = moved.map_err(|error| error::of_reading(py, &error))? {
                return Err(error::moved_fixed(py, vertex as usize, settings.slides));
            }
        }
        let z = points.form.kept_z().filter(|_| self.0.has_third_coordinates());
        let written = threads::detached(py, || {
            let mut fields = Vec::new();
            if let Some(z) = z {
                fields = self.0.point_fields(Some(&["z".to_owned()])).map_err(Refused::Reading)?;
                fields.retain(PointField::is_third_of_points);
                for field in &mut fields {
                    field.set(z.to_vec()).map_err(Refused::Field)?;
                }
            }
            self.0.write_with_fields(&path, &points.xy, &fields).map_err(Refused::Writing)
        })?;
        written.map_err(|refused| match refused {
            Refused::Reading(error) => error::of_reading(py, &error),
            Refused::Field(error) => error::mesh(py, &format!("points: {error}")),
            Refused::Writing(error) => error::of_writing(py, &error),
        })
    }

    /// Returns the first difference to another file apart from coordinates, None without one.
    fn difference(&self, py: Python<'_>, other: &Self) -> PyResult<Option<String>> {
        let found = threads::detached(py, || self.0.difference(&other.0))?;
        Ok(found.map(|found| {
            format!("{} and {}: {}", found.location, found.other_location, found.description)
        }))
    }

    /// Writes the mesh in the format of the ending of `path`, and returns what the format cannot hold.
    fn convert(
        &self,
        py: Python<'_>,
        path: PathBuf,
        lossy: &Bound<'_, PyAny>,
        encoding: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<String>> {
        let lossy = Given { name: "lossy", value: lossy }.flag()?;
        let Some(format) = Conversion::target_of(&path) else {
            let names: Vec<_> = Conversion::targets().map(|(name, _)| name).collect();
            let text = format!(
                "{}: the ending belongs to no format that is written. There are {}",
                path.display(),
                names.join(", ")
            );
            return Err(error::file(py, &text));
        };
        let conversion = threads::detached(py, || Conversion::new(&self.0, format))?;
        let conversion = conversion.map_err(|error| error::of_reading(py, &error))?;
        let Some(mut conversion) = conversion else {
            return Err(error::file(py, &format!("{}: {format} is not written", path.display())));
        };
        conversion.set_creator("gpu-smooth");
        if let Some(value) = encoding {
            let given = Given { name: "encoding", value };
            let encoding = given.word(&[
                ("text", Encoding::Text),
                ("binary", Encoding::Binary),
                ("compressed", Encoding::Compressed),
            ])?;
            if !conversion.set_encoding(encoding) {
                let text = format!(
                    "{}: {format} is not written in this encoding. gmsh, legacy VTK and PLY take \"text\" and \"binary\", \
                     VTK XML takes \"text\", \"binary\" and \"compressed\"",
                    path.display()
                );
                return Err(error::file(py, &text));
            }
        }
        let losses = conversion.losses().to_vec();
        if !lossy && !losses.is_empty() {
            let text = format!(
                "{}: {format} does not hold all of {}: {}. Pass lossy=True to write the mesh without",
                path.display(),
                self.0.path().display(),
                losses.join("; ")
            );
            return Err(error::file(py, &text));
        }
        let written = threads::detached(py, || conversion.write(&path))?;
        written.map_err(|error| error::of_writing(py, &error))?;
        Ok(losses)
    }
}
