//! The formats that are read and written.

use std::fmt;

/// A file format that is read and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// The `.node` and `.ele` of the mesh generator Triangle, with the segments of a `.poly`
    /// beside them.
    Triangle,
    /// gmsh's `.msh`, versions 2.0 to 2.2, as text.
    Gmsh22,
    /// gmsh's `.msh`, versions 2.0 to 2.2, in binary.
    Gmsh22Binary,
    /// gmsh's `.msh`, version 4.0, as text.
    Gmsh40,
    /// gmsh's `.msh`, version 4.0, in binary.
    Gmsh40Binary,
    /// gmsh's `.msh`, version 4.1, as text.
    Gmsh41,
    /// gmsh's `.msh`, version 4.1, in binary.
    Gmsh41Binary,
    /// VTK's legacy `.vtk`, versions 1.0 to 5.1, as text.
    Vtk,
    /// VTK's legacy `.vtk`, versions 1.0 to 5.1, in binary.
    VtkBinary,
    /// VTK's XML format of unstructured grids, `.vtu`.
    Vtu,
    /// VTK's XML format of polygonal data, `.vtp`.
    Vtp,
    /// SU2's `.su2`.
    Su2,
    /// Medit's `.mesh`.
    Medit,
    /// Medit's `.meshb`, versions 1 to 4.
    MeditBinary,
    /// Wavefront's `.obj`.
    Obj,
    /// Geomview's `.off`, as text.
    Off,
    /// PLY, as text.
    Ply,
    /// PLY, in binary of either byte order.
    PlyBinary,
    /// The grid of ADCIRC (`fort.14`) and SCHISM (`.gr3`).
    Adcirc,
    /// SMS's `.2dm`.
    Sms2dm,
    /// MIKE's `.mesh` (DHI).
    Mike,
    /// FVCOM's grid, `CASE_grd.dat`.
    Fvcom,
    /// MFEM's `.mesh`.
    Mfem,
    /// JIGSAW's `.msh`.
    Jigsaw,
    /// FreeFem's `.msh`.
    FreeFem,
    /// TELEMAC's SELAFIN, in either byte order and precision.
    Selafin,
    /// STL, as text, with corners at the same place joined.
    Stl,
    /// STL, in binary, with corners at the same place joined.
    StlBinary,
    /// Exodus II, in netCDF's classic formats and in netCDF-4.
    Exodus,
    /// UGRID, in netCDF's classic formats and in netCDF-4.
    Ugrid,
    /// MED, of Salome and Code_Aster, versions 3 and 4.
    Med,
    /// CGNS, in HDF5.
    Cgns,
    /// XDMF, with its numbers in the XML or in files beside it, HDF5 or raw.
    Xdmf,
    /// The `.inp` of Abaqus and CalculiX.
    Abaqus,
    /// Bulk data of Nastran.
    Nastran,
}

impl Format {
    /// Every format.
    pub const ALL: [Format; 35] = [
        Format::Triangle,
        Format::Gmsh22,
        Format::Gmsh22Binary,
        Format::Gmsh40,
        Format::Gmsh40Binary,
        Format::Gmsh41,
        Format::Gmsh41Binary,
        Format::Vtk,
        Format::VtkBinary,
        Format::Vtu,
        Format::Vtp,
        Format::Su2,
        Format::Medit,
        Format::MeditBinary,
        Format::Obj,
        Format::Off,
        Format::Ply,
        Format::PlyBinary,
        Format::Adcirc,
        Format::Sms2dm,
        Format::Mike,
        Format::Fvcom,
        Format::Mfem,
        Format::Jigsaw,
        Format::FreeFem,
        Format::Selafin,
        Format::Stl,
        Format::StlBinary,
        Format::Exodus,
        Format::Ugrid,
        Format::Med,
        Format::Cgns,
        Format::Xdmf,
        Format::Abaqus,
        Format::Nastran,
    ];

    /// Returns the name for messages.
    const fn name(self) -> &'static str {
        match self {
            Format::Triangle => "Triangle .node/.ele",
            Format::Gmsh22 => "gmsh 2.2 ASCII",
            Format::Gmsh22Binary => "gmsh 2.2 binary",
            Format::Gmsh40 => "gmsh 4.0 ASCII",
            Format::Gmsh40Binary => "gmsh 4.0 binary",
            Format::Gmsh41 => "gmsh 4.1 ASCII",
            Format::Gmsh41Binary => "gmsh 4.1 binary",
            Format::Vtk => "legacy VTK ASCII",
            Format::VtkBinary => "legacy VTK binary",
            Format::Vtu => "VTK XML",
            Format::Vtp => "VTK XML polygons",
            Format::Su2 => "SU2",
            Format::Medit => "Medit ASCII",
            Format::MeditBinary => "Medit binary",
            Format::Obj => "Wavefront OBJ",
            Format::Off => "OFF",
            Format::Ply => "PLY ASCII",
            Format::PlyBinary => "PLY binary",
            Format::Adcirc => "ADCIRC or SCHISM grid",
            Format::Sms2dm => "SMS 2dm",
            Format::Mike => "MIKE mesh",
            Format::Fvcom => "FVCOM grid",
            Format::Mfem => "MFEM mesh",
            Format::Jigsaw => "JIGSAW .msh",
            Format::FreeFem => "FreeFem .msh",
            Format::Selafin => "SELAFIN",
            Format::Stl => "STL ASCII",
            Format::StlBinary => "STL binary",
            Format::Exodus => "Exodus II",
            Format::Ugrid => "UGRID",
            Format::Med => "MED",
            Format::Cgns => "CGNS",
            Format::Xdmf => "XDMF",
            Format::Abaqus => "Abaqus",
            Format::Nastran => "Nastran",
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
