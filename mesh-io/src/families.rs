//! The table of formats: how each is recognized, and its reader.

use crate::compress::packed;
use crate::disk::source::file_name;
use crate::format::Format;
use crate::formats::vtk::{legacy, xml};
use crate::formats::{
    abaqus, adcirc, cgns, container, exodus, freefem, fvcom, gmsh, jigsaw, med, mfem, mike,
    nastran, obj, off, ply, selafin, sms, stl, triangle, ugrid, xdmf,
};
use crate::formats::{medit, su2};
use crate::visit::reader::{Reader, Walk};
use std::path::Path;

const fn reader<W: Walk>() -> Reader {
    Reader::of::<W>()
}

/// A row of the table: formats that one reader reads, or a format that only messages name. To add a format, add a row,
/// a variant of [`Format`], and a file with its [`Walk`].
pub(crate) struct Family {
    pub(crate) name: &'static str,
    /// Endings of file names that belong to this format, the usual one first.
    pub(crate) endings: &'static [&'static str],
    /// The first bytes of a file of this format, after blanks and comment lines. Empty for formats that are told by
    /// their first rows of numbers.
    pub(crate) opens: &'static [&'static [u8]],
    /// The reader. `None` for formats that are not read.
    pub(crate) reader: Option<Reader>,
    /// What to do with a file of a format that is not read. If empty, the message lists the formats that are read.
    pub(crate) instead: &'static str,
}

impl Family {
    /// Returns the row of a format.
    pub(crate) fn of(format: Format) -> &'static Family {
        match format {
            Format::Triangle => &TRIANGLE,
            Format::Gmsh22
            | Format::Gmsh22Binary
            | Format::Gmsh40
            | Format::Gmsh40Binary
            | Format::Gmsh41
            | Format::Gmsh41Binary => &GMSH,
            Format::Vtk | Format::VtkBinary => &VTK,
            Format::Vtu => &VTK_XML,
            Format::Vtp => &VTK_XML_POLYGONS,
            Format::Su2 => &SU2,
            Format::Medit => &MEDIT,
            Format::MeditBinary => &MEDIT_BINARY,
            Format::Obj => &OBJ,
            Format::Off => &OFF,
            Format::Ply | Format::PlyBinary => &PLY,
            Format::Adcirc => &ADCIRC,
            Format::Sms2dm => &SMS,
            Format::Mike => &MIKE,
            Format::Fvcom => &FVCOM,
            Format::Mfem => &MFEM,
            Format::Jigsaw => &JIGSAW,
            Format::FreeFem => &FREEFEM,
            Format::Selafin => &SELAFIN,
            Format::Stl | Format::StlBinary => &STL,
            Format::Exodus => &EXODUS,
            Format::Ugrid => &UGRID,
            Format::Med => &MED,
            Format::Cgns => &CGNS,
            Format::Xdmf => &XDMF,
            Format::Abaqus => &ABAQUS,
            Format::Nastran => &NASTRAN,
        }
    }

    /// Whether meshes of this format are read.
    pub(crate) fn is_read(&self) -> bool {
        self.reader.is_some()
    }

    /// Whether the path ends as files of this format do, compressed or not, in capital or small letters.
    pub(crate) fn has_ending_of(&self, path: &Path) -> bool {
        let name = packed::inner_name(&file_name(path).to_ascii_lowercase()).to_owned();
        self.endings.iter().any(|ending| name.ends_with(ending))
    }
}

const fn family(
    name: &'static str,
    endings: &'static [&'static str],
    opens: &'static [&'static [u8]],
    reader: Reader,
) -> Family {
    Family { name, endings, opens, reader: Some(reader), instead: "" }
}

/// Makes a row for a format that is not read.
const fn unread(
    name: &'static str,
    endings: &'static [&'static str],
    opens: &'static [&'static [u8]],
    instead: &'static str,
) -> Family {
    Family { name, endings, opens, reader: None, instead }
}

pub(crate) static TRIANGLE: Family =
    family("Triangle .node/.ele", &[".node", ".ele"], &[], reader::<triangle::Triangle>());
static GMSH: Family =
    family("gmsh", &[".msh"], &[b"$MeshFormat", b"$Comments"], reader::<gmsh::Gmsh>());
static VTK: Family = family(
    "legacy VTK",
    &[".vtk"],
    &[b"# vtk DataFile", b"# VTK DataFile"],
    reader::<legacy::Vtk>(),
);
static SU2: Family =
    family("SU2", &[".su2"], &[b"NDIME", b"NZONE", b"IZONE", b"NELEM"], reader::<su2::read::Su2>());
