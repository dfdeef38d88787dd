//! Vertices of a mesh that slide along lines, and the periodic pairs of sliding vertices.

use crate::error::CliError;
use crate::load::LoadedMesh;
use gpu_smooth::{Slide, Smoother, Topology};
use mesh_io::Constraints;

use crate::load::explain;
use crate::request::SlideRequest;

impl SlideRequest {
    /// Returns the lines, held vertices and periodic pairs of a mesh for sliding. Ends of groups are held.
    pub(crate) fn slide(&self, file: &LoadedMesh) -> Result<Slide, CliError> {
        let mut slide = self.without_ends(file)?;
        slide.held.extend(file.source.group_ends()?);
        Ok(slide)
    }

    /// Returns the result of [`slide`](Self::slide) without the ends of groups.
    fn without_ends(&self, file: &LoadedMesh) -> Result<Slide, CliError> {
        let Self { corner_angle, hausdorff, .. } = *self;
        let (held, periodic) = (file.held_vertices().to_vec(), file.periodic().to_vec());
        let topology =
            Topology::new(file.mesh()).map_err(|error| explain::mesh_error(file, &error))?;
        let mut lines = file.lines();
        // Files list the vertices of line elements on the boundary, which are fixed but slide along the boundary.
        lines.extend(topology.boundary_edges());
        let mut slide = Slide { corner_angle, hausdorff, lines, held, periodic };
        let Constraints { motions, weirs, .. } = file.source.constraints();
        slide.pair_banks(&topology, &file.mesh().points, weirs);
        if self.periodic.is_empty()
            && motions.is_empty()
            && !file.source.constraints().has_unread_pairs
        {
            return Ok(slide);
        }
        let points = &file.mesh().points;
        for &motion in motions {
            // Motions are motions in x and y.
            if file.is_in_xy() {
                slide.pair_by(&topology, points, motion);
            }
        }
        self.pair(file, &topology, &mut slide)?;
        if has_lost_pairs(file, &slide) {
            slide.held.extend(topology.boundary_edges().into_iter().flatten());
        }
        Ok(slide)
    }

    /// Adds the pairs of vertices on the boundary sides that `--periodic` names.
    fn pair(
        &self,
        file: &LoadedMesh,
        topology: &Topology<'_>,
        slide: &mut Slide,
    ) -> Result<(), CliError> {
        if self.periodic.is_empty() {
            return Ok(());
        }
        let groups = file.source.groups()?;
        for names @ [a, b] in &self.periodic {
            let refusal = |problem: &str| {
                CliError::input(format!(
                    "{}: --periodic {}: {problem}",
                    file.source.path().display(),
                    names.join(",")
                ))
            };
            let find = |name: &str| {
                let list = "`gpu-smooth groups` lists what can be named";
                groups.find(name).map_err(|error| refusal(&error.to_string()).with_remedy(list))
            };
            let sides = [find(a)?.vertices(), find(b)?.vertices()];
            if slide.pair_sides(topology, &file.mesh().points, sides) == 0 {
                return Err(refusal(
                    "no translation or rotation maps the vertices of one side to the vertices of the other side: \
                     name two sides of the boundary that match vertex by vertex",
                ));
            }
        }
        Ok(())
    }

    /// Sets the sliding vertices of a smoother.
    pub(crate) fn set(
        &self,
        file: &LoadedMesh,
        smoother: &mut Smoother<'_>,
    ) -> Result<SlidingVertices, CliError> {
        let mut slide = self.without_ends(file)?;
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
        if has_lost_pairs(file, &slide) {
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

/// Returns whether the file declares its model periodic, but no pair of vertices is known.
fn has_lost_pairs(file: &LoadedMesh, slide: &Slide) -> bool {
    let has_some =
        file.source.constraints().has_unread_pairs || !file.source.constraints().motions.is_empty();
    has_some && slide.periodic.is_empty()
}
