//! Classifies element types of Abaqus and CalculiX by name.
//!
//! A type name consists of a family, the number of nodes or the order, and letters for variants: `CPS4R`, `B31H`,
//! `STRI65`.

use crate::visit::items::CellKind;

/// The role of an element type in a mesh of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Class {
    Of(CellKind),
    /// Elements with mid-side nodes, which are not read.
    SecondOrder,
    Volume,
    /// Elements whose nodes stay fixed, of any number: masses, springs, connectors, user elements.
    Constraining,
}

/// Families of surface elements, followed by the number of nodes in a type name: plane, axisymmetric, shell, membrane
/// and rigid elements.
const SURFACES: [&str; 25] = [
    "CPS", "CPE", "CPEG", "CAX", "CGAX", "DC2D", "DCC2D", "DCAX", "DCCAX", "AC2D", "ACAX", "EMC2D",
    "COH2D", "COHAX", "CINPS", "CINPE", "CINAX", "GKPS", "GKPE", "WARP2D", "M3D", "SFM3D", "R3D",
    "S", "STRI",
];
/// Families of shells, membranes and rigid surfaces, whose faces 1 and 2 are the bottom and the top of the surface.
const SHELLS: [&str; 6] = ["M3D", "SFM3D", "R3D", "S", "STRI", "DS"];
/// Families of line elements, followed by the number of nodes in a type name.
const LINES: [&str; 14] = [
    "T2D", "T3D", "R2D", "RB2D", "RB3D", "RAX", "F2D", "FAX", "ASI2D", "ACIN2D", "DC1D", "DCC1D",
    "AC1D", "GK2D",
];
/// Families of axisymmetric line elements, followed by the order in a type name.
const BY_ORDER: [&str; 6] = ["SAX", "DSAX", "MAX", "MGAX", "SFMAX", "SFMGAX"];
/// Families of beam elements, followed by the order in a type name. Beams of order 3 have two nodes.
const BEAMS: [&str; 5] = ["B2", "B3", "PIPE2", "PIPE3", "ELBOW3"];
/// Prefixes of the type names of volume elements.
const VOLUMES: [&str; 15] = [
    "C3D", "DC3D", "DCC3D", "AC3D", "ACIN3D", "CIN3D", "SC6", "SC8", "CSS8", "COH3D", "EMC3D",
    "GK3D", "Q3D", "F3D", "CCL",
];
/// Prefixes of the type names of elements that constrain their nodes.
const CONSTRAINING: [&str; 17] = [
    "MASS", "ROTARYI", "HEATCAP", "SPRING", "DASHPOT", "GAP", "DGAP", "CONN", "DCOUP", "JOINT",
    "ITS", "ASI", "PSI", "DRAG", "PC3D", "PD3D", "FRAME",
];

/// Returns the class of an element type; `None` for an unknown type. `name` is in capital letters.
pub(super) fn class(name: &[u8]) -> Option<Class> {
    let digit = |families: &[&str]| {
        let after = |family: &&str| name.strip_prefix(family.as_bytes())?.first().copied();
        families.iter().filter_map(after).find(u8::is_ascii_digit)
    };
    let begins = |words: &[&str]| words.iter().any(|word| name.starts_with(word.as_bytes()));
    let is_number = |rest: &[u8]| rest.first().is_some_and(u8::is_ascii_digit);
    let of_user = name.strip_prefix(b"VU").or(name.strip_prefix(b"U")).is_some_and(is_number);
    if name == b"F3D3" {
        return Some(Class::Of(CellKind::Triangle));
    }
    if let Some(nodes) = digit(&SURFACES).or(digit(&["DS"])) {
        return match nodes {
            b'3' => Some(Class::Of(CellKind::Triangle)),
            b'4' => Some(Class::Of(CellKind::Quadrilateral)),
            b'5'..=b'9' => Some(Class::SecondOrder),
            _ => None,
        };
    }
    match (digit(&LINES), digit(&BY_ORDER), digit(&BEAMS)) {
        (Some(b'2'), ..) | (_, Some(b'1'), _) | (_, _, Some(b'1' | b'3')) => {
            Some(Class::Of(CellKind::Line))
        }
        (Some(b'3'), ..) | (_, Some(b'2'), _) | (_, _, Some(b'2')) => Some(Class::SecondOrder),
        _ if begins(&VOLUMES) => Some(Class::Volume),
        _ if begins(&CONSTRAINING) || of_user || name == b"D" => Some(Class::Constraining),
        _ => None,
    }
}

