// Transforms edges and triangles by maps, and derivatives back to the plane.

fn mapped(map: vec3<f32>, e: vec2<f32>) -> vec2<f32> {
    return vec2(map.x * e.x + map.y * e.y, map.y * e.x + map.z * e.y);
}

// Returns the shape of a vertex's map: the map scaled to keep areas. The coarser levels use coordinates
// transformed by these shapes, in which neighbors across a layer of stretched triangles are as near as neighbors along
// the layer. If the levels are in the coordinates of the plane, returns the identity.
fn shape_of(v: u32) -> vec3<f32> {
    if params.levels_in_plane != 0u {
        return vec3(1.0, 0.0, 1.0);
    }
    let map = map_at(v);
    return map * inverseSqrt(map.x * map.z - map.y * map.y);
}

// Returns a triangle transformed by a target map, the argument of metrics.
fn transformed(t: Corner, map: vec3<f32>) -> Corner {
    if HAS_TARGETS {
        return Corner(mapped(map, t.a), mapped(map, t.b), t.ideal);
    }
    return t;
}

// Returns the gradient S g and the Hessian S H S by a vertex of the plane, given g and H by the transformed vertex,
// with S the map.
fn pulled_back(d: Derivatives, map: vec3<f32>) -> Derivatives {
    if !MAPPED {
        return d;
    }
    let first = mapped(map, d.hessian.xy);
    let second = mapped(map, d.hessian.yz);
    let left = mapped(map, vec2(first.x, second.x));
    let right = mapped(map, vec2(first.y, second.y));
    return Derivatives(d.value, mapped(map, d.gradient), vec3(left, right.y));
}

// Returns the target map of a triangle of a patch with two further vertices: the mean of three maps, scaled near one. Without
// targets, the map is the identity.
fn map_of_patch(p: Patch, first: u32, second: u32) -> vec3<f32> {
    if !HAS_TARGETS {
        return vec3(1.0, 0.0, 1.0);
    }
    return (p.own + map_at(first) + map_at(second)) * (p.map_unit / 3.0);
}

#if QUADRILATERALS
// Returns the target map of a corner of an element.
fn map_in(p: Patch, e: Element, role: u32) -> vec3<f32> {
    let others = others_of(e.vertices, role);
    return map_of_patch(p, others.x, others.y);
}

#endif
// Returns the patch of a vertex with the triangles `start..end` around it, in the given unit.
fn patch_around(vertex: u32, start: u32, end: u32, unit: f32) -> Patch {
    var p: Patch;
    p.start = start;
    p.end = end;
    p.at = position(vertex);
    p.unit = unit;
    p.own = map_at(vertex);
    p.map_unit = 1.0;
    if MAPPED {
        p.map_unit = unit_of(p.own.xz);
    }
    let scale = p.unit * select(1.0, p.map_unit, HAS_TARGETS);
    p.ideal = Ideal(params.mean_area * scale * scale, params.size_weight);
    return p;
}
