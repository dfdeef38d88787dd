//! Debug output of handles: the type's name and distinguishing values, without buffers.

use std::fmt;

use crate::gpu::device::Gpu;
use crate::gpu::embed::{BoundMask, BoundMove, BoundObjective, BoundVertices};
use crate::gpu::embed::{DeviceMesh, LastValid, Sweeps, UntanglingSweeps};
use crate::gpu::encode::{Spans, Timestamps};
use crate::mesh::MeshSize;

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Gpu").field("adapter", self.adapter()).finish_non_exhaustive()
    }
}

impl fmt::Debug for DeviceMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MeshSize { vertices, triangles } = self.size();
        let mut debug = f.debug_struct("DeviceMesh");
        debug.field("vertices", &vertices).field("triangles", &triangles).finish_non_exhaustive()
    }
}

impl fmt::Debug for Sweeps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("Sweeps");
        debug.field("scheme", &self.scheme().to_string()).finish_non_exhaustive()
    }
}

/// Debug output of handles that show only their name.
macro_rules! by_name {
    ($($handle:ident),*) => {$(
        impl fmt::Debug for $handle {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.debug_struct(stringify!($handle)).finish_non_exhaustive()
            }
        }
    )*};
}

by_name!(
    BoundMask,
    BoundMove,
    BoundObjective,
    BoundVertices,
    LastValid,
    Spans,
    Timestamps,
    UntanglingSweeps
);

#[cfg(test)]
mod tests {
    use crate::gpu::device::Gpu;
    use crate::gpu::embed::{DeviceMesh, Sweeps};
    use crate::{Mesh, Options};

    #[test]
    fn debug_output_of_handles_tells_them_apart() {
        let gpu = Gpu::open(None).block().unwrap();
        let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.4]];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = DeviceMesh::new(&gpu, &Mesh { points, triangles, ..Mesh::default() }).unwrap();
        assert_eq!(format!("{mesh:?}"), "DeviceMesh { vertices: 5, triangles: 4, .. }");
        let options = Options { scheme: "edge+imr".parse().unwrap(), ..Options::default() };
        let sweeps = Sweeps::new(&mesh, &options).block().unwrap();
        assert_eq!(format!("{sweeps:?}"), "Sweeps { scheme: \"edge+imr\", .. }");
        assert!(format!("{gpu:?}").contains(&gpu.adapter().name));
        assert_eq!(format!("{:?}", mesh.keep_last_valid().unwrap()), "LastValid { .. }");
    }
}
