//! The options of the format in which a mesh is written.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use mesh_io::{Conversion, Encoding, Format};

/// The options of the format in which a run or a conversion writes a mesh.
#[derive(Args)]
pub(crate) struct FormArgs {
    /// Format of OUT, if the ending of OUT does not determine the format; .msh without --to means gmsh 4.1 for a mesh in
    /// another format
    #[arg(long, value_name = "FORMAT", value_parser = targets(), help_heading = "Format of OUT")]
    pub(crate) to: Option<Format>,
    /// Encoding of OUT: gmsh, legacy VTK and PLY are written as text or in binary, VTK XML also compressed
    #[arg(long, value_enum, help_heading = "Format of OUT")]
    pub(crate) encoding: Option<EncodingArg>,
    /// Write the mesh even if another format does not hold all of it
    #[arg(long, help_heading = "Format of OUT")]
    pub(crate) lossy: bool,
}

/// Value of `--encoding`.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum EncodingArg {
    /// Text; VTK XML with its arrays in base64
    Text,
    /// Numbers in binary
    Binary,
    /// Numbers in binary, compressed by zlib
    Compressed,
}

impl From<EncodingArg> for Encoding {
    fn from(encoding: EncodingArg) -> Encoding {
        match encoding {
            EncodingArg::Text => Encoding::Text,
            EncodingArg::Binary => Encoding::Binary,
            EncodingArg::Compressed => Encoding::Compressed,
        }
    }
}

/// Parses a format that meshes are converted to, by its short name.
fn targets() -> impl TypedValueParser<Value = Format> {
    let format = |name: String| Conversion::targets().find(|(own, _)| *own == name);
    PossibleValuesParser::new(Conversion::targets().map(|(name, _)| name))
        .try_map(move |name| format(name).map(|(_, format)| format).ok_or("not a format"))
}
