//! What each format holds, and what of a mesh is lost in it.

use super::content::{Content, ContentGroup, Data};
use super::group_numbers::{Tags, decides};
use super::name_rules::Spelling;
use super::sides;
use crate::content::label::Label;
use crate::precision::Precision;
use crate::visit::items::Kind;

/// What a format can hold of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct Holds {
    pub(crate) points: Elements,
    pub(crate) lines: Elements,
    pub(crate) quadrilaterals: bool,
    pub(crate) polygons: bool,
    pub(crate) heights: bool,
    /// Whether vertices keep their own numbers, whatever these are.
    pub(crate) labels: bool,
    /// Which groups an element can belong to.
    pub(crate) groups: Groups,
    /// Whether groups of points, lines and surfaces have names.
    pub(crate) names: [bool; 3],
    /// How names of groups and data are spelled.
    pub(crate) spelling: Spelling,
    /// A kind of groups whose names belong to the format itself, such as Medit's lists; empty if there is none.
    pub(crate) own: &'static str,
    /// Whether the numbers of groups may be negative.
    pub(crate) negative: bool,
    /// Whether each vertex has the number of a group.
    pub(crate) vertex_groups: bool,
    /// Whether vertices are in sets with names instead.
    pub(crate) vertex_sets: bool,
    /// The precision of coordinates.
    pub(crate) precision: Precision,
    pub(crate) point_data: Numbers,
    pub(crate) cell_data: Numbers,
}

/// Which elements of a dimension a format holds.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Elements {
    None,
    All,
    /// Only elements that belong to a group.
    OfGroups,
}

/// Which groups of elements a format holds.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Groups {
    None,
    /// One group for each element. All elements of a dimension have the same kind of group.
    One,
    /// One group for each line, and none for other elements.
    OneOfLines,
    /// A physical group, or the most important kind of group, and an entity of the model.
    PhysicalAndEntity,
    /// One group of each kind.
    Each,
    /// A block of elements of one kind and group; for lines also a side set.
    Blocks,
}

/// Which data a format holds.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Numbers {
    None,
    All,
    /// Data of one number.
    Scalars,
    /// Data of one number, without names.
    Unnamed,
    /// Only data of one number with this name.
    Only(&'static str),
}

impl Holds {
    /// A format that holds nothing but triangles.
    pub(crate) const TRIANGLES: Holds = Holds {
        points: Elements::None,
        lines: Elements::None,
        quadrilaterals: false,
        polygons: false,
        heights: false,
        labels: false,
        groups: Groups::None,
        names: [false; 3],
        spelling: Spelling::Any,
        own: "",
        negative: true,
        vertex_groups: false,
        vertex_sets: false,
        precision: Precision::Double,
        point_data: Numbers::None,
        cell_data: Numbers::None,
    };

    /// Lists what of a mesh is lost, one line each.
    pub(crate) fn lost(&self, content: &Content) -> Vec<String> {
        let mut lost = Vec::new();
        self.lost_elements(content, &mut lost);
        if !self.heights && !content.heights.is_empty() {
            lost.push("third coordinates".into());
        }
        let starts = content.first_label().is_some_and(|first| first <= 1);
        let mut numbers = content.points.as_flattened().iter().chain(&content.heights);
        if numbers.any(|&x| self.precision.rounded(x).to_bits() != x.to_bits()) {
            lost.push("digits of coordinates, of which 20 characters are written".into());
        }
        if !self.labels && !starts {
            lost.push("the vertices' own numbers, which are not consecutive".into());
        }
        self.lost_groups(content, &mut lost);
        if self.groups == Groups::Blocks {
            sides::lost_in_blocks(content, &mut lost);
        } else {
            let names: Vec<_> = content.vertex_groups.iter().map(|(group, _)| group).collect();
            let names: Vec<_> = names.into_iter().filter(|group| group.name().is_some()).collect();
            if self.vertex_groups && !names.is_empty() {
                let names = listed(names.into_iter());
                lost.push(format!("names of groups of vertices, which become numbers: {names}"));
            }
        }
        let is_negative = |group: &&ContentGroup| matches!(group.label, Label::Tag(..0));
        if !self.negative && content.groups.iter().any(|group| is_negative(&group)) {
            let groups = listed(content.groups.iter().filter(is_negative));
            lost.push(format!("negative numbers of groups, which become others: {groups}"));
        }
        if !self.vertex_groups && !self.vertex_sets && !content.vertex_groups.is_empty() {
            let groups = content.vertex_groups.iter().map(|(group, _)| group);
            lost.push(format!("groups of vertices: {}", listed(groups)));
        }
        self.point_data.lost("data of vertices", &content.point_data, &mut lost);
        self.cell_data.lost("data of elements", &content.cell_data, &mut lost);
        lost.extend(content.left_out.iter().cloned());
        lost
    }

    /// Whether the format holds a cell.
    pub(crate) fn holds(&self, content: &Content, tags: &Tags, cell: usize) -> bool {
        let of = |elements: Elements| match elements {
            Elements::None => false,
            Elements::All => true,
            Elements::OfGroups => tags.group(content, cell).is_some(),
        };
        match content.cells.kinds[cell] {
            Kind::Point => of(self.points),
            Kind::Line => of(self.lines),
            Kind::Triangle => true,
            Kind::Quadrilateral => self.quadrilaterals,
            Kind::Corner => self.polygons,
        }
    }

