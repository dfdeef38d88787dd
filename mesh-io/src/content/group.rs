//! Groups of elements and vertices of a mesh file, and the names by which users refer to them.

use crate::error::GroupError;
use std::collections::HashMap;
use std::fmt;

/// Elements and vertices that a mesh file gives a tag or a name of their own.
///
/// Displayed as its kind, the name of its dimension, and its name or tag: `physical line inlet`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The format's word for groups of its kind: `physical` and `entity` of gmsh, `marker` and `zone` of SU2,
    /// `reference` and `list` of Medit, `label` of FreeFem, `material` and `nodestring` of SMS, `boundary` of ADCIRC, `material`, `object` and
    /// `group` of OBJ, `attribute` and `marker` of Triangle, `block`, `sideset` and `nodeset` of Exodus, `solid` of STL, `elset`, `nset` and `surface` of Abaqus, `property` of Nastran, and in VTK and XDMF the name of
    /// the array of cell data.
    pub kind: String,
    /// 0 for a group of points, 1 for lines, 2 for triangles and quadrilaterals.
    pub dimension: u8,
    /// Its name, if the file gives it one.
    pub name: Option<String>,
    /// Its number, if the file gives it one.
    pub tag: Option<i64>,
    /// How many points it has, each vertex of a polyline counted as one. Vertices that the file marks one by one do not
    /// count, nor do polygons of more than four corners; their vertices are among [`vertices`](Self::vertices).
    pub points: usize,
    /// How many line elements it has.
    pub lines: usize,
    /// How many quadrilaterals it has.
    pub quadrilaterals: usize,
    pub(crate) triangles: Vec<u32>,
    pub(crate) vertices: Vec<u32>,
}

impl Group {
    /// The indices of its triangles in [`MeshFile::triangles`](crate::MeshFile::triangles), ascending.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// The indices of the vertices of all its elements in [`MeshFile::points`](crate::MeshFile::points), ascending.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Returns the word for the group's dimension: `point`, `line` or `surface`.
    pub fn dimension_name(&self) -> &'static str {
        match self.dimension {
            0 => "point",
            1 => "line",
            _ => "surface",
        }
    }

    /// Returns the names that [`Groups::find`] takes for the group, from the label alone to `kind:dimension:label`. Other groups may
    /// have the same names.
    fn qualified_names(&self) -> impl Iterator<Item = String> {
        let tag = self.tag.map(|tag| tag.to_string());
        let labels = [self.name.clone(), tag].into_iter().flatten();
        labels.flat_map(|label| {
            let (kind, dimension) = (&self.kind, self.dimension_name());
            let full = format!("{kind}:{dimension}:{label}");
            [label.clone(), format!("{kind}:{label}"), format!("{dimension}:{label}"), full]
        })
    }
}

impl fmt::Display for Group {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} ", self.kind, self.dimension_name())?;
        match (&self.name, self.tag) {
            (Some(name), _) => f.write_str(name),
            (None, Some(tag)) => write!(f, "{tag}"),
            (None, None) => f.write_str("without a name"),
        }
    }
}

/// All groups of a mesh file, sorted by kind, then by dimension and tag.
///
/// A user names a group by its name or its tag. The kind of the group, the name of its dimension, or both may precede, each followed
/// by a colon: `inlet`, `1`, `physical:1`, `line:1`, `physical:line:1`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Groups {
    pub(crate) groups: Vec<Group>,
}

impl Groups {
    /// Each group.
    pub fn iter(&self) -> std::slice::Iter<'_, Group> {
        self.groups.iter()
    }

    /// How many groups there are.
    pub fn len(&self) -> usize {
        self.groups.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Returns for each group, in the order of [`iter`](Self::iter), the shortest of its names that no other group has.
    pub fn unique_names(&self) -> Vec<String> {
        let mut uses: HashMap<String, usize> = HashMap::new();
        for group in &self.groups {
            let mut all: Vec<_> = group.qualified_names().collect();
            // A name that is a number may be its own tag.
            all.sort_unstable();
            all.dedup();
            for name in all {
                *uses.entry(name).or_default() += 1;
            }
        }
        let own = |group: &Group| {
            let found = group.qualified_names().find(|name| uses[name] == 1);
            found.or_else(|| group.qualified_names().last()).unwrap_or_default()
        };
        self.groups.iter().map(own).collect()
    }

    /// Returns the group that has `name` among its names.
    ///
    /// # Errors
    /// [`GroupError::Unknown`] if no group has the name, [`GroupError::Ambiguous`] if several groups have it.
    pub fn find(&self, name: &str) -> Result<&Group, GroupError> {
        let fits = |group: &Group| {
            // Every name of a group ends in its label. The comparison is quick where there are very many groups.
            let ends_as = |label: &str| name.ends_with(label);
            let may_fit = group.name.as_deref().is_some_and(ends_as)
                || group.tag.is_some_and(|tag| ends_as(&tag.to_string()));
            may_fit && group.qualified_names().any(|own| own == name)
        };
        let found: Vec<usize> =
            (0..self.len()).filter(|&index| fits(&self.groups[index])).collect();
        match found[..] {
            [index] => Ok(&self.groups[index]),
            [] => {
                let mut known = self.unique_names();
                known.sort_by_cached_key(|own| distance(own, name));
                Err(GroupError::Unknown { name: name.into(), known })
            }
            _ => {
                let own = self.unique_names();
                let candidates = found.into_iter().map(|index| own[index].clone()).collect();
                Err(GroupError::Ambiguous { name: name.into(), candidates })
            }
        }
    }
}

