//! Vertices of a mesh that slide along lines, and the periodic pairs of sliding vertices.

use crate::error::CliError;
use crate::load::LoadedMesh;
use gpu_smooth::{Slide, Smoother, Topology};
use gpu_smooth_job::{Curves, SlideBy};

use crate::load::explain;
use crate::request::SlideRequest;

impl SlideRequest {
    /// Returns the curves along which the vertices of a mesh slide. Ends of groups are held.
    pub(crate) fn slide(&self, file: &LoadedMesh) -> Result<Slide, CliError> {
        Ok(self.curves(file, file.source.group_ends()?)?.slide)
    }

    /// Returns the curves along which vertices slide, with the vertices `ends` held.
    fn curves(&self, file: &LoadedMesh, ends: Vec<u32>) -> Result<Curves, CliError> {
        let topology =
            Topology::new(file.mesh()).map_err(|error| explain::mesh_error(file, &error))?;
        let mut by = SlideBy::default();
        (by.corner_angle, by.hausdorff) = (self.corner_angle, self.hausdorff);
        (by.sides, by.ends) = (self.sides(file)?, ends);
        let curves = file.domain.curves(&file.mesh().points, &topology, &by);
        match curves.unlike_sides {
            None => Ok(curves),
            Some(pair) => Err(self.refusal(
                file,
                pair,
                "no translation or rotation maps the vertices of one side to the vertices of the other side: name two \
                 sides of the boundary that match vertex by vertex",
            )),
        }
    }

    /// Returns the vertices of the boundary sides that `--periodic` names.
    fn sides(&self, file: &LoadedMesh) -> Result<Vec<[Vec<u32>; 2]>, CliError> {
        if self.periodic.is_empty() {
            return Ok(Vec::new());
        }
        let groups = file.groups()?;
        let mut sides = Vec::new();
        for (pair, [a, b]) in self.periodic.iter().enumerate() {
            let find = |name: &str| match groups.find(name) {
                Ok(group) => Ok(group.vertices().to_vec()),
                Err(error) => Err(self
                    .refusal(file, pair, &error.to_string())
                    .with_remedy("`gpu-smooth groups` lists what can be named")),
            };
            sides.push([find(a)?, find(b)?]);
        }
        Ok(sides)
    }

    /// Returns the error of a pair of names of `--periodic`.
    fn refusal(&self, file: &LoadedMesh, pair: usize, problem: &str) -> CliError {
        CliError::input(format!(
            "{}: --periodic {}: {problem}",
            file.source.path().display(),
            self.periodic[pair].join(",")
        ))
    }

    /// Sets the sliding vertices of a smoother.
    pub(crate) fn set(
        &self,
        file: &LoadedMesh,
        smoother: &mut Smoother<'_>,
    ) -> Result<SlidingVertices, CliError> {
        let Curves { mut slide, has_lost_pairs, .. } = self.curves(file, Vec::new())?;
        let mut count = smoother.set_slide(Some(&slide))?;
        let all = count;
        let ends = file.source.group_ends()?;
        if !ends.is_empty() {
            slide.held.extend(ends);
            count = smoother.set_slide(Some(&slide))?;
        }
        let ends = all.saturating_sub(count);
        let [pairs, unlike] = smoother.pairs();
        let weirs = Weirs::of(file, &slide)?;
        let mut text = match count {
            0 => {
                "--slide: no vertex can slide, as all on lines are corners, ends of groups or fixed"
                    .to_owned()
            }
            1 => "--slide: 1 vertex on the boundary or another line may slide".to_owned(),
            n => format!("--slide: {n} vertices on the boundary and other lines may slide"),
        };
        text += &match pairs.saturating_sub(weirs.sliding) {
            0 => String::new(),
            1 => ", 2 of them as a periodic pair".to_owned(),
            n => format!(", {} of them in {n} periodic pairs", 2 * n),
        };
        text += &weirs.slide();
        let [together, alone] = smoother.coincident();
        match together {
            0 => {}
            1 => text += ", 2 of them as a pair at the same place",
            n => text += &format!(", {} of them in {n} pairs at the same place", 2 * n),
        }
        match alone {
            0 => {}
            1 => text += "; 1 vertex at the place of another stays, as that one does not slide",
            n => {
                text += &format!(
                    "; {n} vertices at the place of others stay, at corners, where a crack or a contact ends, or where three \
                     or more meet"
                );
            }
        }
        text += &weirs.stay();
        if let Some(clause) = stay_as_ends(ends) {
            text += &format!("; {clause}");
        }
        if has_lost_pairs {
            text += "; the boundary stays fixed, as the model is periodic and the pairs of vertices are unknown: \
                     --periodic MARKER,MARKER names them";
        }
        match unlike {
            0 => {}
            1 => text += "; 1 pair stays, as it is not like the others",
            n => {
                text += &format!(
                    "; {n} pairs stay, as no translation or rotation takes one vertex to the other"
                );
            }
        }
        Ok(SlidingVertices { count, ends, has_weirs: weirs.sliding > 0, remark: text })
    }
}

/// Returns a clause on vertices that stay because groups end there; `None` for 0.
pub(crate) fn stay_as_ends(ends: usize) -> Option<String> {
    match ends {
        0 => None,
        1 => Some("1 vertex stays as an end of groups".to_owned()),
        n => Some(format!("{n} vertices stay as ends of groups")),
    }
}

/// Numbers of pairs of vertices that face each other across weirs.
struct Weirs {
    sliding: usize,
    staying: usize,
}

impl Weirs {
    fn of(file: &LoadedMesh, slide: &Slide) -> Result<Self, CliError> {
        let weirs = &file.source.constraints().weirs;
        if weirs.is_empty() {
            return Ok(Self { sliding: 0, staying: 0 });
        }
        let topology =
            Topology::new(file.mesh()).map_err(|error| explain::mesh_error(file, &error))?;
        let sliding = slide.vertices(&topology, &file.mesh().points)?;
        let slides = |[a, b]: &&[u32; 2]| [a, b].iter().all(|v| sliding.binary_search(v).is_ok());
        let (all, sliding) =
            (weirs.iter().flatten().count(), weirs.iter().flatten().filter(slides).count());
        Ok(Self { sliding, staying: all - sliding })
    }

    /// Returns a clause on the pairs that slide.
    fn slide(&self) -> String {
        match self.sliding {
            0 => String::new(),
            1 => ", 2 of them as a pair across a weir".to_owned(),
            n => format!(", {} of them in {n} pairs across weirs", 2 * n),
        }
    }

    /// Returns a clause on the pairs that stay.
    fn stay(&self) -> String {
        let why = "at corners, at fixed vertices or between banks that are not parallel";
        match self.staying {
            0 => String::new(),
            1 => format!("; 1 pair across a weir stays, as pairs do {why}"),
            n => format!("; {n} pairs across weirs stay, {why}"),
        }
    }
}

/// The sliding vertices of a mesh.
pub(crate) struct SlidingVertices {
    pub(crate) count: usize,
    /// Number of vertices that would slide if no group ended at them or at their partners.
    pub(crate) ends: usize,
    /// Whether pairs are across weirs.
    pub(crate) has_weirs: bool,
    /// A sentence with the numbers of sliding vertices and periodic pairs.
    pub(crate) remark: String,
}