    fn lost_elements(&self, content: &Content, lost: &mut Vec<String>) {
        let tags = Tags::new(content, self.negative);
        for (kind, what) in [
            (Kind::Point, "point"),
            (Kind::Line, "line"),
            (Kind::Quadrilateral, "quadrilateral"),
            (Kind::Corner, "polygon of more than four corners"),
        ] {
            let dropped = |&cell: &usize| !self.holds(content, &tags, cell);
            let count = content.cells.all(kind).filter(dropped).count();
            let elements = if kind == Kind::Point { self.points } else { self.lines };
            let of_none = match kind {
                Kind::Point | Kind::Line if elements == Elements::OfGroups => " of no group",
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

    fn lost_groups(&self, content: &Content, lost: &mut Vec<String>) {
        let several = content.sets.iter().any(|set| {
            let what = |group: &u32| &content.groups[*group as usize].what;
            set.iter().enumerate().any(|(i, group)| set[..i].iter().any(|b| what(b) == what(group)))
        });
        if several && self.groups != Groups::None {
            lost.push(
                "that elements are of several groups of a kind: the first one is kept".into(),
            );
        }
        for (dimension, of) in [(0, "points"), (1, "lines"), (2, "surfaces")] {
            let whats = content.whats(dimension);
            let Some(&main) = whats.first() else { continue };
            let dropped = |what: &&str| match self.groups {
                Groups::None => true,
                Groups::One => *what != main && !decides(content, dimension, main, what),
                Groups::OneOfLines => {
                    dimension != 1 || (*what != main && !decides(content, 1, main, what))
                }
                Groups::PhysicalAndEntity => {
                    *what != main && *what != "entity" && !decides(content, dimension, main, what)
                }
                Groups::Each => false,
                Groups::Blocks => {
                    *what != main && *what != "block" && !decides(content, dimension, main, what)
                }
            };
            let one = |what: &str| {
                let groups = content.groups.iter();
                groups.filter(|group| group.dimension == dimension && group.what == what).count()
                    == 1
            };
            for what in whats.iter().copied().filter(dropped) {
                let groups =
                    || content.groups.iter().filter(|g| g.dimension == dimension && g.what == what);
                // If there is one group without a name, only its number is lost.
                let keeps_none = match self.groups {
                    Groups::None => true,
                    Groups::OneOfLines => dimension != 1,
                    _ => false,
                };
                if keeps_none && one(what) && groups().all(|group| group.name().is_none()) {
                    continue;
                }
                lost.push(format!("groups of {of} ({what}): {}", listed(groups())));
            }
            let kept = whats.iter().copied().filter(|what| !dropped(what));
            let kept: Vec<&str> = kept.collect();
            let named = |group: &&ContentGroup| {
                let is_kept = kept.contains(&group.what.as_str());
                let is_told = is_kept && group.what != self.own;
                group.dimension == dimension && is_told && group.name().is_some()
            };
            let named: Vec<&ContentGroup> = content.groups.iter().filter(named).collect();
            if !self.names[usize::from(dimension)] && !named.is_empty() {
                let names = listed(named.into_iter());
                lost.push(format!("names of groups of {of}, which become numbers: {names}"));
            }
        }
    }
}

impl Numbers {
    /// Whether the format holds these data.
    pub(crate) fn holds(self, data: &Data) -> bool {
        match self {
            Numbers::None => false,
            Numbers::All => true,
            Numbers::Scalars | Numbers::Unnamed => data.components == 1,
            Numbers::Only(name) => data.name == name && data.components == 1,
        }
    }

    fn lost(self, what: &str, data: &[Data], lost: &mut Vec<String>) {
        let names = |kept: bool| -> Vec<&str> {
            let of = data.iter().filter(|data| self.holds(data) == kept);
            let mut names: Vec<&str> = of.map(|data| data.name.as_str()).collect();
            names.dedup();
            names
        };
        let dropped = names(false);
        if !dropped.is_empty() {
            lost.push(format!("{what}: {}", first(&dropped)));
        }
        let mut kept = names(true);
        // Names such as `attribute1` are the format's own.
        kept.retain(|name| !name.starts_with("attribute"));
        if self == Numbers::Unnamed && !kept.is_empty() {
            lost.push(format!("names of {what}: {}", first(&kept)));
        }
    }
}

/// Lists the names or numbers of the first groups, and counts the rest.
fn listed<'g>(groups: impl Iterator<Item = &'g ContentGroup>) -> String {
    let names: Vec<String> = groups
        .map(|group| match (group.name(), &group.label) {
            (Some(name), _) => name.to_owned(),
            (None, label) => match label {
                Label::Tag(tag) => tag.to_string(),
                Label::Name(name) => name.clone(),
            },
        })
        .collect();
    first(&names.iter().map(String::as_str).collect::<Vec<_>>())
}

/// Lists the first names, and counts the rest.
pub(crate) fn first(names: &[&str]) -> String {
    const TOLD: usize = 8;
    let told = names[..names.len().min(TOLD)].join(", ");
    match names.len().saturating_sub(TOLD) {
        0 => told,
        more => format!("{told} and {more} more"),
    }
}