impl<'g> IntoIterator for &'g Groups {
    type Item = &'g Group;
    type IntoIter = std::slice::Iter<'g, Group>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// How many letters are to be inserted, removed or replaced to make one word of another, capitals or not (Levenshtein).
pub(crate) fn distance(a: &str, b: &str) -> usize {
    let [a, b] = [a, b].map(|word| word.to_lowercase().chars().collect::<Vec<_>>());
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(kind: &str, dimension: u8, name: Option<&str>, tag: Option<i64>) -> Group {
        let name = name.map(str::to_owned);
        let (points, lines, quadrilaterals) = (0, 0, 0);
        let (triangles, vertices) = (Vec::new(), Vec::new());
        Group {
            kind: kind.into(),
            dimension,
            name,
            tag,
            points,
            lines,
            quadrilaterals,
            triangles,
            vertices,
        }
    }

    fn gmsh() -> Groups {
        Groups {
            groups: vec![
                group("physical", 1, Some("inlet"), Some(1)),
                group("physical", 2, Some("steel"), Some(1)),
                group("physical", 2, None, Some(2)),
                group("entity", 1, None, Some(1)),
                group("entity", 2, None, Some(1)),
                group("entity", 2, None, Some(2)),
                group("entity", 2, None, Some(-3)),
                group("MaterialIDs", 2, Some("1.5"), None),
            ],
        }
    }

    #[test]
    fn each_group_has_a_unique_name() {
        let groups = gmsh();
        let names = [
            "inlet",
            "steel",
            "physical:2",
            "entity:line:1",
            "entity:surface:1",
            "entity:2",
            "-3",
            "1.5",
        ];
        assert_eq!(groups.unique_names(), names);
        for (name, group) in names.iter().zip(&groups) {
            assert_eq!(groups.find(name), Ok(group));
        }
        assert_eq!(
            groups.find("physical:surface:1").unwrap().to_string(),
            "physical surface steel"
        );
        assert_eq!(groups.find("surface:-3").unwrap().to_string(), "entity surface -3");
    }

    /// Two groups of one name are told apart by their tags, and a name that is the tag of another by what it is.
    #[test]
    fn groups_of_one_name_are_spelled_with_their_tag_or_kind() {
        let groups = Groups {
            groups: vec![
                group("physical", 2, Some("part"), Some(1)),
                group("physical", 2, Some("part"), Some(2)),
                group("marker", 1, Some("2"), None),
                group("marker", 1, Some("7"), Some(7)),
            ],
        };
        assert_eq!(groups.unique_names(), ["1", "physical:2", "marker:2", "7"]);
    }

    #[test]
    fn an_unknown_group_is_answered_with_similar_names() {
        let groups = gmsh();
        let Err(GroupError::Unknown { known, .. }) = groups.find("Inlt") else { panic!() };
        assert_eq!((known.len(), known[0].as_str()), (8, "inlet"));
        let Err(GroupError::Ambiguous { candidates, .. }) = groups.find("1") else { panic!() };
        assert_eq!(candidates, ["inlet", "steel", "entity:line:1", "entity:surface:1"]);
        let Err(GroupError::Ambiguous { candidates, .. }) = groups.find("line:1") else { panic!() };
        assert_eq!(candidates, ["inlet", "entity:line:1"]);
    }

    #[test]
    fn edit_distances_of_names_match_those_by_hand() {
        for (a, b, expected) in [
            ("", "", 0),
            ("", "ab", 2),
            ("inlet", "Inlet", 0),
            ("inlet", "outlet", 3),
            ("kitten", "sitting", 3),
        ] {
            assert_eq!((distance(a, b), distance(b, a)), (expected, expected), "{a} {b}");
        }
    }
}
