//! How triangles hang together: windings, the boundary, drags, and what is said of meshes that are not sound.

#[path = "../support/mod.rs"]
mod support;

mod boundary;
mod hubs;
mod requests;
mod windings;
