// Computes a row of the first level's matrix: the sums over the vertices of one aggregate and their neighbors, of the blocks of
// the Hessian's positive part, for motions of the aggregates. A vertex at the place (u, w) moves by a + b (u + iw), with
// complex a and b.

// Returns the place of a column's block, from the first block of a row on.
fn column_place(first: u32, column: u32) -> u32 {
    var at = first;
    while structure[op.columns + at] != column {
        at++;
    }
    return at;
}

// Returns the forces on the four unknowns of an aggregate by a force on a vertex at a place.
fn spread(place: vec2<f32>, force: vec2<f32>) -> vec4<f32> {
    let turned = vec2(place.x * force.x + place.y * force.y, place.x * force.y - place.y * force.x);
    return vec4(force, turned);
}

// Returns the forces on the aggregate at a vertex by a motion with a share of a translation and a place.
fn by_motion(place: vec2<f32>, block: mat2x2<f32>, share: f32, there: vec2<f32>) -> mat4x4<f32> {
    return mat4x4(
        spread(place, block[0] * share),
        spread(place, block[1] * share),
        spread(place, block * there),
        spread(place, block * vec2(-there.y, there.x)),
    );
}

// Returns the projection to the moves that a vertex admits: all moves of a free vertex, those along the tangent of a sliding
// one.
fn admitted(v: u32) -> mat2x2<f32> {
    if v < op.vertices {
        return mat2x2(1.0, 0.0, 0.0, 1.0);
    }
    let t = fine[tangent_at(v)];
    return mat2x2(t * t.x, t * t.y);
}

@compute @workgroup_size(WORKGROUP)
fn sum_over_members(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows {
        return;
    }
    let first = structure[op.starts + row];
    let end = structure[op.starts + row + 1u];
    for (var at = first; at < end; at++) {
        set_block(op.blocks, at, mat4x4<f32>());
    }
    // Neighbors that follow each other are often in one aggregate, so their blocks are added up before they are stored.
    var own = mat4x4<f32>();
    var other = mat4x4<f32>();
    var of_other = NONE;
    let last = structure[op.member_starts + row + 1u];
    for (var i = structure[op.member_starts + row]; i < last; i++) {
        let v = structure[op.members + i];
        let place = fine[place_at(v)];
        let is_free = v < op.vertices;
        var range = vec2<u32>();
        if is_free {
            range = vec2(ring_place(ring_start[v]), ring_place(ring_start[v + 1u]));
        } else {
            range = 2u * corners_of(v);
        }
        let along = admitted(v);
        // The vertex's own block is minus the sum of its other blocks.
        var rest = mat2x2<f32>();
        for (var k = range.x; k < range.y; k++) {
            var neighbor = NONE;
            var entry = vec4(0.0);
            if is_free {
#if QUADRILATERALS
                neighbor = ring[k] & ~OPPOSITE;
#else
                neighbor = ring[k];
#endif
                entry = entries[k];
            } else {
                neighbor = corner_at(k);
                entry = entries[op.slide_entries + k];
            }
            var block = mat2x2(entry.xy, entry.zw);
            var column = NONE;
            var there = vec2(0.0);
            if neighbor < op.movers {
                column = structure[op.aggregate_of + neighbor];
                there = fine[place_at(neighbor)];
            }
            if column == row && is_free && neighbor < op.vertices {
                own += by_motion(place, block, 0.0, there - place);
                continue;
            }
            rest += block;
            if column == NONE {
                continue;
            }
            if !is_free || neighbor >= op.vertices {
                block = along * block * admitted(neighbor);
            }
            if column == row {
                own += by_motion(place, block, 1.0, there);
                continue;
            }
            if column != of_other {
                if of_other != NONE {
                    add_block(op.blocks, column_place(first, of_other), other);
                }
                of_other = column;
                other = mat4x4<f32>();
            }
            other += by_motion(place, block, 1.0, there);
        }
        if !is_free {
            rest = along * rest * along;
            let bend = spread(place, fine[tangent_at(v)]);
            let stiffness = fine[inverse_at(v) + 1u].y;
            own += stiffness * mat4x4(bend * bend.x, bend * bend.y, bend * bend.z, bend * bend.w);
        }
        own += by_motion(place, rest, -1.0, -place);
    }
    if of_other != NONE {
        add_block(op.blocks, column_place(first, of_other), other);
    }
    set_block(op.blocks, column_place(first, row), own);
}
