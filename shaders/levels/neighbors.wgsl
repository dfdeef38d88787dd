// The sum over a free vertex's free neighbors of what each carries. A kernel says what that is in
// `carried(k)`.

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
