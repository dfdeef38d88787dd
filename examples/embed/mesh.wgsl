// Draws a mesh: `faces` reads corners from a storage buffer, `edges` receives vertices from the
// vertex buffer.

struct View {
    scale: vec2<f32>,
    offset: vec2<f32>,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> vertices: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;

struct Varyings {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec4<f32>,
}

fn on_screen(p: vec2<f32>) -> vec4<f32> {
    return vec4(p * view.scale + view.offset, 0.0, 1.0);
}

// The color map magma, from its pale end for equilateral triangles to its dark end for flat ones.
fn color_of(quality: f32) -> vec4<f32> {
    let magma = array(
        vec3(0.0, 0.0, 4.0),
        vec3(59.0, 15.0, 112.0),
        vec3(140.0, 41.0, 129.0),
        vec3(222.0, 73.0, 104.0),
        vec3(254.0, 159.0, 109.0),
        vec3(252.0, 253.0, 191.0),
    );
    let at = clamp(quality, 0.0, 1.0) * 5.0;
    let below = min(u32(at), 4u);
    return vec4(mix(magma[below], magma[below + 1u], at - f32(below)) / 255.0, 1.0);
}

@vertex
fn faces(@builtin(vertex_index) index: u32) -> Varyings {
    let first = index - index % 3u;
    let p = vertices[triangles[first]].xy;
    let a = vertices[triangles[first + 1u]].xy - p;
    let b = vertices[triangles[first + 2u]].xy - p;
    let c = b - a;
    // The mean ratio 1 / IMR: 1 for an equilateral triangle, 0 for a flat one.
    let area = 0.5 * abs(a.x * b.y - a.y * b.x);
    let quality = 4.0 * sqrt(3.0) * area / (dot(a, a) + dot(b, b) + dot(c, c));
    return Varyings(on_screen(vertices[triangles[index]].xy), color_of(quality));
}

@vertex
fn edges(@location(0) position: vec3<f32>, @location(1) black: f32) -> Varyings {
    return Varyings(on_screen(position.xy), vec4(0.0, 0.0, 0.0, black));
}

@fragment
fn color(in: Varyings) -> @location(0) vec4<f32> {
    return in.color;
}
