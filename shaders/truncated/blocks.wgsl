// The 4x4 blocks of the levels' matrices, column by column in `rows`.

// Returns a block, given the offset of the first block.
fn block_at(first: u32, at: u32) -> mat4x4<f32> {
    let k = first + 4u * at;
    return mat4x4(rows[k], rows[k + 1u], rows[k + 2u], rows[k + 3u]);
}

fn set_block(first: u32, at: u32, block: mat4x4<f32>) {
    let k = first + 4u * at;
    rows[k] = block[0];
    rows[k + 1u] = block[1];
    rows[k + 2u] = block[2];
    rows[k + 3u] = block[3];
}

fn add_block(first: u32, at: u32, block: mat4x4<f32>) {
    set_block(first, at, block_at(first, at) + block);
}
