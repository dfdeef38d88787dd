//! Groups of elements and vertices of a mesh file, and the names by which users refer to them.

use crate::error::GroupError;
use std::collections::HashMap;
use std::fmt;

/// Group of elements and vertices to which a mesh file gives a tag or a name.
///
/// [`Display`](fmt::Display) writes kind, dimension, and name or tag: `physical line inlet`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The format's word for the kind of group, such as `physical` of gmsh, `marker` of SU2 or `sideset` of Exodus; in
    /// VTK and XDMF, the name of the array of cell data. [`MeshFile::groups`](crate::MeshFile::groups) has a table of
    /// the words of each format.
    pub kind: String,
    /// 0 for a group of points, 1 for lines, 2 for triangles and quadrilaterals.
    pub dimension: u8,
    /// Name in the file; `None` for a group identified by its tag alone.
    pub name: Option<String>,
    /// Number in the file; `None` for a group identified by its name alone.
    pub tag: Option<i64>,
    /// Number of point elements, plus one for each vertex of a polyline. A vertex at which a polyline closes or
    /// goes on is counted once. Single vertices that the file assigns to the group, and polygons of more than four corners, are not
    /// counted. Their vertices are among [`vertices`](Self::vertices).
    pub points: usize,
    /// Number of line elements, without the segments of polylines.
    pub lines: usize,
    pub(crate) quadrilaterals: Vec<u32>,
    pub(crate) triangles: Vec<u32>,
    pub(crate) vertices: Vec<u32>,
    /// Edges of line elements and polylines, each once: the smaller vertex first, ascending.
    pub(crate) edges: Vec<[u32; 2]>,
}

impl Group {
    /// Returns the indices of the group's triangles in [`MeshFile::triangles`](crate::MeshFile::triangles), ascending.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Returns the indices of the group's quadrilaterals in [`MeshFile::quadrilaterals`](crate::MeshFile::quadrilaterals),
    /// ascending.
    pub fn quadrilaterals(&self) -> &[u32] {
        &self.quadrilaterals
    }

    /// Returns the indices of the vertices of all elements of the group, and of single vertices in the group, in
    /// [`MeshFile::points`](crate::MeshFile::points), ascending.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Returns whether the group has vertices or points, and neither edges nor faces.
    pub(crate) fn is_of_vertices(&self) -> bool {
        self.dimension == 0 && self.edges.is_empty() && !self.vertices.is_empty()
    }

    /// Returns whether both groups consist of the same elements. False for groups without vertices.
    fn equals(&self, other: &Group) -> bool {
        let elements = |group: &Group| (group.dimension, group.points, group.lines);
        !self.vertices.is_empty()
            && elements(self) == elements(other)
            && self.vertices == other.vertices
            && self.triangles == other.triangles
            && self.quadrilaterals == other.quadrilaterals
    }

    /// Returns the word for the group's dimension: `point`, `line` or `surface`.
    pub fn dimension_name(&self) -> &'static str {
        match self.dimension {
            0 => "point",
            1 => "line",
            _ => "surface",
        }
    }

    /// Returns the spellings by which [`Groups::find`] finds the group: its name, then its tag, each alone, with a
    /// prefix, and as `kind:dimension:label`. Other groups may share a spelling.
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

/// All groups of a mesh file. Kinds keep their order of first use in the file; groups of one kind ascend by dimension,
/// then by tag.
///
/// A user refers to a group by name or tag, optionally with prefixes: kind, name of the dimension, or both, each
/// followed by a colon. Examples: `inlet`, `1`, `physical:1`, `line:1`, `physical:line:1`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Groups {
    pub(crate) groups: Vec<Group>,
}

impl Groups {
    /// Returns an iterator over the groups.
    pub fn iter(&self) -> std::slice::Iter<'_, Group> {
        self.groups.iter()
    }

    /// Returns the number of groups.
    pub fn len(&self) -> usize {
        self.groups.len()
    }

    /// Returns whether the file has no groups.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Returns for each group a name that no other group shares, in the order of [`iter`](Self::iter). The name has as
    /// few prefixes as possible, and is replaced by the tag only if other groups share the name even with all prefixes.
    /// A group without any unique name gets `kind:dimension:label`.
    pub fn unique_names(&self) -> Vec<String> {
        let mut uses: HashMap<String, usize> = HashMap::new();
        for group in &self.groups {
            let mut all: Vec<_> = group.qualified_names().collect();
            // A group whose name is its tag has each spelling twice.
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

    /// Returns the group to which `name` refers, with or without prefixes. Of several groups with the same elements, such
    /// as an entity of gmsh and the physical group that consists of it, returns the first.
    ///
    /// # Errors
    /// [`GroupError::Unknown`] if no group has the name, [`GroupError::Ambiguous`] if groups of different elements share
    /// the name.
    pub fn find(&self, name: &str) -> Result<&Group, GroupError> {
        let fits = |group: &Group| {
            // Each spelling ends in the name or tag. This cheap test excludes most groups, of which a file may have
            // very many.
            let ends_as = |label: &str| name.ends_with(label);
            let may_fit = group.name.as_deref().is_some_and(ends_as)
                || group.tag.is_some_and(|tag| ends_as(&tag.to_string()));
            may_fit && group.qualified_names().any(|own| own == name)
        };
        let found: Vec<usize> =
            (0..self.len()).filter(|&index| fits(&self.groups[index])).collect();
        match found[..] {
            [first, ref rest @ ..]
                if rest.iter().all(|&k| self.groups[k].equals(&self.groups[first])) =>
            {
                Ok(&self.groups[first])
            }
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

/// Returns the Levenshtein distance of two words: the least number of inserted, removed and replaced letters. Capital
/// and small letters are equal.
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
        let (points, lines, quadrilaterals) = (0, 0, Vec::new());
        let (triangles, vertices, edges) = (Vec::new(), Vec::new(), Vec::new());
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
            edges,
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

    /// Groups with equal names are identified by their tags. If a name equals the tag of another group, the kind
    /// precedes the name.
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
    fn a_name_of_several_groups_with_the_same_elements_is_not_ambiguous() {
        let with = |group: Group, triangles: &[u32]| {
            let vertices = triangles.iter().flat_map(|t| [*t, t + 1, t + 2]).collect();
            Group { triangles: triangles.to_vec(), vertices, ..group }
        };
        let [physical, entity] = ["physical", "entity"].map(|kind| group(kind, 2, None, Some(3)));
        let find = |own: &[u32], other: &[u32]| {
            let groups = vec![with(physical.clone(), own), with(entity.clone(), other)];
            Groups { groups }.find("3").map(|group| group.kind.clone())
        };
        assert_eq!(find(&[0, 4], &[0, 4]).unwrap(), "physical");
        assert!(matches!(find(&[0, 4], &[0]), Err(GroupError::Ambiguous { .. })));
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
