//! Interpolation of vertex data at moved positions: depths, third coordinates, point data.

use crate::error::CliError;
use crate::load::LoadedMesh;
use crate::load::plane::z_field;
use crate::request::FieldsRequest;
use gpu_smooth::{Topology, interpolate::Interpolation};
use mesh_io::PointField;

/// The fields of vertex data that are interpolated at new positions.
#[derive(Default)]
pub(crate) struct InterpolatedFields {
    /// The fields named by the user, then dependents: third coordinates, parameters of vertices on surfaces of a model,
    /// and centers of elements.
    fields: Vec<PointField>,
    /// Number of fields named by the user, at the front of `fields`.
    data: usize,
    /// Whether `--interpolate` was given.
    asked: bool,
    /// Whether `--interpolate all` was given. Fields missing in the list are then constant and need no
    /// interpolation.
    all: bool,
}

impl FieldsRequest {
    /// Finds the fields of a file that `--interpolate` names.
    pub(crate) fn choose(&self, file: &LoadedMesh) -> Result<InterpolatedFields, CliError> {
        if self.names.is_empty() {
            return Ok(InterpolatedFields::default());
        }
        // A field's name may contain commas.
        let split = |text: &String| match file.source.data_names().contains(text) {
            true => vec![text.clone()],
            false => text.split(',').map(|name| name.trim().to_owned()).collect(),
        };
        let names: Vec<String> = self.names.iter().flat_map(split).collect();
        let all = names.iter().any(|name| name == "all");
        let fields = file.source.point_fields(if all { None } else { Some(&names) });
        let mut fields = fields.map_err(|error| CliError::from(error).about("--interpolate"))?;
        if file.plane().is_some() {
            // The run moves third coordinates.
            fields.retain(|field| !field.is_third_of_points());
        }
        if all {
            // Constant fields, such as a third coordinate of 0, need no interpolation.
            fields.retain(|field| {
                let first = field.values().first();
                field.values().iter().any(|value| Some(value) != first)
            });
        }
        Ok(InterpolatedFields { data: fields.len(), fields, asked: true, all })
    }

    /// Returns the names of the vertex data, besides those that are requested, whose numbers explain why two files
    /// differ in more than coordinates. Empty if the files differ in anything else.
    pub(crate) fn missing(&self, before: &LoadedMesh, after: &LoadedMesh) -> Vec<String> {
        let difference = |names: &[String]| {
            let request = Self { names: names.to_vec() };
            let fields = [before, after].map(|file| {
                let mut fields = request.choose(file)?;
                fields.add_dependents(file, &file.mesh().points)?;
                Ok::<_, CliError>(fields)
            });
            match &fields {
                [Ok(mine), Ok(theirs)] => {
                    let fields = [mine.fields(), theirs.fields()];
                    before.source.difference_ignoring(&after.source, fields).is_some()
                }
                _ => true,
            }
        };
        let mut names = before.source.data_names().to_vec();
        names.retain(|name| before.plane().is_none() || before.source.has_data(name));
        if difference(&names) {
            return Vec::new();
        }
        let mut at = 0;
        while let Some(name) = names.get(at).cloned() {
            names.remove(at);
            if difference(&names) {
                names.insert(at, name);
                at += 1;
            }
        }
        names.retain(|name| !self.names.contains(name));
        names
    }
}

impl InterpolatedFields {
    pub(crate) fn fields(&self) -> &[PointField] {
        &self.fields
    }

    /// Returns the fields named by the user.
    fn data(&self) -> &[PointField] {
        &self.fields[..self.data]
    }

