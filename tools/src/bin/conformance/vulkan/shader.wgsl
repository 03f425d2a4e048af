// Passes positions through, and writes the bit of the triangle that covers the pixel.

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) triangle: u32,
}

@vertex
fn corner(@location(0) position: vec4<f32>, @builtin(vertex_index) number: u32) -> Corner {
    return Corner(position, number / 3u);
}

@fragment
fn pixel(@location(0) @interpolate(flat) triangle: u32) -> @location(0) vec4<u32> {
    let here = vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(triangle / 32u);
    return select(vec4<u32>(0u), vec4<u32>(1u << (triangle % 32u)), here);
}
