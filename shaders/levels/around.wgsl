// The sum over a free vertex's free neighbors of what each carries to it. A kernel says what that is in
// `carried(v, k)`.

fn around(v: u32) -> vec2<f32> {
    var sum = vec2(0.0);
    let end = ring_place(ring_start[v + 1u]);
    for (var i = ring_place(ring_start[v]); i < end; i++) {
        let k = ring[i];
        if k < op.free {
            sum += carried(v, k);
        }
    }
    return sum;
}
