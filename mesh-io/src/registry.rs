//! Registry of formats: the name, extensions, magic bytes and reader of each.

use crate::compress::file::inner_name;
use crate::disk::source::file_name;
use crate::format::Format;
use crate::formats::vtk::{legacy, xml};
use crate::formats::{
    abaqus, adcirc, cgns, exodus, freefem, fvcom, gmsh, hdf5_or_netcdf, jigsaw, med, mfem, mike,
    nastran, obj, off, ply, selafin, sms, stl, triangle, ugrid, xdmf,
};
use crate::formats::{medit, su2};
use crate::visit::reader::{FormatReader, ReaderFunctions};
use std::path::Path;

const fn reader<W: FormatReader>() -> ReaderFunctions {
    ReaderFunctions::of::<W>()
}

/// Entry of the registry: a reader with the formats it reads, or an unsupported format that only errors name.
pub(crate) struct FormatEntry {
    pub(crate) name: &'static str,
    /// Extensions of file names, the usual one first. Some are whole names, such as `fort.14`.
    pub(crate) extensions: &'static [&'static str],
    /// The first bytes of a file of the format, after blanks and comment lines. Empty for formats that are recognized
    /// by their first rows of numbers.
    pub(crate) magic: &'static [&'static [u8]],
    /// The reader; `None` for unsupported formats.
    pub(crate) reader: Option<ReaderFunctions>,
    /// Remedy in the error of an unsupported format. If empty, the error lists the supported formats.
    pub(crate) hint: &'static str,
}

impl FormatEntry {
    /// Returns whether meshes of the format are supported.
    pub(crate) fn is_read(&self) -> bool {
        self.reader.is_some()
    }

    /// Returns whether the path ends in one of the extensions, before the extension of a compression, in capital or
    /// small letters.
    pub(crate) fn matches_extension(&self, path: &Path) -> bool {
        let name = inner_name(&file_name(path).to_ascii_lowercase()).to_owned();
        self.extensions.iter().any(|ending| name.ends_with(ending))
    }
}

const fn entry(
    name: &'static str,
    endings: &'static [&'static str],
    opens: &'static [&'static [u8]],
    reader: ReaderFunctions,
) -> FormatEntry {
    FormatEntry { name, extensions: endings, magic: opens, reader: Some(reader), hint: "" }
}

/// Makes an entry for an unsupported format, whose error gives the remedy `instead`.
const fn unsupported(
    name: &'static str,
    endings: &'static [&'static str],
    opens: &'static [&'static [u8]],
    instead: &'static str,
) -> FormatEntry {
    FormatEntry { name, extensions: endings, magic: opens, reader: None, hint: instead }
}

/// Remedy for unsupported formats that meshio converts.
const BY_MESHIO: &str = "Convert it to a format that is read, with meshio for example";
/// Remedy for unsupported formats without a common converter.
const BY_OTHERS: &str = "Export the mesh from its program as SMS 2dm, VTK or gmsh, or write its lists as Triangle's .node and .ele";