/// Returns the side of an element that a surface names by `label`: 0 for the side between the first two nodes. `None`
/// for labels of shell faces and for unknown labels. `name` is the element type in capital letters.
pub(super) fn side(name: &[u8], label: &[u8]) -> Option<usize> {
    let is_shell = SHELLS.iter().any(|family| {
        let rest = name.strip_prefix(family.as_bytes());
        rest.is_some_and(|rest| rest.first().is_some_and(u8::is_ascii_digit))
    });
    match (label, is_shell) {
        ([b'S' | b's', side @ b'1'..=b'4'], false) => Some(usize::from(side - b'1')),
        // CalculiX counts the sides of shells after their two faces.
        ([b'S' | b's', side @ b'3'..=b'6'], true) => Some(usize::from(side - b'3')),
        ([b'E' | b'e', side @ b'1'..=b'4'], true) => Some(usize::from(side - b'1')),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_of_elements_are_told_by_their_names() {
        let is = |names: &str, class_of: Option<Class>| {
            for name in names.split(' ') {
                assert_eq!(class(name.as_bytes()), class_of, "{name}");
            }
        };
        let triangles = "CPS3 CPS3T CPE3 CPE3H CPEG3 CPEG3HT CAX3 CGAX3 S3 S3R S3RS S3RT DS3 STRI3 M3D3 SFM3D3 R3D3 F3D3 DC2D3 DCAX3 DC2D3E \
                         AC2D3 ACAX3 EMC2D3 WARP2D3";
        is(triangles, Some(Class::Of(CellKind::Triangle)));
        let quadrilaterals = "CPS4 CPS4R CPS4I CPE4PH CAX4P CAX4RPT S4 S4R S4RSW S4R5 DS4 M3D4R R3D4 COH2D4 COHAX4P CINPE4 DC2D4 DCCAX4 GKPS4";
        is(quadrilaterals, Some(Class::Of(CellKind::Quadrilateral)));
        let lines = "T2D2 T3D2 T2D2H B21 B21H B31 B31OS B23 B33 PIPE21 PIPE31H ELBOW31 SAX1 MAX1 DSAX1 SFMAX1 R2D2 RAX2 RB3D2 F2D2 DC1D2 ASI2D2";
        is(lines, Some(Class::Of(CellKind::Line)));
        let second = "CPS6 CPS6M CPS8R CPE8 CAX8R S6 S8 S8R5 S9R5 STRI65 DS8 M3D6 M3D9R CINPE5R DC2D6 T2D3 T3D3 B22 B32 B32R PIPE32 ELBOW32 SAX2 MAX2";
        is(second, Some(Class::SecondOrder));
        is(
            "C3D4 C3D20R C3D10MH DC3D8 AC3D4 SC6R SC8R CSS8 COH3D8 F3D8 CIN3D8 CCL12",
            Some(Class::Volume),
        );
        is(
            "MASS ROTARYI SPRINGA SPRING1 DASHPOT2 CONN2D2 GAPUNI DCOUP3D JOINTC U1 U23 VU4 D FRAME2D",
            Some(Class::Constraining),
        );
        is("CPS CPS2 CAXA41 TRI3 X USER S 3 SHELL3 DSX", None);
    }

    #[test]
    fn sides_of_shells_are_counted_after_their_faces() {
        assert_eq!(
            [side(b"CPS3", b"S1"), side(b"CAX4R", b"s4"), side(b"CPS3", b"E1")],
            [Some(0), Some(3), None]
        );
        assert_eq!(
            [side(b"S3", b"S2"), side(b"S4R", b"S3"), side(b"S3", b"E2")],
            [None, Some(0), Some(1)]
        );
        assert_eq!([side(b"S3", b"SPOS"), side(b"CPS3", b""), side(b"CPS3", b"S0")], [None; 3]);
    }
}