static MEDIT: Family =
    family("Medit", &[".mesh"], &[b"MeshVersionFormatted"], reader::<medit::text::Medit>());
static MEDIT_BINARY: Family = family(
    "binary Medit",
    &[".meshb"],
    &[&[1, 0, 0, 0], &[0, 0, 0, 1]],
    reader::<medit::binary::MeditBinary>(),
);
static OBJ: Family = family(
    "Wavefront OBJ",
    &[".obj"],
    &[b"v ", b"v\t", b"mtllib ", b"o ", b"g ", b"vn ", b"vt "],
    reader::<obj::Obj>(),
);
static OFF: Family =
    family("OFF", &[".off"], &[b"OFF", b"COFF", b"NOFF", b"CNOFF"], reader::<off::Off>());
pub(crate) static ADCIRC: Family = family(
    "ADCIRC or SCHISM grid",
    &["fort.14", ".14", ".gr3", ".grd"],
    &[],
    reader::<adcirc::Adcirc>(),
);
static SMS: Family =
    family("SMS 2dm", &[".2dm"], &[b"MESH2D", b"mesh2d", b"Mesh2D"], reader::<sms::Sms>());
pub(crate) static MIKE: Family =
    family("MIKE (DHI)", &[".mesh"], &[b"100079 ", b"100079\t"], reader::<mike::Mike>());
static MFEM: Family = family("MFEM", &[".mesh"], &[b"MFEM mesh"], reader::<mfem::Mfem>());
static FVCOM: Family = family("FVCOM", &["_grd.dat"], &[b"Node Number"], reader::<fvcom::Fvcom>());
static JIGSAW: Family =
    family("JIGSAW", &[".msh"], &[b"MSHID", b"mshid"], reader::<jigsaw::Jigsaw>());
pub(crate) static FREEFEM: Family =
    family("FreeFem .msh", &[".msh"], &[], reader::<freefem::FreeFem>());
static SELAFIN: Family = family(
    "SELAFIN",
    &[".slf", ".sel", ".selafin"],
    &[&[0, 0, 0, 80], &[80, 0, 0, 0]],
    reader::<selafin::Selafin>(),
);
static VTK_XML: Family =
    family("VTK XML", &[".vtu", ".pvtu", ".pvd"], &[b"<VTKFile"], reader::<xml::Vtu>());
static VTK_XML_POLYGONS: Family =
    family("VTK XML polygons", &[".vtp"], &[b"<VTKFile"], reader::<xml::Vtu>());
pub(crate) static STL: Family =
    family("STL", &[".stl"], &[b"solid ", b"solid\n", b"solid\r"], reader::<stl::Stl>());
static PLY: Family = family("PLY", &[".ply"], &[b"ply\n", b"ply\r"], reader::<ply::Ply>());
static EXODUS: Family = family(
    "Exodus II",
    &[".exo", ".e", ".ex2", ".g", ".exoii", ".nc", ".nc4", ".h5", ".hdf5"],
    &[b"CDF\x01", b"CDF\x02", b"CDF\x05", b"\x89HDF"],
    reader::<exodus::Exodus>(),
);
static UGRID: Family = family(
    "UGRID",
    &[".nc", ".nc4", ".h5", ".hdf5"],
    &[b"CDF\x01", b"CDF\x02", b"CDF\x05", b"\x89HDF"],
    reader::<ugrid::Ugrid>(),
);
static MED: Family = family("MED", &[".med", ".h5", ".hdf5"], &[b"\x89HDF"], reader::<med::Med>());
/// Any of those in HDF5 or netCDF, where the ending does not tell which.
static CONTAINER: Family = family(
    "HDF5 or netCDF",
    &[".h5", ".hdf5", ".nc", ".nc4"],
    &[b"\x89HDF", b"CDF\x01", b"CDF\x02", b"CDF\x05"],
    reader::<container::Container>(),
);
static CGNS: Family =
    family("CGNS", &[".cgns", ".h5", ".hdf5"], &[b"\x89HDF"], reader::<cgns::Cgns>());
pub(crate) static XDMF: Family =
    family("XDMF", &[".xdmf", ".xmf", ".xdmf3"], &[b"<Xdmf"], reader::<xdmf::Xdmf>());
