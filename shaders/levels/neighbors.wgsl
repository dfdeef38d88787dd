// Returns the sum of `carried(k)` over the free neighbors k of a free vertex. Each kernel defines `carried`.

fn sum_over_neighbors(v: u32) -> vec2<f32> {
    var sum = vec2(0.0);
    let end = ring_place(ring_start[v + 1u]);
    for (var i = ring_place(ring_start[v]); i < end; i++) {
        let k = ring[i];
        if k < op.free {
            sum += carried(k);
        }
    }
    return sum;
}
