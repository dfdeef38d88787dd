//! Capabilities of formats, and the losses of a mesh in a format.

use super::content::{Content, ContentGroup};
use super::data_support::DataSupport;
use super::group_numbers::{self, GroupNumbers, determines, is_region_zero};
use super::implied_cells::{ImpliedCells, is_of_all};
use super::name_rules::NameRules;
use super::sides;
use crate::content::group_label::GroupLabel;
use crate::precision::Precision;
use crate::text::token::{join_first, on_one_line};
use crate::visit::items::{CellKind, PeriodicNodes};

/// Loss of periodic pairs, for users.
pub(crate) const PERIODIC: &str = "pairs of periodic vertices";

/// MIKE's projection of local coordinates, which have no place on the globe.
pub(crate) const NO_PROJECTION: &str = "NON-UTM";

/// Elements, groups, names and data that a format can store.
#[derive(Clone, Copy)]
pub(crate) struct Capabilities {
    pub(crate) points: ElementSupport,
    pub(crate) lines: ElementSupport,
    pub(crate) quadrilaterals: bool,
    pub(crate) polygons: bool,
    /// Whether vertices have third coordinates.
    pub(crate) z: bool,
    /// Whether the format stores an origin, which programs add to the coordinates.
    pub(crate) keeps_origin: bool,
    /// Whether the format stores the projection of the coordinates.
    pub(crate) keeps_projection: bool,
    /// Whether the format stores arbitrary ids of vertices.
    pub(crate) keeps_vertex_ids: bool,
    /// Groups that the format can assign to an element.
    pub(crate) groups: GroupSupport,
    /// Whether the format stores names of groups without elements.
    pub(crate) names_empty_groups: bool,
    /// Whether groups have names, by dimension: points, lines and surfaces.
    pub(crate) names: [bool; 3],
    /// The rules for names of groups and data.
    pub(crate) name_rules: NameRules,
    /// Kind of groups whose names the format defines, such as the lists of Medit; empty if users name all groups.
    pub(crate) builtin_group_kind: &'static str,
    /// Whether group numbers may be negative.
    pub(crate) allows_negative_numbers: bool,
    /// Whether the format stores one group number per vertex; with [`GroupSupport::Blocks`], named sets of vertices.
    pub(crate) vertex_groups: bool,
    /// Whether the format stores named sets of vertices.
    pub(crate) vertex_sets: bool,
    /// Whether the format stores pairs of periodic vertices on curves of the model.
    pub(crate) periodic_curves: bool,
    /// The precision of coordinates.
    pub(crate) precision: Precision,
    pub(crate) point_data: DataSupport,
    pub(crate) cell_data: DataSupport,
}

/// The elements of a dimension that a format can store.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum ElementSupport {
    None,
    All,
    /// Only elements in a group.
    OfGroups,
}

/// The groups of elements that a format can store.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum GroupSupport {
    None,
    /// One group per element. Elements of equal dimension have groups of equal kind.
    One,
    /// One group per line, and no groups of other elements.
    OneOfLines,
    /// An entity of the model per element, and any number of other groups, which become physical groups.
    PhysicalAndEntity,
    /// Any number of groups per element, which become sets. Entities become sets if there are no other groups.
    Sets,
    /// One group of each kind per element.
    Each,
    /// A block for the elements of each shape and group. Lines may be in side sets instead.
    Blocks,
    /// A section for the elements of each shape and group.
    Sections,
}

impl GroupSupport {
    /// Returns whether an element may have several groups of one kind.
    fn is_several(self) -> bool {
        matches!(self, GroupSupport::PhysicalAndEntity | GroupSupport::Sets)
    }
}