static ABAQUS: Family = family(
    "Abaqus",
    &[".inp"],
    &[
        b"**",
        b"*HEADING",
        b"*Heading",
        b"*heading",
        b"*NODE",
        b"*Node",
        b"*node",
        b"*PART",
        b"*Part",
        b"*INCLUDE",
        b"*Include",
    ],
    reader::<abaqus::Abaqus>(),
);
pub(crate) static NASTRAN: Family =
    family("Nastran", &[".bdf", ".nas"], &[b"BEGIN BULK"], reader::<nastran::Nastran>());
static GMSH_1: Family =
    unread("gmsh 1", &[], &[b"$NOD\n", b"$NOD\r"], "Open it in gmsh, and save it as version 4.1");

static UNV: Family =
    unread("I-DEAS universal", &[".unv"], &[], "Open it in gmsh, and save it as .msh");
static LS_DYNA: Family =
    unread("LS-DYNA", &[".k", ".key"], &[b"*KEYWORD", b"$# LS-DYNA"], BY_OTHERS);
static FLUENT: Family =
    unread("Fluent", &[".cas"], &[b"(0 \"", b"(1 \"", b"(2 2)", b"(2 3)"], BY_MESHIO);
static MFEM_OTHER: Family = unread(
    "nonconforming, NURBS or inline MFEM",
    &[],
    &[b"MFEM NC mesh", b"MFEM NURBS", b"MFEM INLINE"],
    "Save it as VTK: Mesh::PrintVTK of MFEM",
);
static DOLFIN: Family = unread("DOLFIN XML", &[], &[b"<dolfin"], BY_MESHIO);
static COMSOL: Family =
    unread("COMSOL", &[".mphtxt", ".mphbin"], &[b"# Created by COMSOL"], "Export the mesh as VTK");
static TECPLOT: Family =
    unread("Tecplot", &[".plt"], &[b"TITLE =", b"TITLE=", b"VARIABLES", b"#!TD"], BY_MESHIO);
static AVS: Family = unread("AVS-UCD", &[".avs", ".ucd"], &[], BY_MESHIO);
static NETGEN: Family = unread("Netgen", &[".vol"], &[b"mesh3d"], BY_MESHIO);
static FLAC: Family = unread("FLAC3D", &[".f3grid"], &[b"* FLAC3D", b"* GRIDPOINTS"], BY_MESHIO);
static PERMAS: Family = unread("PERMAS", &[".post"], &[b"!PERMAS"], BY_MESHIO);
static AFLR3: Family = unread("AFLR3 UGRID", &[".ugrid"], &[], BY_MESHIO);
static RADIOSS: Family =
    unread("Radioss", &[".rad"], &[b"#RADIOSS"], "Save the mesh as gmsh, VTK or SU2");
static X3D: Family = unread("X3D", &[".x3d"], &[b"<X3D"], "Save the mesh as PLY, OBJ or OFF");
static GEOMETRY: Family = unread(
    "a geometry without a mesh (CAD or .geo)",
    &[".step", ".stp", ".iges", ".igs", ".brep", ".geo"],
    &[b"ISO-10303-21"],
    "Mesh it first, with gmsh for example",
);

/// The remedy for a format that meshio reads.
const BY_MESHIO: &str = "Convert it to a format that is read, with meshio for example";
/// The remedy for a format that no common converter reads.
const BY_OTHERS: &str = "Export the mesh from its program as SMS 2dm, VTK or gmsh, or write its lists as Triangle's .node and .ele";

/// Every family, in the order in which contents are compared with them.
pub(crate) static FAMILIES: [&Family; 44] = [
    &TRIANGLE,
    &GMSH,
    &VTK,
    &SU2,
    &MEDIT,
    &MEDIT_BINARY,
    &OBJ,
    &OFF,
    &ADCIRC,
    &SMS,
    &MIKE,
    &FVCOM,
    &MFEM,
    &JIGSAW,
    &FREEFEM,
    &SELAFIN,
    &VTK_XML,
    &VTK_XML_POLYGONS,
    &STL,
    &PLY,
    &CONTAINER,
    &EXODUS,
    &UGRID,
    &MED,
    &CGNS,
    &XDMF,
    &ABAQUS,
    &NASTRAN,
    &GMSH_1,
    &UNV,
    &LS_DYNA,
    &FLUENT,
    &MFEM_OTHER,
    &DOLFIN,
    &COMSOL,
    &TECPLOT,
    &AVS,
    &NETGEN,
    &FLAC,
    &PERMAS,
    &AFLR3,
    &RADIOSS,
    &X3D,
    &GEOMETRY,
];
