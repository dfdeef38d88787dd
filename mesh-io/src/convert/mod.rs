//! Writes a mesh of one format in another. A reader's walk makes a description of the mesh ([`mod@content`]), a row of
//! [`targets`] says what the format holds of it, and a writer writes that.

/// Appends formatted text to a string.
macro_rules! put {
    ($out:expr, $($text:tt)*) => {
        write!($out, $($text)*).expect("memory takes what is written to it")
    };
}

mod abaqus;
mod collector;
mod content;
mod conversion;
#[cfg(test)]
mod documented;
mod exodus;
mod gmsh;
mod grids;
mod holds;
mod job;
mod medit;
mod names;
mod netcdf;
mod ply;
mod sides;
mod spelling;
mod su2;
mod surface;
#[cfg(test)]
mod tables;
mod tags;
mod targets;
mod triangle;
mod triangle_source;
mod ugrid;
mod vtk;
mod xdmf;

pub use conversion::Conversion;
