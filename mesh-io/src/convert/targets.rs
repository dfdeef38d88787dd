//! The table of formats that meshes are converted to.

use crate::export::capabilities::{Elements, Groups, Holds, Numbers};
use crate::export::name_rules::Spelling;
use crate::export::writer_input::Job;
use crate::format::Format;
use crate::formats::{
    abaqus, exodus, gmsh, medit, ply, su2, triangle, ugrid, vtk, write_grids, write_surface, xdmf,
};
use crate::precision::Precision;

/// A format that meshes are converted to: a row of [`TARGETS`].
pub(crate) struct Target {
    pub(crate) format: Format,
    /// A short name, to choose a format that the ending of a file name does not stand for.
    pub(crate) name: &'static str,
    pub(crate) holds: Holds,
    pub(crate) write: Write,
}

/// How a format is written.
pub(crate) enum Write {
    /// As one file of text.
    One(fn(&Job<'_>) -> String),
    /// As one binary file.
    Binary(fn(&Job<'_>) -> Vec<u8>),
    /// As several files of text.
    Several(fn(&Job<'_>) -> Vec<String>),
}

const GMSH: Holds = Holds {
    points: Elements::All,
    lines: Elements::All,
    quadrilaterals: true,
    heights: true,
    labels: true,
    groups: Groups::PhysicalAndEntity,
    names: [true; 3],
    spelling: Spelling::Quoted,
    negative: false,
    point_data: Numbers::All,
    cell_data: Numbers::All,
    ..Holds::TRIANGLES
};
const VTK: Holds = Holds {
    points: Elements::All,
    lines: Elements::All,
    quadrilaterals: true,
    polygons: true,
    heights: true,
    groups: Groups::Each,
    vertex_groups: true,
    point_data: Numbers::All,
    cell_data: Numbers::All,
    ..Holds::TRIANGLES
};

const MEDIT: Holds = Holds {
    points: Elements::OfGroups,
    lines: Elements::All,
    quadrilaterals: true,
    heights: true,
    groups: Groups::One,
    own: "list",
    vertex_groups: true,
    ..Holds::TRIANGLES
};

/// All targets. Of formats whose files end the same way, the usual one comes first.
pub(crate) static TARGETS: &[Target] = &[
    Target {
        format: Format::Gmsh41,
        name: "gmsh41",
        holds: GMSH,
        write: Write::One(gmsh::write::write_41),
    },
    Target {
        format: Format::Gmsh22,
        name: "gmsh22",
        holds: GMSH,
        write: Write::One(gmsh::write::write_22),
    },
    Target {
        format: Format::Vtu,
        name: "vtu",
        holds: VTK,
        write: Write::One(vtk::write::write_xml),
    },
    Target {
        format: Format::Xdmf,
        name: "xdmf",
        holds: VTK,
        write: Write::One(xdmf::write::write_xdmf),
    },
    Target {
        format: Format::Vtk,
        name: "vtk",
        holds: VTK,
        write: Write::One(vtk::write::write_legacy),
    },
    Target {
        format: Format::Ugrid,
        name: "ugrid",
        holds: Holds {
            quadrilaterals: true,
            polygons: true,
            spelling: Spelling::Variable,
            point_data: Numbers::All,
            cell_data: Numbers::All,
            ..Holds::TRIANGLES
        },
        write: Write::Binary(ugrid::write::write_ugrid),
    },
    Target {
        format: Format::Exodus,
        name: "exodus",
        holds: Holds {
            points: Elements::All,
            lines: Elements::All,
            quadrilaterals: true,
            heights: true,
            groups: Groups::Blocks,
            names: [true; 3],
            negative: false,
            vertex_groups: true,
            point_data: Numbers::Scalars,
            cell_data: Numbers::Scalars,
            ..Holds::TRIANGLES
        },
        write: Write::Binary(exodus::write::write_exodus),
    },
    Target {
        format: Format::Su2,
        name: "su2",
        holds: Holds {
            lines: Elements::OfGroups,
            quadrilaterals: true,
            groups: Groups::OneOfLines,
            names: [false, true, false],
            spelling: Spelling::Word,
            ..Holds::TRIANGLES
        },
        write: Write::One(su2::write::write),
    },
    Target {
        format: Format::Medit,
        name: "medit",
        holds: MEDIT,
        write: Write::One(medit::write::write_medit),
    },
    Target {
        format: Format::MeditBinary,
        name: "meshb",
        holds: MEDIT,
        write: Write::Binary(medit::write::write_meshb),
    },
    Target {
        format: Format::Triangle,
        name: "triangle",
        holds: Holds {
            lines: Elements::All,
            groups: Groups::One,
            vertex_groups: true,
            point_data: Numbers::Unnamed,
            ..Holds::TRIANGLES
        },
        write: Write::Several(triangle::write::write),
    },
    Target {
        format: Format::Obj,
        name: "obj",
        holds: Holds {
            points: Elements::All,
            lines: Elements::All,
            quadrilaterals: true,
            polygons: true,
            heights: true,
            groups: Groups::One,
            names: [true; 3],
            spelling: Spelling::Word,
            ..Holds::TRIANGLES
        },
        write: Write::One(write_surface::write_obj),
    },
    Target {
        format: Format::Off,
        name: "off",
        holds: Holds { quadrilaterals: true, heights: true, ..Holds::TRIANGLES },
        write: Write::One(write_surface::write_off),
    },
    Target {
        format: Format::Ply,
        name: "ply",
        holds: Holds {
            lines: Elements::All,
            quadrilaterals: true,
            polygons: true,
            heights: true,
            spelling: Spelling::Word,
            point_data: Numbers::Scalars,
            ..Holds::TRIANGLES
        },
        write: Write::One(ply::write::write_ply),
    },
    Target {
        format: Format::Sms2dm,
        name: "2dm",
        holds: Holds {
            lines: Elements::All,
            quadrilaterals: true,
            heights: true,
            labels: true,
            groups: Groups::One,
            names: [false, true, true],
            spelling: Spelling::Quoted,
            ..Holds::TRIANGLES
        },
        write: Write::One(write_grids::write_sms),
    },
    Target {
        format: Format::Adcirc,
        name: "adcirc",
        holds: Holds {
            lines: Elements::OfGroups,
            quadrilaterals: true,
            labels: true,
            groups: Groups::OneOfLines,
            own: "boundary",
            point_data: Numbers::Only("depth"),
            ..Holds::TRIANGLES
        },
        write: Write::One(write_grids::write_adcirc),
    },
    Target {
        format: Format::FreeFem,
        name: "freefem",
        holds: Holds {
            lines: Elements::All,
            groups: Groups::One,
            vertex_groups: true,
            ..Holds::TRIANGLES
        },
        write: Write::One(medit::write::write_freefem),
    },
    Target {
        format: Format::Abaqus,
        name: "abaqus",
        holds: Holds {
            lines: Elements::All,
            quadrilaterals: true,
            heights: true,
            labels: true,
            groups: Groups::One,
            names: [false, true, true],
            spelling: Spelling::Label,
            vertex_sets: true,
            precision: Precision::Text20,
            ..Holds::TRIANGLES
        },
        write: Write::One(abaqus::write::write_inp),
    },
];
