//! MED, the format of Salome and Code_Aster, versions 3 and 4, in HDF5.
//!
//! The format: <https://docs.salome-platform.org/latest/dev/MEDCoupling/developer/med-file.html>. Coordinates are
//! stored axis by axis, elements type by type, and the nodes of a type corner by corner. Nodes and elements have a
//! family, a number that stands for groups.

mod families;
pub(crate) mod write;

use crate::binary::byte_order::{ByteOrder, IntegerType};
use crate::binary::number_field::NumberField;
use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::axes::{Axes, BinaryReals};
use crate::hdf5::{Datatype, Hdf5, Object, SIGNATURE};
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::quoted;
use crate::visit::items::{CellKind, RegionAttribute};
use crate::visit::reader::FormatReader;
use crate::visit::records::Region;
use crate::visit::rows::volume;
use crate::visit::send::ElementRecords;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use families::Families;

pub(crate) struct Med;

/// A MED file, with the HDF5 groups of its only mesh and of the mesh's only time step.
struct File<'a> {
    source: &'a Source,
    hdf5: &'a Hdf5<'a>,
    mesh: &'a Object,
    name: &'a [u8],
    step: &'a Object,
}

/// The path of the HDF5 group that contains the meshes of a file.
const MESHES: &[u8] = b"ENS_MAA";

/// Returns whether a file is HDF5 with a group of MED meshes.
pub(crate) fn is_in(source: &Source) -> Result<bool, ReadError> {
    Ok(source.bytes.starts_with(SIGNATURE) && Hdf5::open(source)?.find(MESHES).is_some())
}

impl FormatReader for Med {
    const VERTICES: &'static str = "the list of nodes";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        Hdf5::read(source, |hdf5| File::open(source, hdf5)?.read(visitor))
    }
}

impl<'a> File<'a> {
    fn open(source: &'a Source, hdf5: &'a Hdf5<'a>) -> Result<File<'a>, ReadError> {
        let start = || Cursor::at_byte_offset(source, 0);
        let meshes = hdf5.find(MESHES).map(|all| hdf5.children(all).collect::<Vec<_>>());
        let (name, mesh) = match meshes.as_deref() {
            Some(&[one]) => one,
            Some([]) | None => {
                return Err(start().error("the file holds no mesh", "Save a mesh with it"));
            }
            Some(several) => {
                let problem = format!("a MED file of {} meshes is not read", several.len());
                return Err(start().error(problem, "Save each mesh to a separate file"));
            }
        };
        let whole = |name: &[u8]| hdf5.attribute(mesh, name).and_then(|a| a.whole());
        let refused = |problem: &str, remedy| {
            Err(Cursor::at_byte_offset(source, mesh.at).error(problem.to_owned(), remedy))
        };
        if whole(b"TYP").is_some_and(|kind| kind != 0) {
            return refused("a structured mesh is not read", "Save an unstructured mesh");
        }
        if whole(b"REP").is_some_and(|system| system != 0) {
            return refused("its coordinates are not Cartesian", "Save Cartesian coordinates");
        }
        let steps: Vec<_> = hdf5
            .children(mesh)
            .filter(|(name, _)| {
                name.first().is_some_and(|first| *first == b'-' || first.is_ascii_digit())
            })
            .collect();
        match steps[..] {
            [(_, step)] => Ok(File { source, hdf5, mesh, name, step }),
            [] => refused(
                "the mesh has no time step, as MED has since version 3",
                "Save it again with a newer version of MED",
            ),
            _ => refused(
                "a mesh of several time steps is not read",
                "Save the mesh of one time step",
            ),
        }
    }

    fn read(&self, visitor: &mut dyn MeshVisitor) -> Result<CoordinateStorage, ReadError> {
        let (axes, count) = self.nodes()?;
        let layout = axes.send(Format::Med, count, 1, visitor)?;
        let label = |family| (family != 0).then_some(GroupLabel::Tag(family));
        visitor.region_attributes(vec![RegionAttribute {
            kind: "family".into(),
            from_dimension: 0,
            label,
        }]);
        let families = match visitor.asks_for_groups() {
            true => Families::read(self.hdf5, self.name),
            false => Families::default(),
        };
        if visitor.asks_for_groups() {
            let of_nodes =
                self.hdf5.child(self.step, b"NOE/FAM").and_then(|own| self.hdf5.integers(own));
            let of_nodes = of_nodes.unwrap_or_default();
            families.names(&of_nodes, visitor);
            for (node, &family) in of_nodes.iter().enumerate().take(count) {
                families.of_node(node as u32, family, visitor);
            }
        }
        let Some(types) = self.hdf5.child(self.step, b"MAI") else {
            return Err(self.cursor(self.mesh).error("the mesh has no elements", CORRECT));
        };
        for (name, object) in self.hdf5.children(types) {
            self.elements(name, object, &families, visitor)?;
        }
        visitor.group_scopes(&[]);
        if visitor.asks_for_data() {
            let numbers = self.hdf5.child(self.step, b"NOE/NUM");
            let numbers = numbers.and_then(|own| self.hdf5.integers(own)).unwrap_or_default();
            if !numbers.iter().copied().eq(1..=numbers.len() as i64) {
                visitor.unsupported("numbers of nodes (NUM)");
            }
            for (name, what) in [(&b"EQS"[..], "equivalences (EQS)"), (b"JNT", "joints (JNT)")] {
                if self.hdf5.child(self.mesh, name).is_some() {
                    visitor.unsupported(what);
                }
            }
        }
        if self.hdf5.find(b"CHA").is_some() {
            let text = "its fields (CHA) are kept as they are, and do not fit nodes that move";
            visitor.remark(Remark::Text(text.into()));
            if visitor.asks_for_data() {
                visitor.unsupported("fields");
            }
        }
        Ok(layout)
    }

    fn cursor(&self, object: &Object) -> Cursor<'a> {
        Cursor::at_byte_offset(self.source, object.at)
    }

