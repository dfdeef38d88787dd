// Vectors at sliding vertices. Vertices of one unknown move together, each by its share along its tangent.

// Returns the value of the unknown that begins at a line, in the vector at an offset of `fine`.
fn value_in(vector: u32, first: u32) -> f32 {
    var sum = 0.0;
    for (var k = first; k != NONE; k = lines[k].next) {
        sum += lines[k].share * dot(lines[k].along, fine[vector + lines[k].vertex]);
    }
    return sum;
}

// Sets a vector at the vertices of the unknown that begins at a line.
fn set_value(vector: u32, first: u32, value: f32) {
    for (var k = first; k != NONE; k = lines[k].next) {
        fine[vector + lines[k].vertex] = lines[k].along * (lines[k].share * value);
    }
}
