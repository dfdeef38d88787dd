// Writes the objectives of the last evaluation into a buffer of the application, laid out as the Rust struct
// ObjectiveValues.

const INFINITY: u32 = 0x7f800000u;
// Words of the values in the struct.
const OF_INVERTED = 0u;
const OF_WORST_IMR = 1u;
const OF_STOP = 2u;
const OF_SWEEPS = 3u;
const OF_WORST_TRIANGLE = 4u;
const OF_F = 5u;

@compute @workgroup_size(SLOTS)
fn write_objective(@builtin(local_invocation_index) slot: u32) {
    let last = ((control.evaluated - 1u) % HISTORY) * SLOTS;
    let sum = control.history[last + slot];
    var word = 0u;
    var to = OF_F + slot;
    if slot == INVERTED {
        to = OF_INVERTED;
        word = u32(sum.x) + u32(i32(sum.y));
    } else if slot == WORST {
        to = OF_WORST_IMR;
        // Infinity is written by its bits, as compilers may assume that there are no infinities.
        let is_tangled = control.history[last + INVERTED].x > 0.0;
        word = select(bitcast<u32>(sqrt(1.0 + sum.x)), INFINITY, is_tangled);
    } else {
        let ideal = publish_to.ideal_squared[slot / 4u][slot % 4u];
        word = bitcast<u32>(ideal + (sum.x + sum.y) / f32(publish_to.triangles));
    }
    destination[publish_to.offset + to] = word;
    if slot == 0u {
        // If the mesh has changed since the sweeps began, the next sweeps begin a new run, and the stop of the old run
        // is void.
        let holds = publish_to.judged != 0u && sweeps.changes == changes[0] + changes[1];
        destination[publish_to.offset + OF_STOP] = select(0u, sweeps.done, holds);
        let done = max(sweeps.evaluated, 1u) - 1u;
        destination[publish_to.offset + OF_SWEEPS] = select(0u, done, holds);
        let worst = bitcast<u32>(control.history[last + WORST].y);
        destination[publish_to.offset + OF_WORST_TRIANGLE] = worst - MIN_NORMAL;
        // The slots of metrics come first.
        for (var metric = INVERTED; metric < MOST_METRICS; metric++) {
            destination[publish_to.offset + OF_F + metric] = 0u;
        }
    }
}