impl Capabilities {
    /// Lists the kinds of groups in a dimension whose groups the format stores for each element, most important first.
    /// Formats of one group per element store one kind, other formats all kinds. Entities of gmsh's formats are not listed.
    pub(crate) fn stored_kinds<'c>(&self, content: &'c Content, dimension: u8) -> Vec<&'c str> {
        let kinds = content.group_kinds(dimension);
        let Some(&main) = kinds.first() else { return Vec::new() };
        let is_stored = |kind: &&str| match self.groups {
            GroupSupport::PhysicalAndEntity if *kind == "entity" => false,
            _ if *kind == main => true,
            // The numbers of a group that another group determines add nothing.
            _ => {
                self.groups.is_several()
                    && *kind != "entity"
                    && !determines(content, dimension, main, kind, true)
            }
        };
        kinds.into_iter().filter(is_stored).collect()
    }

    /// A format that stores nothing but triangles.
    pub(crate) const TRIANGLES: Capabilities = Capabilities {
        points: ElementSupport::None,
        lines: ElementSupport::None,
        quadrilaterals: false,
        polygons: false,
        z: false,
        keeps_origin: false,
        keeps_projection: false,
        keeps_vertex_ids: false,
        groups: GroupSupport::None,
        names_empty_groups: false,
        names: [false; 3],
        name_rules: NameRules::Any,
        builtin_group_kind: "",
        allows_negative_numbers: true,
        vertex_groups: false,
        vertex_sets: false,
        periodic_curves: false,
        precision: Precision::Double,
        point_data: DataSupport::None,
        cell_data: DataSupport::None,
    };

    /// Lists the parts of a mesh that the format cannot store, one line each. `coded` has the indices of the groups that the
    /// format stores as codes of vertices.
    pub(crate) fn losses(&self, content: &Content, coded: &[u32]) -> Vec<String> {
        let mut lost = Vec::new();
        self.element_losses(content, &mut lost);
        if !self.z && (!content.z_values.is_empty() || content.common_z != 0.0) {
            lost.push("third coordinates".into());
        }
        if !self.keeps_origin && content.origin != [0; 2] {
            let [x, y] = content.origin;
            lost.push(format!("the origin ({x}, {y}), which is not added to coordinates"));
        }
        if !self.keeps_projection && !["", NO_PROJECTION].contains(&&*content.projection) {
            lost.push(format!("the projection {}", on_one_line(content.projection.as_bytes(), 40)));
        }
        let starts = content.first_vertex_id().is_some_and(|first| first <= 1);
        let mut numbers = content.points.as_flattened().iter().chain(&content.z_values);
        if numbers.any(|&x| self.precision.rounded(x).to_bits() != x.to_bits()) {
            lost.push("digits of coordinates, of which 20 characters are written".into());
        }
        if !self.keeps_vertex_ids && !starts {
            lost.push("the vertices' own numbers, which are not consecutive".into());
        }
        self.group_losses(content, coded, &mut lost);
        if matches!(self.groups, GroupSupport::Blocks | GroupSupport::Sections) {
            sides::lost_in_blocks(content, &mut lost);
        }
        if self.groups == GroupSupport::Blocks {
            sides::lost_of_sides(content, &mut lost);
        } else {
            let names: Vec<_> = content.vertex_groups.iter().map(|(group, _)| group).collect();
            let names: Vec<_> = names.into_iter().filter(|group| group.name().is_some()).collect();
            if self.vertex_groups && !names.is_empty() {
                let names = group_names(names.into_iter());
                lost.push(format!("names of groups of vertices, which become numbers: {names}"));
            }
            if self.vertex_groups && content.has_vertex_in_several_groups() {
                lost.push("further groups of a vertex: the first group is kept".into());
            }
        }
        let stored = [0, 1, 2].map(|dimension| self.stored_kinds(content, dimension));
        // The numbers of groups that other groups determine are not written.
        let is_left_out = |group: &ContentGroup| {
            let stored = &stored[usize::from(group.dimension)];
            self.groups.is_several()
                && group.kind != "entity"
                && !stored.contains(&group.kind.as_str())
        };
        let is_negative = |group: &&ContentGroup| {
            matches!(group.label, GroupLabel::Tag(..0)) && !is_left_out(group)
        };
        if !self.allows_negative_numbers && content.groups.iter().any(|group| is_negative(&group)) {
            let groups = group_names(content.groups.iter().filter(is_negative));
            lost.push(format!("negative numbers of groups, which become others: {groups}"));
        }
        let is_wide = |group: &&ContentGroup| group.tag().is_some_and(group_numbers::is_wide);
        let of_elements = content.groups.iter().filter(|group| {
            self.groups != GroupSupport::None && !is_left_out(group) && is_wide(group)
        });
        let of_vertices = content.vertex_groups.iter().map(|(group, _)| group);
        let of_vertices = of_vertices.filter(|group| self.vertex_groups && is_wide(group));
        let wide: Vec<_> = of_elements.chain(of_vertices).collect();
        if !wide.is_empty() {
            let groups = group_names(wide.into_iter());
            lost.push(format!("numbers of groups beyond 32 bits, which become others: {groups}"));
        }
        if !self.vertex_groups && !self.vertex_sets && !content.vertex_groups.is_empty() {
            let groups = content.vertex_groups.iter().map(|(group, _)| group);
            lost.push(format!("groups of vertices: {}", group_names(groups)));
        }
        self.point_data.losses("data of vertices", &content.point_data, &mut lost);
        self.cell_data.losses("data of elements", &content.cell_data, &mut lost);
        let of_vertices = content.point_data.iter().filter(|data| self.point_data.supports(data));
        let of_elements = content.cell_data.iter().filter(|data| self.cell_data.supports(data));
        let large = of_vertices.chain(of_elements).filter(|data| data.has_large_numbers());
        let mut large: Vec<&str> = large.map(|data| data.name.as_str()).collect();
        large.dedup();
        if !large.is_empty() {
            lost.push(format!("digits of whole numbers from 2^53 on: {}", join_first(&large)));
        }
        let is_curve = |tag: i64| {
            let is_own = |group: &ContentGroup| {
                group.dimension == 1 && group.kind == "entity" && group.tag() == Some(tag)
            };
            content.groups.iter().any(is_own)
        };
        let is_kept = |pairs: &PeriodicNodes| match pairs.entities {
            // Pairs on points of the model are pairs on the curves beside them, too.
            Some((0, _)) => self.periodic_curves,
            Some((1, tags)) => self.periodic_curves && tags.into_iter().all(is_curve),
            _ => false,
        };
        if !content.periodic.iter().all(is_kept) {
            lost.push(PERIODIC.into());
        }
        lost.extend(content.unsupported.iter().cloned());
        lost
    }

    /// Lists what the format does not store, although no vertex, element or number depends on it: names of groups without
    /// elements, and the numbers of components of data that zeros fill up.
    pub(crate) fn omissions(&self, content: &Content) -> Vec<String> {
        let is_lost = !self.names_empty_groups && !content.empty_groups.is_empty();
        let names = || {
            let names = group_names(content.empty_groups.iter());
            format!("names of groups without elements: {names}")
        };
        let filled = [
            self.point_data.filled("data of vertices", &content.point_data),
            self.cell_data.filled("data of elements", &content.cell_data),
        ];
        is_lost.then(names).into_iter().chain(filled.into_iter().flatten()).collect()
    }

    /// Returns a line on regions with the tag 0, if the format cannot give this tag to a group.
    pub(crate) fn renumbered_zero(&self, content: &Content) -> Option<String> {
        let stored = [0, 1, 2].map(|dimension| self.stored_kinds(content, dimension));
        let is_zero = |group: &ContentGroup| {
            let stored = &stored[usize::from(group.dimension)];
            is_region_zero(content, group) && stored.contains(&group.kind.as_str())
        };
        let has_none = self.groups == GroupSupport::PhysicalAndEntity;
        let is_told = has_none && content.groups.iter().any(is_zero);
        is_told.then(|| "groups: the tag 0 of a region to an unused tag above 0".to_owned())
    }

    /// Returns whether the format can assign surfaces to groups.
    pub(crate) fn stores_groups_of_surfaces(&self) -> bool {
        !matches!(self.groups, GroupSupport::None | GroupSupport::OneOfLines)
    }

    /// Returns whether the format can store a cell.
    pub(crate) fn supports_cell(
        &self,
        content: &Content,
        tags: &GroupNumbers,
        cell: usize,
    ) -> bool {
        let of = |elements: ElementSupport| match elements {
            ElementSupport::None => false,
            ElementSupport::All => true,
            ElementSupport::OfGroups => tags.group(content, cell).is_some(),
        };
        match content.cells.kinds[cell] {
            CellKind::Point => of(self.points),
            CellKind::Line => of(self.lines),
            CellKind::Triangle => true,
            CellKind::Quadrilateral => self.quadrilaterals,
            CellKind::Polygon => self.polygons,
        }
    }

    fn element_losses(&self, content: &Content, lost: &mut Vec<String>) {
        let tags = GroupNumbers::new(content, self.allows_negative_numbers);
        let implied = ImpliedCells::new(content);
        let is_implied = |&cell: &usize| implied.has(content, cell);
        for (kind, what) in [
            (CellKind::Point, "point"),
            (CellKind::Line, "line"),
            (CellKind::Quadrilateral, "quadrilateral"),
            (CellKind::Polygon, "polygon of more than four corners"),
        ] {
            let dropped = |&cell: &usize| !self.supports_cell(content, &tags, cell);
            let lost_cells: Vec<usize> = content.cells.all(kind).filter(dropped).collect();
            let elements = if kind == CellKind::Point { self.points } else { self.lines };
            if elements == ElementSupport::None && lost_cells.iter().all(is_implied) {
                continue;
            }
            let count = lost_cells.len();
            let of_none = match kind {
                CellKind::Point | CellKind::Line if elements == ElementSupport::OfGroups => {
                    " of no group"
                }
                _ => "",
            };
            match count {
                0 => {}
                1 => lost.push(format!("1 {what}{of_none}")),
                count => {
                    let what = what.replacen("point", "points", 1).replacen("line", "lines", 1);
                    let what = what.replacen("lateral", "laterals", 1);
                    let what = what.replacen("polygon", "polygons", 1);
                    lost.push(format!("{count} {what}{of_none}"));
                }
            }
        }
    }

    fn group_losses(&self, content: &Content, coded: &[u32], lost: &mut Vec<String>) {
        let several = content.sets.iter().any(|set| {
            let kind = |group: &u32| &content.groups[*group as usize].kind;
            set.iter().enumerate().any(|(i, group)| set[..i].iter().any(|b| kind(b) == kind(group)))
        });
        if several && self.groups != GroupSupport::None && !self.groups.is_several() {
            lost.push("further groups of a kind of an element: the first group is kept".into());
        }
        for (dimension, of) in [(0, "points"), (1, "lines"), (2, "surfaces")] {
            let kinds = content.group_kinds(dimension);
            let Some(&main) = kinds.first() else { continue };
            let is_apart = |kind: &str| {
                let is_several = self.groups.is_several();
                kind != main && !determines(content, dimension, main, kind, is_several)
            };
            // Without elements, a group has no place.
            let has_no_elements = match dimension {
                0 => self.points == ElementSupport::None,
                1 => self.lines == ElementSupport::None,
                _ => false,
            };
            let dropped = |kind: &&str| match self.groups {
                _ if has_no_elements => true,
                GroupSupport::None => true,
                GroupSupport::One | GroupSupport::Sections => is_apart(kind),
                GroupSupport::OneOfLines => dimension != 1 || is_apart(kind),
                GroupSupport::Each | GroupSupport::PhysicalAndEntity => false,
                GroupSupport::Sets => *kind == "entity" && is_apart(kind),
                GroupSupport::Blocks => *kind != "block" && is_apart(kind),
            };
            let is_alone = |kind: &str| {
                let groups = (0..).zip(&content.groups);
                let mut own =
                    groups.filter(|(_, group)| group.dimension == dimension && group.kind == kind);
                own.next().is_some_and(|(group, _)| is_of_all(content, group, dimension))
                    && own.next().is_none()
            };
            // Programs number the entities of a model, and no format but gmsh's has a use for their numbers.
            let is_for_gmsh = |kind: &str| {
                let mut groups = content.groups.iter();
                kind == "entity" && groups.all(|group| group.kind != kind || group.name().is_none())
            };
            let lost_kinds = kinds.iter().copied().filter(dropped);
            for kind in lost_kinds.filter(|kind| !is_for_gmsh(kind)) {
                let is_lost = |(index, group): &(u32, &ContentGroup)| {
                    group.dimension == dimension && group.kind == kind && !coded.contains(index)
                };
                let groups = || (0..).zip(&content.groups).filter(is_lost).map(|(_, group)| group);
                if groups().next().is_none() {
                    continue;
                }
                // If one group without a name has all elements, only its number is lost.
                let keeps_none = match self.groups {
                    _ if has_no_elements => true,
                    GroupSupport::None => true,
                    GroupSupport::OneOfLines => dimension != 1,
                    _ => false,
                };
                if keeps_none && is_alone(kind) && groups().all(|group| group.name().is_none()) {
                    continue;
                }
                lost.push(format!("groups of {of} ({kind}): {}", group_names(groups())));
            }
            let kept = kinds.iter().copied().filter(|kind| !dropped(kind));
            let kept: Vec<&str> = kept.collect();
            let named = |group: &&ContentGroup| {
                let is_kept = kept.contains(&group.kind.as_str());
                let is_told = is_kept && group.kind != self.builtin_group_kind;
                group.dimension == dimension && is_told && group.name().is_some()
            };
            let named: Vec<&ContentGroup> = content.groups.iter().filter(named).collect();
            if !self.names[usize::from(dimension)] && !named.is_empty() {
                let names = group_names(named.into_iter());
                lost.push(format!("names of groups of {of}, which become numbers: {names}"));
            }
        }
    }
}

/// Joins the names or numbers of the first 8 groups by commas, and counts the rest.
fn group_names<'g>(groups: impl Iterator<Item = &'g ContentGroup>) -> String {
    let names: Vec<String> = groups
        .map(|group| match (group.name(), &group.label) {
            (Some(name), _) => name.to_owned(),
            (None, label) => match label {
                GroupLabel::Tag(tag) => tag.to_string(),
                GroupLabel::Name(name) => name.clone(),
            },
        })
        .collect();
    join_first(&names.iter().map(String::as_str).collect::<Vec<_>>())
}