    /// Returns the names of the user's fields, each once.
    fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for field in self.data() {
            if !names.contains(&field.name()) {
                names.push(field.name());
            }
        }
        names
    }

    /// Returns the remark on fields that are not interpolated; `None` if there are none.
    pub(crate) fn omission_remark(&self, file: &LoadedMesh) -> Option<String> {
        if self.all {
            return None;
        }
        let taken = self.names();
        let left: Vec<_> = file
            .source
            .data_names()
            .iter()
            .filter(|name| !taken.contains(&name.as_str()))
            .filter(|name| file.plane().is_none() || file.source.has_data(name))
            .collect();
        let (verb, them) = match left[..] {
            [] => return None,
            [_] => ("stays as it is and no longer fits", "it"),
            _ => ("stay as they are and no longer fit", "them"),
        };
        let option = if let [one] = left[..] { one.as_str() } else { "all" };
        let names = listed(left.iter().map(|name| format!("`{name}`")));
        let option = if option.contains(' ') { format!("'{option}'") } else { option.to_owned() };
        Some(format!(
            "{names} {verb} where vertices have moved (--interpolate {option} takes {them} to the new places)"
        ))
    }

    /// Returns an error if the request interpolates data of a mesh that must be untangled first.
    pub(crate) fn check_untangled(&self) -> Result<(), CliError> {
        match self.data().is_empty() {
            true => Ok(()),
            false => Err(CliError::input(
                "--interpolate takes data from a mesh without inverted triangles, and this mesh has inverted triangles: \
                 untangle it without --interpolate, and interpolate in a second run",
            )),
        }
    }

    /// Adds the fields that follow from vertex positions, evaluated at `points`: third coordinates of a mesh in a plane,
    /// parameters of vertices on plane surfaces of a model, and centers of elements. Returns remarks on parameters and element positions that remain
    /// unchanged.
    pub(crate) fn add_dependents(
        &mut self,
        file: &LoadedMesh,
        points: &[[f64; 2]],
    ) -> Result<Vec<String>, CliError> {
        let mut remarks = Vec::new();
        if let Some(plane) = file.plane() {
            self.fields.extend(z_field(plane, &file.source, points)?);
        }
        if file.source.has_parameters() {
            let new =
                if file.plane().is_some() { points.into() } else { file.domain.given(points) };
            let (fields, others) = file.source.plane_parameters(file.positions(), &new)?;
            self.fields.extend(fields);
            let surfaces = if others == 1 { "1 surface" } else { &format!("{others} surfaces") };
            if others > 0 {
                remarks.push(format!(
                    "parameters of nodes on {surfaces} that are not plane stay as they are where nodes move"
                ));
            }
        }
        if file.source.has_centers() {
            let (fields, others) = file.source.centers(&file.domain.given(points))?;
            self.fields.extend(fields);
            if !others.is_empty() {
                let names = listed(others.iter().map(String::as_str));
                remarks.push(format!(
                    "{names}: positions of elements that are neither centers nor circumcenters are not updated"
                ));
            }
        }
        Ok(remarks)
    }

    /// Interpolates the fields at the new points. Returns a remark on the result; `None` without fields and without
    /// `--interpolate`.
    pub(crate) fn interpolate(
        &mut self,
        file: &LoadedMesh,
        topology: &Topology<'_>,
        points: &[[f64; 2]],
    ) -> Result<Option<String>, CliError> {
        if self.fields.is_empty() {
            let none = "no data of the mesh differ from vertex to vertex: nothing to interpolate";
            return Ok(self.asked.then(|| none.into()));
        }
        let interpolation = Interpolation::new(topology, &file.mesh().points, points)?;
        let mut left = 0;
        for field in &mut self.fields {
            let each = field.components();
            let copied = file.chart().map(|chart| chart.extended(field.values(), each));
            let old = copied.as_deref().unwrap_or(field.values());
            let mut values = interpolation.apply(old, each)?;
            values.truncate(field.values().len());
            left += field.set(values)?;
        }
        let names = listed(self.names().into_iter());
        let moved = match interpolation.moved() {
            1 => "1 vertex has".to_owned(),
            moved => format!("{moved} vertices have"),
        };
        let kept = match left {
            0 => String::new(),
            1 => {
                "; 1 number is not updated, as a neighboring vertex has no finite number".to_owned()
            }
            left => format!(
                "; {left} numbers are not updated, as a neighboring vertex has no finite number"
            ),
        };
        Ok(Some(format!("interpolated where {moved} moved: {names}{kept}")))
    }
}

impl InterpolatedFields {
    /// Lists implausible values in the fields of another file. Values must keep their bits at vertices that have not
    /// moved, and lie within the range of this file's values elsewhere. `moved` is ascending.
    pub(crate) fn implausible(&self, other: &InterpolatedFields, moved: &[u32]) -> Vec<String> {
        let mut problems = Vec::new();
        if self.data != other.data {
            problems.push("the file has other vertex data than before".to_owned());
        }
        for (old, new) in self.data().iter().zip(other.data()) {
            let (name, each) = (old.name(), old.components().max(1));
            if new.name() != name || new.values().len() != old.values().len() {
                problems.push(format!("{name} has another number of values than before"));
                continue;
            }
            let (mut held, mut beyond) = (0, 0);
            let range = |component: usize| {
                let values = old.values().iter().skip(component).step_by(each);
                let finite = values.copied().filter(|value| value.is_finite());
                finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
                    (value.min(least), value.max(most))
                })
            };
            let ranges: Vec<_> = (0..each).map(range).collect();
            for (index, (old, new)) in old.values().iter().zip(new.values()).enumerate() {
                if old.to_bits() == new.to_bits() {
                    continue;
                }
                let (least, most) = ranges[index % each];
                held += usize::from(moved.binary_search(&((index / each) as u32)).is_err());
                beyond += usize::from(!(least..=most).contains(new));
            }
            if held > 0 {
                let vertices = if held == 1 {
                    "1 vertex that has"
                } else {
                    &format!("{held} vertices that have")
                };
                problems.push(format!("{name} differs at {vertices} not moved"));
            }
            if beyond > 0 {
                let values = if beyond == 1 { "1 value" } else { &format!("{beyond} values") };
                problems.push(format!("{values} of {name} outside the range of the old ones"));
            }
        }
        problems
    }

    /// Returns a sentence on the comparison of plausible fields; `None` without fields.
    pub(crate) fn compared(&self) -> Option<String> {
        let names = self.names();
        let (verb, it) = match names.len() {
            0 => return None,
            1 => ("differs", "it is"),
            _ => ("differ", "they are"),
        };
        Some(format!(
            "{} {verb} only at vertices that have moved, and {it} within the range of the old values",
            listed(names.into_iter())
        ))
    }
}

/// Joins the first six names, and counts the rest.
fn listed(names: impl ExactSizeIterator<Item = impl AsRef<str>>) -> String {
    const TOLD: usize = 6;
    let more = names.len().saturating_sub(TOLD);
    let first: Vec<_> = names.take(TOLD).map(|name| name.as_ref().to_owned()).collect();
    match more {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}
