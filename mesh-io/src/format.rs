//! The formats that are read and written.

use std::fmt;

/// Makes the enum, [`Format::ALL`] and the names for messages from one row per format.
macro_rules! formats {
    ($($(#[$doc:meta])* $variant:ident = $name:literal;)*) => {
        /// A file format that is read and written.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Format {
            $($(#[$doc])* $variant,)*
        }

        impl Format {
            /// Every format.
            pub const ALL: [Format; [$(Format::$variant),*].len()] = [$(Format::$variant),*];

            /// Returns the name for messages.
            const fn name(self) -> &'static str {
                match self {
                    $(Format::$variant => $name,)*
                }
            }
        }
    };
}

formats! {
    /// The `.node` and `.ele` of the mesh generator Triangle, with the segments of a `.poly`
    /// beside them.
    Triangle = "Triangle .node/.ele";
    /// gmsh's `.msh`, version 1, as text.
    Gmsh1 = "gmsh 1 ASCII";
    /// gmsh's `.msh`, versions 2.0 to 2.2, as text.
    Gmsh22 = "gmsh 2.2 ASCII";
    /// gmsh's `.msh`, versions 2.0 to 2.2, in binary.
    Gmsh22Binary = "gmsh 2.2 binary";
    /// gmsh's `.msh`, version 4.0, as text.
    Gmsh40 = "gmsh 4.0 ASCII";
    /// gmsh's `.msh`, version 4.0, in binary.
    Gmsh40Binary = "gmsh 4.0 binary";
    /// gmsh's `.msh`, version 4.1, as text.
    Gmsh41 = "gmsh 4.1 ASCII";
    /// gmsh's `.msh`, version 4.1, in binary.
    Gmsh41Binary = "gmsh 4.1 binary";
    /// VTK's legacy `.vtk`, versions 1.0 to 5.1, as text.
    Vtk = "legacy VTK ASCII";
    /// VTK's legacy `.vtk`, versions 1.0 to 5.1, in binary.
    VtkBinary = "legacy VTK binary";
    /// VTK's XML format of unstructured grids, `.vtu`.
    Vtu = "VTK XML";
    /// VTK's XML format of polygonal data, `.vtp`.
    Vtp = "VTK XML polygons";
    /// SU2's `.su2`.
    Su2 = "SU2";
    /// Medit's `.mesh`.
    Medit = "Medit ASCII";
    /// Medit's `.meshb`, versions 1 to 4.
    MeditBinary = "Medit binary";
    /// Wavefront's `.obj`.
    Obj = "Wavefront OBJ";
    /// Geomview's `.off`, as text.
    Off = "OFF";
    /// PLY, as text.
    Ply = "PLY ASCII";
    /// PLY, in binary of either byte order.
    PlyBinary = "PLY binary";
    /// The grid of ADCIRC (`fort.14`) and SCHISM (`.gr3`).
    Adcirc = "ADCIRC or SCHISM grid";
    /// SMS's `.2dm`.
    Sms2dm = "SMS 2dm";
    /// MIKE's `.mesh` (DHI).
    Mike = "MIKE mesh";
    /// FVCOM's grid, `CASE_grd.dat`.
    Fvcom = "FVCOM grid";
    /// MFEM's `.mesh`.
    Mfem = "MFEM mesh";
    /// JIGSAW's `.msh`.
    Jigsaw = "JIGSAW .msh";
    /// FreeFem's `.msh`.
    FreeFem = "FreeFem .msh";
    /// TELEMAC's SELAFIN, in either byte order and precision.
    Selafin = "SELAFIN";
    /// STL, as text, with corners at the same place joined.
    Stl = "STL ASCII";
    /// STL, in binary, with corners at the same place joined.
    StlBinary = "STL binary";
    /// Exodus II, in netCDF's classic formats and in netCDF-4.
    Exodus = "Exodus II";
    /// UGRID, in netCDF's classic formats and in netCDF-4.
    Ugrid = "UGRID";
    /// MED, of Salome and Code_Aster, versions 3 and 4.
    Med = "MED";
    /// CGNS, in HDF5.
    Cgns = "CGNS";
    /// XDMF, with its numbers in the XML or in files beside it, HDF5 or raw.
    Xdmf = "XDMF";
    /// The `.inp` of Abaqus and CalculiX.
    Abaqus = "Abaqus";
    /// Bulk data of Nastran.
    Nastran = "Nastran";
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
