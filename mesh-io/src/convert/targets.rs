//! The table of formats that meshes are converted to.

use crate::export::capabilities::{Capabilities, ElementSupport, GroupSupport};
use crate::export::data_support::DataSupport;
use crate::export::name_rules::NameRules;
use crate::export::writer_input::WriterInput;
use crate::format::Format;
use crate::formats::{
    abaqus, cgns, exodus, gmsh, med, medit, ply, selafin, su2, triangle, ugrid, vtk, write_grids,
    write_surface, xdmf,
};
use crate::precision::Precision;

/// A format that meshes are converted to: a row of [`TARGETS`].
pub(crate) struct Target {
    pub(crate) format: Format,
    /// Short name, which selects the format independently of file endings.
    pub(crate) name: &'static str,
    pub(crate) capabilities: Capabilities,
    pub(crate) write: WriteFunction,
}

/// Function that writes a format, by number and type of files.
pub(crate) enum WriteFunction {
    /// One text file.
    One(fn(&WriterInput<'_>) -> String),
    /// One file, as text, in binary or compressed.
    Encoded {
        text: fn(&WriterInput<'_>) -> String,
        binary: fn(&WriterInput<'_>) -> Vec<u8>,
        compressed: Option<fn(&WriterInput<'_>) -> Vec<u8>>,
    },
    /// One binary file.
    Binary(fn(&WriterInput<'_>) -> Vec<u8>),
    /// Several text files, in the order of [`Conversion::destinations`](super::Conversion::destinations).
    Several(fn(&WriterInput<'_>) -> Vec<String>),
}

const GMSH: Capabilities = Capabilities {
    points: ElementSupport::All,
    lines: ElementSupport::All,
    quadrilaterals: true,
    z: true,
    keeps_vertex_ids: true,
    periodic_curves: true,
    groups: GroupSupport::PhysicalAndEntity,
    names_empty_groups: true,
    names: [true; 3],
    name_rules: NameRules::Quoted,
    allows_negative_numbers: false,
    point_data: DataSupport::Padded,
    cell_data: DataSupport::Padded,
    ..Capabilities::TRIANGLES
};
const VTK: Capabilities = Capabilities {
    points: ElementSupport::All,
    lines: ElementSupport::All,
    quadrilaterals: true,
    polygons: true,
    z: true,
    groups: GroupSupport::Each,
    vertex_groups: true,
    point_data: DataSupport::All,
    cell_data: DataSupport::All,
    ..Capabilities::TRIANGLES
};

const MEDIT: Capabilities = Capabilities {
    points: ElementSupport::OfGroups,
    lines: ElementSupport::All,
    quadrilaterals: true,
    z: true,
    groups: GroupSupport::One,
    builtin_group_kind: "list",
    vertex_groups: true,
    ..Capabilities::TRIANGLES
};

/// All targets. Among formats with a common file ending, the usual format comes first.
pub(crate) static TARGETS: &[Target] = &[
    Target {
        format: Format::Gmsh41,
        name: "gmsh41",
        capabilities: GMSH,
        write: WriteFunction::Encoded {
            text: gmsh::write::write_41,
            binary: gmsh::write::write_41_binary,
            compressed: None,
        },
    },
    Target {
        format: Format::Gmsh22,
        name: "gmsh22",
        capabilities: GMSH,
        write: WriteFunction::Encoded {
            text: gmsh::write::write_22,
            binary: gmsh::write::write_22_binary,
            compressed: None,
        },
    },
    Target {
        format: Format::Vtu,
        name: "vtu",
        capabilities: VTK,
        write: WriteFunction::Encoded {
            text: vtk::xml::write::write_vtu,
            binary: vtk::xml::write::write_vtu_binary,
            compressed: Some(vtk::xml::write::write_vtu_compressed),
        },
    },
    Target {
        format: Format::Xdmf,
        name: "xdmf",
        capabilities: VTK,
        write: WriteFunction::One(xdmf::write::write_xdmf),
    },
    Target {
        format: Format::Vtk,
        name: "vtk",
        capabilities: VTK,
        write: WriteFunction::Encoded {
            text: vtk::write::write_legacy,
            binary: vtk::write::write_legacy_binary,
            compressed: None,
        },
    },
    Target {
        format: Format::Ugrid,
        name: "ugrid",
        capabilities: Capabilities {
            quadrilaterals: true,
            polygons: true,
            name_rules: NameRules::Variable,
            point_data: DataSupport::All,
            cell_data: DataSupport::All,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::Binary(ugrid::write::write_ugrid),
    },
    Target {
        format: Format::Exodus,
        name: "exodus",
        capabilities: Capabilities {
            points: ElementSupport::All,
            lines: ElementSupport::All,
            quadrilaterals: true,
            z: true,
            groups: GroupSupport::Blocks,
            names: [true; 3],
            name_rules: NameRules::Trimmed,
            allows_negative_numbers: false,
            vertex_groups: true,
            point_data: DataSupport::Scalars,
            cell_data: DataSupport::Scalars,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::Binary(exodus::write::write_exodus),
    },
    Target {
        format: Format::Med,
        name: "med",
        capabilities: Capabilities {
            points: ElementSupport::All,
            lines: ElementSupport::All,
            quadrilaterals: true,
            z: true,
            groups: GroupSupport::Sets,
            names: [true; 3],
            name_rules: NameRules::Text80,
            vertex_sets: true,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::Binary(med::write::write_med),
    },
    Target {
        format: Format::Cgns,
        name: "cgns",
        capabilities: Capabilities {
            points: ElementSupport::All,
            lines: ElementSupport::All,
            quadrilaterals: true,
            z: true,
            groups: GroupSupport::Sections,
            names: [true; 3],
            name_rules: NameRules::Node32,
            vertex_sets: true,
            point_data: DataSupport::Scalars,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::Binary(cgns::write::write_cgns),
    },
    Target {
        format: Format::Su2,
        name: "su2",
        capabilities: Capabilities {
            lines: ElementSupport::OfGroups,
            quadrilaterals: true,
            groups: GroupSupport::OneOfLines,
            names: [false, true, false],
            name_rules: NameRules::Word,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::One(su2::write::write),
    },
    Target {
        format: Format::Medit,
        name: "medit",
        capabilities: MEDIT,
        write: WriteFunction::One(medit::write::write_medit),
    },
    Target {
        format: Format::MeditBinary,
        name: "meshb",
        capabilities: MEDIT,
        write: WriteFunction::Binary(medit::write::write_meshb),
    },
    Target {
        format: Format::Triangle,
        name: "triangle",
        capabilities: Capabilities {
            lines: ElementSupport::All,
            groups: GroupSupport::One,
            vertex_groups: true,
            point_data: DataSupport::Unnamed,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::Several(triangle::write::write),
    },
    Target {
        format: Format::Obj,
        name: "obj",
        capabilities: Capabilities {
            points: ElementSupport::All,
            lines: ElementSupport::All,
            quadrilaterals: true,
            polygons: true,
            z: true,
            groups: GroupSupport::One,
            names: [true; 3],
            name_rules: NameRules::Word,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::One(write_surface::write_obj),
    },
    Target {
        format: Format::Off,
        name: "off",
        capabilities: Capabilities { quadrilaterals: true, z: true, ..Capabilities::TRIANGLES },
        write: WriteFunction::One(write_surface::write_off),
    },
    Target {
        format: Format::Ply,
        name: "ply",
        capabilities: Capabilities {
            lines: ElementSupport::All,
            quadrilaterals: true,
            polygons: true,
            z: true,
            name_rules: NameRules::Word,
            point_data: DataSupport::Scalars,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::Encoded {
            text: ply::write::write_ply,
            binary: ply::write::write_ply_binary,
            compressed: None,
        },
    },
    Target {
        format: Format::Sms2dm,
        name: "2dm",
        capabilities: Capabilities {
            lines: ElementSupport::All,
            quadrilaterals: true,
            z: true,
            keeps_vertex_ids: true,
            groups: GroupSupport::One,
            names: [false, true, true],
            name_rules: NameRules::Quoted,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::One(write_grids::write_sms),
    },
    Target {
        format: Format::Adcirc,
        name: "adcirc",
        capabilities: Capabilities {
            lines: ElementSupport::OfGroups,
            quadrilaterals: true,
            keeps_vertex_ids: true,
            groups: GroupSupport::OneOfLines,
            builtin_group_kind: "boundary",
            point_data: DataSupport::Only("depth"),
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::One(write_grids::write_adcirc),
    },
    Target {
        format: Format::Mike,
        name: "mike",
        capabilities: Capabilities {
            quadrilaterals: true,
            z: true,
            keeps_projection: true,
            keeps_vertex_ids: true,
            vertex_groups: true,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::One(write_grids::write_mike),
    },
    Target {
        format: Format::Selafin,
        name: "selafin",
        capabilities: Capabilities {
            keeps_origin: true,
            point_data: DataSupport::Only(selafin::write::BED),
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::Binary(selafin::write::write_selafin),
    },
    Target {
        format: Format::FreeFem,
        name: "freefem",
        capabilities: Capabilities {
            lines: ElementSupport::All,
            groups: GroupSupport::One,
            vertex_groups: true,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::One(medit::write::write_freefem),
    },
    Target {
        format: Format::Abaqus,
        name: "abaqus",
        capabilities: Capabilities {
            lines: ElementSupport::All,
            quadrilaterals: true,
            z: true,
            keeps_vertex_ids: true,
            groups: GroupSupport::Sets,
            names: [false, true, true],
            name_rules: NameRules::Label,
            vertex_sets: true,
            precision: Precision::Text20,
            ..Capabilities::TRIANGLES
        },
        write: WriteFunction::One(abaqus::write::write_inp),
    },
];