/// Declares a static for each entry, the list [`REGISTRY`] of all entries, and [`FormatEntry::of`]. Compilation fails
/// if a [`Format`] has no entry.
macro_rules! families {
    ($($(#[$doc:meta])* $row:ident [$($format:ident),*] = $family:expr;)*) => {
        $($(#[$doc])* pub(crate) static $row: FormatEntry = $family;)*

        /// All entries, in the order in which contents are compared with magic bytes.
        pub(crate) static REGISTRY: &[&FormatEntry] = &[$(&$row),*];

        impl FormatEntry {
            /// Returns the entry of a format.
            pub(crate) fn of(format: Format) -> &'static FormatEntry {
                match format {
                    $($(Format::$format => &$row,)*)*
                }
            }
        }
    };
}

// Contents are compared with the magic bytes in this order of rows. The brackets hold the formats of a row.
families! {
    TRIANGLE [Triangle] = entry(
        "Triangle .node/.ele",
        &[".node", ".ele"],
        &[],
        reader::<triangle::Triangle>(),
    );
    GMSH [Gmsh1, Gmsh22, Gmsh22Binary, Gmsh40, Gmsh40Binary, Gmsh41, Gmsh41Binary] = entry(
        "gmsh",
        &[".msh"],
        &[b"$MeshFormat", b"$Comments", b"$NOD\n", b"$NOD\r", b"$NOD "],
        reader::<gmsh::Gmsh>(),
    );
    VTK [Vtk, VtkBinary] = entry(
        "legacy VTK",
        &[".vtk"],
        &[b"# vtk DataFile", b"# VTK DataFile"],
        reader::<legacy::Vtk>(),
    );
    SU2 [Su2] = entry(
        "SU2",
        &[".su2"],
        &[b"NDIME", b"NZONE", b"IZONE", b"NELEM"],
        reader::<su2::read::Su2>(),
    );
    MEDIT [Medit] = entry(
        "Medit",
        &[".mesh"],
        &[b"MeshVersionFormatted"],
        reader::<medit::text::Medit>(),
    );
    MEDIT_BINARY [MeditBinary] = entry(
        "binary Medit",
        &[".meshb"],
        &[&[1, 0, 0, 0], &[0, 0, 0, 1]],
        reader::<medit::binary::MeditBinary>(),
    );
    OBJ [Obj] = entry(
        "Wavefront OBJ",
        &[".obj"],
        &[b"v ", b"v\t", b"mtllib ", b"o ", b"g ", b"vn ", b"vt "],
        reader::<obj::Obj>(),
    );
    OFF [Off] = entry(
        "OFF",
        &[".off"],
        &[b"OFF", b"COFF", b"NOFF", b"CNOFF"],
        reader::<off::Off>(),
    );
    ADCIRC [Adcirc] = entry(
        "ADCIRC or SCHISM grid",
        &["fort.14", ".14", ".gr3", ".grd"],
        &[],
        reader::<adcirc::Adcirc>(),
    );
    SMS [Sms2dm] = entry(
        "SMS 2dm",
        &[".2dm"],
        &[b"MESH2D", b"mesh2d", b"Mesh2D"],
        reader::<sms::Sms>(),
    );
    MIKE [Mike] = entry(
        "MIKE (DHI)",
        &[".mesh"],
        &[b"100079 ", b"100079\t"],
        reader::<mike::Mike>(),
    );
    FVCOM [Fvcom] = entry("FVCOM", &["_grd.dat"], &[b"Node Number"], reader::<fvcom::Fvcom>());
    MFEM [Mfem] = entry("MFEM", &[".mesh"], &[b"MFEM mesh"], reader::<mfem::Mfem>());
    JIGSAW [Jigsaw] = entry(
        "JIGSAW",
        &[".msh"],
        &[b"MSHID", b"mshid"],
        reader::<jigsaw::Jigsaw>(),
    );
    FREEFEM [FreeFem] = entry("FreeFem .msh", &[".msh"], &[], reader::<freefem::FreeFem>());
    SELAFIN [Selafin] = entry(
        "SELAFIN",
        &[".slf", ".sel", ".selafin"],
        &[&[0, 0, 0, 80], &[80, 0, 0, 0]],
        reader::<selafin::Selafin>(),
    );
    VTK_XML [Vtu] = entry(
        "VTK XML",
        &[".vtu", ".pvtu", ".pvd"],
        &[b"<VTKFile"],
        reader::<xml::Vtu>(),
    );
    VTK_XML_POLYGONS [Vtp] = entry(
        "VTK XML polygons",
        &[".vtp"],
        &[b"<VTKFile"],
        reader::<xml::Vtu>(),
    );
    STL [Stl, StlBinary] = entry(
        "STL",
        &[".stl"],
        &[b"solid ", b"solid\t", b"solid\n", b"solid\r"],
        reader::<stl::Stl>(),
    );
    PLY [Ply, PlyBinary] = entry("PLY", &[".ply"], &[b"ply\n", b"ply\r"], reader::<ply::Ply>());
    /// Any format in HDF5 or netCDF, for files whose extension does not decide between these formats.
    CONTAINER [] = entry(
        "HDF5 or netCDF",
        &[".h5", ".hdf5", ".nc", ".nc4"],
        &[b"\x89HDF", b"CDF\x01", b"CDF\x02", b"CDF\x05"],
        reader::<hdf5_or_netcdf::Hdf5OrNetcdf>(),
    );
    EXODUS [Exodus] = entry(
        "Exodus II",
        &[".exo", ".e", ".ex2", ".g", ".exoii", ".nc", ".nc4", ".h5", ".hdf5"],
        &[b"CDF\x01", b"CDF\x02", b"CDF\x05", b"\x89HDF"],
        reader::<exodus::Exodus>(),
    );
    UGRID [Ugrid] = entry(
        "UGRID",
        &[".nc", ".nc4", ".h5", ".hdf5"],
        &[b"CDF\x01", b"CDF\x02", b"CDF\x05", b"\x89HDF"],
        reader::<ugrid::Ugrid>(),
    );
    MED [Med] = entry("MED", &[".med", ".h5", ".hdf5"], &[b"\x89HDF"], reader::<med::Med>());
    CGNS [Cgns] = entry("CGNS", &[".cgns", ".h5", ".hdf5"], &[b"\x89HDF"], reader::<cgns::Cgns>());
    XDMF [Xdmf] = entry("XDMF", &[".xdmf", ".xmf", ".xdmf3"], &[b"<Xdmf"], reader::<xdmf::Xdmf>());
    ABAQUS [Abaqus] = entry(
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
    NASTRAN [Nastran] = entry(
        "Nastran",
        &[".bdf", ".nas"],
        &[b"BEGIN BULK"],
        reader::<nastran::Nastran>(),
    );
    UNV [] = unsupported("I-DEAS universal", &[".unv"], &[], "Open it in gmsh, and save it as .msh");
    LS_DYNA [] = unsupported("LS-DYNA", &[".k", ".key"], &[b"*KEYWORD", b"$# LS-DYNA"], BY_OTHERS);
    FLUENT [] = unsupported("Fluent", &[".cas"], &[b"(0 \"", b"(1 \"", b"(2 2)", b"(2 3)"], BY_MESHIO);
    MFEM_OTHER [] = unsupported(
        "nonconforming, NURBS or inline MFEM",
        &[],
        &[b"MFEM NC mesh", b"MFEM NURBS", b"MFEM INLINE"],
        "Save it as VTK: Mesh::PrintVTK of MFEM",
    );
    CGNS_ADF [] = unsupported(
        "CGNS in ADF",
        &[],
        &[b"@(#)ADF Database"],
        "Convert it to HDF5, with the tool of CGNS: adf2hdf IN OUT",
    );
    KRATOS [] = unsupported(
        "Kratos",
        &[".mdpa"],
        &[b"Begin ModelPartData", b"Begin Properties", b"Begin Nodes", b"Begin Table"],
        BY_MESHIO,
    );
    SHYFEM [] = unsupported("SHYFEM", &[".bas"], &[], BY_OTHERS);
    TELEMAC_BOUNDARY [] = unsupported(
        "a list of boundary conditions (TELEMAC)",
        &[".cli"],
        &[],
        "Name the mesh that the list belongs to, its .slf",
    );
    SURFER [] = unsupported(
        "a grid of heights without a mesh (Surfer)",
        &[],
        &[b"DSAA", b"DSBB", b"DSRB"],
        "Name the mesh whose vertices have the heights",
    );
    DOLFIN [] = unsupported("DOLFIN XML", &[], &[b"<dolfin"], BY_MESHIO);
    COMSOL [] = unsupported(
        "COMSOL",
        &[".mphtxt", ".mphbin"],
        &[b"# Created by COMSOL"],
        "Export the mesh as VTK",
    );
    TECPLOT [] = unsupported(
        "Tecplot",
        &[".plt"],
        &[b"TITLE =", b"TITLE=", b"VARIABLES", b"#!TD"],
        BY_MESHIO,
    );
    AVS [] = unsupported("AVS-UCD", &[".avs", ".ucd"], &[], BY_MESHIO);
    NETGEN [] = unsupported("Netgen", &[".vol"], &[b"mesh3d"], BY_MESHIO);
    FLAC [] = unsupported("FLAC3D", &[".f3grid"], &[b"* FLAC3D", b"* GRIDPOINTS"], BY_MESHIO);
    PERMAS [] = unsupported("PERMAS", &[".post"], &[b"!PERMAS"], BY_MESHIO);
    AFLR3 [] = unsupported("AFLR3 UGRID", &[".ugrid"], &[], BY_MESHIO);
    RADIOSS [] = unsupported("Radioss", &[".rad"], &[b"#RADIOSS"], "Save the mesh as gmsh, VTK or SU2");
    X3D [] = unsupported("X3D", &[".x3d"], &[b"<X3D"], "Save the mesh as PLY, OBJ or OFF");
    GEOMETRY [] = unsupported(
        "a geometry without a mesh (CAD or .geo)",
        &[".step", ".stp", ".iges", ".igs", ".brep", ".geo"],
        &[b"ISO-10303-21"],
        "Mesh it first, with gmsh for example",
    );
}
