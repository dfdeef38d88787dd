//! The families of a MED file: each node and element belongs to one family, and a family stands for groups.

use crate::content::group_label::GroupLabel;
use crate::hdf5::{Hdf5, Object};
use crate::visit::items::GroupScope;
use crate::visit::visitor::MeshVisitor;
use std::collections::{BTreeMap, BTreeSet};

/// Maps the families of a mesh to their groups.
#[derive(Default)]
pub(super) struct Families {
    /// For each family number, the indices of the family's groups in `names`.
    groups: BTreeMap<i64, Vec<usize>>,
    names: Vec<Vec<u8>>,
}

/// The length of a group name in bytes, padding included.
const NAME_LENGTH: usize = 80;

impl Families {
    /// Reads the families of nodes and elements of the mesh named `mesh`. Damaged families are left out.
    pub(super) fn read(file: &Hdf5<'_>, mesh: &[u8]) -> Families {
        let mut families = Families::default();
        let path = [&b"FAS/"[..], mesh].concat();
        let Some(all) = file.find(&path) else { return families };
        for of in [&b"NOEUD"[..], b"ELEME"] {
            let Some(group) = file.child(all, of) else { continue };
            for (_, family) in file.children(group) {
                families.add(file, family);
            }
        }
        families
    }

    fn add(&mut self, file: &Hdf5<'_>, family: &Object) {
        let number = file.attribute(family, b"NUM").and_then(|number| number.whole());
        let names = file.child(family, b"GRO/NOM").and_then(|names| file.dataset(names).ok()?);
        let array = names.and_then(|names| file.array(&names).ok());
        let (Some(number), Some(array)) = (number, array) else { return };
        for name in array.bytes.chunks_exact(NAME_LENGTH) {
            let name = name.split(|&byte| byte == 0).next().unwrap_or_default().trim_ascii();
            let known = self.names.iter().position(|own| own == name);
            let group = known.unwrap_or_else(|| {
                self.names.push(name.to_vec());
                self.names.len() - 1
            });
            self.groups.entry(number).or_default().push(group);
        }
    }

    fn of(&self, family: i64) -> &[usize] {
        self.groups.get(&family).map(Vec::as_slice).unwrap_or_default()
    }

    /// Visits the groups of a family as the groups of all elements that follow.
    pub(super) fn of_elements(&self, family: i64, visitor: &mut dyn MeshVisitor) {
        let within = |&group: &usize| GroupScope {
            kind: "group",
            label: GroupLabel::name(&self.names[group]),
            dimension: None,
        };
        let groups: Vec<GroupScope<'_>> = self.of(family).iter().map(within).collect();
        visitor.group_scopes(&groups);
    }

    /// Visits the groups of a node's family. The tag of a group is its index in `names` plus one.
    pub(super) fn of_node(&self, node: u32, family: i64, visitor: &mut dyn MeshVisitor) {
        for &group in self.of(family) {
            visitor.node_group(node, "group", &GroupLabel::Tag(group as i64 + 1));
        }
    }

    /// Visits the names of the groups that have nodes. `of_nodes` is the family of each node.
    pub(super) fn names(&self, of_nodes: &[i64], visitor: &mut dyn MeshVisitor) {
        let families: BTreeSet<i64> = of_nodes.iter().copied().collect();
        let groups: BTreeSet<usize> =
            families.into_iter().flat_map(|family| self.of(family)).copied().collect();
        for group in groups {
            visitor.group_name("group", Some(0), group as i64 + 1, &self.names[group]);
        }
    }
}
