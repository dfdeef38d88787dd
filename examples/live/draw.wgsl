// Draws the mesh from the vertex buffer that the smoother writes, and the panel above the mesh.

struct View {
    scale: vec2<f32>,
    offset: vec2<f32>,
    // The size of a pixel in clip space.
    pixel: vec2<f32>,
    // Pixels of the window per pixel of the panel.
    enlargement: f32,
    // Colors in sRGB by 1 / inverse mean ratio, in equal steps from 0 to 1. The last color marks inverted triangles.
    stops: array<vec4<f32>, 7>,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> triangles: array<u32>;
@group(0) @binding(2) var<storage, read> points: array<vec2<f32>>;
@group(0) @binding(3) var panel: texture_2d<f32>;

fn clip(point: vec2<f32>) -> vec4<f32> {
    return vec4(point * view.scale + view.offset, 0.0, 1.0);
}

fn linear(srgb: vec3<f32>) -> vec4<f32> {
    return vec4(pow(srgb, vec3(2.2)), 1.0);
}

struct Colored {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) color: vec4<f32>,
}

@vertex
fn fill_vertex(@builtin(vertex_index) index: u32) -> Colored {
    let first = index - index % 3u;
    let a = points[triangles[first]];
    let u = points[triangles[first + 1u]] - a;
    let v = points[triangles[first + 2u]] - a;
    let w = v - u;
    let lengths = dot(u, u) + dot(v, v) + dot(w, w);
    // 1 / inverse mean ratio: 1 for an equilateral triangle, 0 for a flat one.
    let goodness = 2.0 * sqrt(3.0) * (u.x * v.y - u.y * v.x) / lengths;
    var color = view.stops[6].rgb;
    if goodness > 0.0 {
        let at = min(goodness, 1.0) * 5.0;
        let stop = min(u32(at), 4u);
        color = mix(view.stops[stop].rgb, view.stops[stop + 1u].rgb, at - f32(stop));
    }
    return Colored(clip(points[triangles[index]]), linear(color));
}

@fragment
fn fill_fragment(in: Colored) -> @location(0) vec4<f32> {
    return in.color;
}

@vertex
fn edge_vertex(@location(0) point: vec2<f32>) -> @builtin(position) vec4<f32> {
    return clip(point);
}

@fragment
fn edge_fragment() -> @location(0) vec4<f32> {
    return vec4(0.01, 0.02, 0.04, 0.6);
}

// Returns the corners of two triangles that form a unit square.
fn square(index: u32) -> vec2<f32> {
    let corner = array(0u, 1u, 2u, 2u, 1u, 3u)[index];
    return vec2(f32(corner & 1u), f32(corner >> 1u));
}

@vertex
fn mark_vertex(
    @builtin(vertex_index) index: u32,
    @location(0) vertex: u32,
) -> @builtin(position) vec4<f32> {
    let half_side = 4.0 * view.enlargement * view.pixel;
    let corner = 2.0 * square(index) - 1.0;
    return clip(points[vertex]) + vec4(corner * half_side, 0.0, 0.0);
}

@fragment
fn mark_fragment() -> @location(0) vec4<f32> {
    return vec4(0.0, 0.0, 0.0, 1.0);
}

@vertex
fn panel_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // The panel spans the width of the window.
    let height = f32(textureDimensions(panel).y) * view.enlargement * view.pixel.y;
    let at = square(index) * vec2(2.0, height);
    return vec4(at.x - 1.0, 1.0 - at.y, 0.0, 1.0);
}

@fragment
fn panel_fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let last = textureDimensions(panel) - 1u;
    return textureLoad(panel, min(vec2<u32>(position.xy / view.enlargement), last), 0);
}
