// Judges a trial and chooses the next length, by the rules of Search in src/run/multilevel/search.rs. After the last
// trial, or once a length is good enough, the movement gets the best length: 0 if no trial lowers the objective without
// breaking a triangle.

// Ends the search with the length of the movement, and sets the first trial length of the next search: the length
// taken. After a short movement, the next search starts longer, as the obstacle may be gone. Without a movement, the
// next search starts at half of the last trial.
fn settle_on(length: f32, last_tried: f32) {
    var first = length;
    if length == 0.0 {
        first = max(0.5 * last_tried, MIN_FIRST_LENGTH / 64.0);
    } else if length < MIN_FIRST_LENGTH {
        first = min(4.0 * length, MIN_FIRST_LENGTH);
    }
    vectors[LENGTHS] = vec2(length, min(first, MAX_FIRST_LENGTH));
    vectors[PROGRESS] = vec2(1.0, 0.0);
}

@compute @workgroup_size(1)
fn judge_trial() {
    if rests() {
        return;
    }
    let trial = vectors[PROGRESS].y + 1.0;
    let lengths = vectors[LENGTHS];
    let length = lengths.x;
    let here = vectors[TOTALS];
    let slope = vectors[TOTALS + 3u].x + vectors[TOTALS + 3u].y;
    // An expected decrease below NOISE times this scale is lost in rounding.
    let scale = max(here.x + params.ideal_sum, MIN_SCALE * f32(params.triangles));
    if !is_positive(-slope - NOISE * scale) {
        vectors[LENGTHS] = vec2(0.0, lengths.y);
        vectors[PROGRESS] = vec2(1.0, trial);
        return;
    }
    let change = pair_difference(vectors[TOTALS + 1u], here);
    let sound = vectors[TOTALS + 2u].x == 0.0 && is_finite(change);
    var best = vectors[BEST];
    var next = 0.0;
    if sound {
        let enough = change <= SUFFICIENT_DECREASE * length * slope;
        if enough && change < best.y {
            best = vec2(length, change);
            vectors[BEST] = best;
        }
        let bend = change - slope * length;
        let least = select(3.0 * length, -0.5 * slope * length * length / bend, bend > 0.0);
        let close = abs(least - length) <= CLOSE * length;
        if !(enough && (trial > 1.0 || close)) {
            next = clamp(least, 0.1 * length, 3.0 * length);
        }
    } else if best.x == 0.0 {
        next = 0.5 * length;
    }
    if next == 0.0 || trial >= f32(SEARCH_TRIALS) {
        settle_on(best.x, length);
        return;
    }
    vectors[LENGTHS] = vec2(next, lengths.y);
    vectors[PROGRESS] = vec2(0.0, trial);
}
