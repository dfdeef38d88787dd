//! The connectivity of meshes: windings, the boundary, clamped moves, and errors for unsound meshes.

mod boundary;
mod crossings;
mod hanging;
mod hubs;
mod requests;
mod windings;
