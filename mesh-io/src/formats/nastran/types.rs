//! Classifies the cards of elements by name.

use crate::text::card::{CardName, name_bytes};
use crate::visit::items::CellKind;

/// The role of a card's element in a mesh of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Class {
    /// Elements whose card lists the number, the property, and then the nodes.
    Of(CellKind),
    /// Lines whose card lists the number and then the nodes, without a property.
    Line,
    /// Elements that constrain nodes, with the fields of the nodes. The element number is field 0.
    Constraining(&'static [usize]),
    /// Rigid elements, which constrain any number of nodes.
    Rigid(RigidFields),
    /// Elements that may have mid-side nodes, which are not read.
    SecondOrder,
    Volume,
}

/// Order of nodes, components and weights in the fields of a rigid element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RigidFields {
    /// A node, components, and nodes: RBE2.
    Nodes,
    /// Nodes, each with components: RBE1.
    Pairs,
    /// A node with components, and weights, each with components and nodes: RBE3.
    Weights,
}

/// Returns the class of a card's element; `None` for unknown names.
pub(super) fn class(name: &CardName) -> Option<Class> {
    Some(match name_bytes(name) {
        b"CTRIA3" | b"CTRIAR" | b"CTRIA1" | b"CTRIA2" | b"CTRMEM" | b"CTRPLT" | b"CTRBSC"
        | b"CPLSTN3" | b"CPLSTS3" | b"CTRAX3" => Class::Of(CellKind::Triangle),
        b"CQUAD4" | b"CQUADR" | b"CQUAD1" | b"CQUAD2" | b"CQDMEM" | b"CQDMEM1" | b"CQDMEM2"
        | b"CQDPLT" | b"CSHEAR" | b"CTWIST" | b"CPLSTN4" | b"CPLSTS4" | b"CQUADX4" => {
            Class::Of(CellKind::Quadrilateral)
        }
        b"CBAR" | b"CBEAM" | b"CROD" | b"CTUBE" | b"CBEND" => Class::Of(CellKind::Line),
        b"CONROD" | b"PLOTEL" => Class::Line,
        b"CONM1" | b"CONM2" => Class::Constraining(&[1]),
        b"CELAS1" | b"CELAS2" | b"CMASS1" | b"CMASS2" | b"CDAMP1" | b"CDAMP2" => {
            Class::Constraining(&[2, 4])
        }
        b"CELAS3" | b"CELAS4" | b"CMASS3" | b"CMASS4" | b"CDAMP3" | b"CDAMP4" | b"CBUSH"
        | b"CBUSH1D" | b"CGAP" | b"CVISC" => Class::Constraining(&[2, 3]),
        b"RBAR" | b"RROD" | b"RJOINT" => Class::Constraining(&[1, 2]),
        b"RTRPLT" | b"PLOTEL3" => Class::Constraining(&[1, 2, 3]),
        b"CBEAM3" => Class::Constraining(&[2, 3, 4]),
        b"RBE1" => Class::Rigid(RigidFields::Pairs),
        b"RBE2" => Class::Rigid(RigidFields::Nodes),
        b"RBE3" => Class::Rigid(RigidFields::Weights),
        b"CTRIA6" | b"CTRIAX6" | b"CTRIAX" | b"CTRAX6" | b"CTRSHL" | b"CQUAD8" | b"CQUAD9"
        | b"CQUAD" | b"CQUADX" | b"CQUADX8" | b"CPLSTN6" | b"CPLSTN8" | b"CPLSTS6" | b"CPLSTS8" => {
            Class::SecondOrder
        }
        b"CTETRA" | b"CHEXA" | b"CPENTA" | b"CPYRAM" | b"CPYRA" | b"CHEXA1" | b"CHEXA2"
        | b"CWEDGE" | b"CIHEX1" | b"CIHEX2" | b"CIHEX3" => Class::Volume,
        _ => return None,
    })
}
