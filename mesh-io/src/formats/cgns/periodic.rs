//! Pairs of periodic vertices, from the connectivities of a zone with itself.

use super::file::{File, labeled};
use crate::content::constraints::Affine;
use crate::hdf5::{Datatype, Object};
use crate::visit::items::PeriodicNodes;
use std::collections::HashSet;

impl<'a> File<'a> {
    /// Returns the pairs of vertices that the zone joins to itself, each pair once. `None` if the lists of a periodic
    /// connectivity cannot be read.
    pub(super) fn periodic(&self) -> Option<Vec<PeriodicNodes>> {
        let own_name =
            labeled(self.hdf5, self.base, b"Zone_t").first().map(|(name, _)| name.to_vec());
        let mut found = Vec::new();
        let mut seen: HashSet<[u64; 2]> = HashSet::new();
        for (_, all) in labeled(self.hdf5, self.zone, b"ZoneGridConnectivity_t") {
            for (_, node) in labeled(self.hdf5, all, b"GridConnectivity_t") {
                // Only one zone is read, so a connectivity to another zone joins no vertices of the mesh.
                if self.text(node) != own_name {
                    continue;
                }
                let child = |name: &[u8]| self.hdf5.child(node, name);
                let numbers = |name: &[u8]| child(name).and_then(|own| self.integers(own));
                let periodic = child(b"GridConnectivityProperty").and_then(|own| {
                    labeled(self.hdf5, own, b"Periodic_t").first().map(|own| own.1)
                });
                let location = child(b"GridLocation").and_then(|own| self.text(own));
                let is_of_vertices = location.is_none_or(|location| location == b"Vertex");
                let kind = child(b"GridConnectivityType").and_then(|own| self.text(own));
                // In other connectivities, the second list has the cells around the vertices of the first.
                let lists = match is_of_vertices && kind.as_deref() == Some(b"Abutting1to1") {
                    true => numbers(b"PointList").zip(numbers(b"PointListDonor")),
                    false => None,
                };
                let motion = periodic.map(|own| self.motion(own));
                match lists.filter(|(from, to)| from.len() == to.len()) {
                    Some((from, to)) => {
                        let ids = from.into_iter().zip(to);
                        let ids = ids.filter_map(|(a, b)| {
                            Some([u64::try_from(a).ok()?, u64::try_from(b).ok()?])
                        });
                        // Both sides of a periodic boundary list the same pairs.
                        let is_new =
                            |&[a, b]: &[u64; 2]| a != b && seen.insert([a.min(b), a.max(b)]);
                        let nodes: Vec<_> = ids.filter(is_new).collect();
                        if !nodes.is_empty() {
                            found.push(PeriodicNodes {
                                entities: None,
                                motion: motion.flatten(),
                                nodes,
                            });
                        }
                    }
                    None => {
                        // The motion alone determines the pairs. Connectivities that are not periodic, such as overlaps,
                        // join no vertices.
                        let Some(motion) = motion else { continue };
                        found.push(PeriodicNodes {
                            entities: None,
                            motion: Some(motion?),
                            nodes: Vec::new(),
                        });
                    }
                }
            }
        }
        Some(found)
    }

    /// Returns the motion from the vertices of a connectivity to their partners. `None` for a rotation out of the
    /// plane of x and y, and for numbers that are missing or not finite.
    fn motion(&self, periodic: &'a Object) -> Option<Affine> {
        let read = |name: &[u8]| {
            let (dataset, array) = self.reals(self.hdf5.child(periodic, name)?).ok()??;
            let Datatype::Real(precision, order) = dataset.datatype else { return None };
            let numbers = array.bytes.chunks_exact(precision.bytes());
            let numbers: Vec<f64> = numbers.map(|number| order.real(precision, number)).collect();
            numbers.iter().all(|number| number.is_finite()).then_some(numbers)
        };
        let (center, angle, along) =
            (read(b"RotationCenter")?, read(b"RotationAngle")?, read(b"Translation")?);
        let &[x, y, ..] = &center[..] else { return None };
        let &[along_x, along_y, ..] = &along[..] else { return None };
        // In a base of two dimensions, the only angle is that about z.
        let angle = match angle[..] {
            [about_z] => about_z,
            [about_x, about_y, about_z] if [about_x, about_y] == [0.0; 2] => about_z,
            [about_z, _] => about_z,
            _ => return None,
        };
        let (sin, cos) = angle.sin_cos();
        Some([
            [cos, -sin, x + along_x - cos * x + sin * y],
            [sin, cos, y + along_y - sin * x - cos * y],
        ])
    }
}
