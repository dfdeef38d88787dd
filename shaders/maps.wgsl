// What a map shows, and derivatives through it.

fn mapped(map: vec3<f32>, e: vec2<f32>) -> vec2<f32> {
    return vec2(map.x * e.x + map.y * e.y, map.y * e.x + map.z * e.y);
}

// The shape of the map of a vertex: the map scaled to keep areas. Levels see moves and gradients as it shows them, which makes
// neighbors in a layer of stretched triangles as near across as along it.
fn shape_of(v: u32) -> vec3<f32> {
    let map = target_of(v);
    return map * inverseSqrt(map.x * map.z - map.y * map.y);
}

// A triangle as a metric sees it.
fn shown(t: Corner, map: vec3<f32>) -> Corner {
    if MAPPED {
        return Corner(mapped(map, t.a), mapped(map, t.b), t.mean_area);
    }
    return t;
}

// The gradient and the Hessian by a vertex of the plane, from those by the vertex as the map shows it: S g and S H S.
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