    /// Returns the coordinates, and how many nodes have coordinates.
    fn nodes(&self) -> Result<(Axes<'a>, usize), ReadError> {
        let object = self.hdf5.child(self.step, b"NOE/COO");
        let dataset = object.map(|object| self.hdf5.dataset(object)).transpose()?.flatten();
        let (Some(object), Some(dataset)) = (object, dataset) else {
            return Err(self
                .cursor(self.mesh)
                .error("the mesh has no nodes", "Save the mesh again"));
        };
        let cursor = self.cursor(object);
        let Datatype::Real(precision, order) = dataset.datatype else {
            return Err(cursor.error("the coordinates are not real numbers", "Save the mesh again"));
        };
        let axes = self.hdf5.attribute(self.mesh, b"ESP").and_then(|axes| axes.whole());
        let array = self.hdf5.array(&dataset)?;
        let numbers = array.bytes.len() / precision.bytes();
        let Some(axes @ 2..=3) =
            axes.map(|axes| axes as usize).filter(|axes| numbers.is_multiple_of((*axes).max(1)))
        else {
            let problem = format!(
                "the mesh has {numbers} coordinates, which are not two or three for each node"
            );
            return Err(cursor.error(problem, "Save a mesh of the plane"));
        };
        let count = numbers / axes;
        cursor.check_vertex_count(count as u64)?;
        Ok((
            Axes::of_arrays(self.hdf5, BinaryReals { order, precision }, vec![array], axes, count),
            count,
        ))
    }

    /// Visits the elements of a type, such as `TR3`. `object` is the HDF5 group of the type.
    fn elements(
        &self,
        name: &[u8],
        object: &Object,
        families: &Families,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        let cursor = self.cursor(object);
        let kind = match name {
            b"PO1" => CellKind::Point,
            b"SE2" => CellKind::Line,
            b"TR3" => CellKind::Triangle,
            b"QU4" => CellKind::Quadrilateral,
            _ if [&b"TE"[..], b"HE", b"PE", b"PY", b"POE"]
                .iter()
                .any(|kind| name.starts_with(kind)) =>
            {
                return Err(volume(&cursor, &format!("elements of the type {}", quoted(name))));
            }
            _ => {
                let problem = format!("elements of the type {} are not read", quoted(name));
                let remedy = "Save triangles of three nodes (TR3), beside PO1, SE2 and QU4";
                return Err(cursor.error(problem, remedy));
            }
        };
        let of_families = self.hdf5.child(object, b"FAM").and_then(|own| self.hdf5.integers(own));
        let of_families = of_families.unwrap_or_default();
        let own = self.hdf5.child(object, b"NOD");
        let dataset = own.map(|own| self.hdf5.dataset(own)).transpose()?.flatten();
        let Some((dataset, Datatype::Whole(IntegerType { bytes: size, .. }, order))) =
            dataset.map(|own| {
                let number = own.datatype;
                (own, number)
            })
        else {
            let problem = format!("the type {} has no list of nodes", quoted(name));
            return Err(cursor.error(problem, "Save the mesh again"));
        };
        let array = self.hdf5.array(&dataset)?;
        let count = array.bytes.len() / size / kind.nodes();
        if array.bytes.len() != count * kind.nodes() * size {
            let problem =
                format!("the type {} has a list of nodes that is cut short", quoted(name));
            return Err(cursor.error(problem, CORRECT));
        }
        // The file stores the first corners of all elements, then the second corners, and so on. The visitor takes the
        // corners of an element side by side.
        let corner = |element: usize, corner: usize| {
            order.whole(&array.bytes[(corner * count + element) * size..][..size])
        };
        let corners = kind.nodes();
        let each = (0..count).flat_map(|element| (0..corners).map(move |k| (element, k)));
        let wide = |(element, k)| corner(element, k).to_le_bytes();
        let side_by_side: Vec<u8> = each.flat_map(wide).collect();
        let elements = ElementRecords {
            kind,
            count,
            first_tag: 1,
            nodes: NumberField::new(Some(&side_by_side), 8 * corners, 8, ByteOrder::Little),
            is_signed: false,
            regions: [Region::List(&of_families), Region::Same(0)],
        };
        let mut last = None;
        elements.send(visitor, |element, visitor| {
            let family = of_families.get(element).copied().unwrap_or(0);
            if visitor.asks_for_groups() && last != Some(family) {
                families.of_elements(family, visitor);
                last = Some(family);
            }
            Cursor::at_byte_offset(self.source, array.byte_of(element * size))
        })
    }
}
