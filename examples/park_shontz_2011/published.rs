//! Numbers published by Park and Shontz (2011). Runs supply all other numbers of the report.

/// Total times to convergence in seconds, from Tables 3 and 4. The last two schemes are from the text of Section 3.
pub(crate) const SECONDS: &[(&str, [f64; 6])] = &[
    ("edge", [3399.36, 2292.47, 1911.24, 2867.59, 2986.64, 1799.52]),
    ("edge+imr", [1538.69, 1077.72, 897.54, 1350.37, 1412.19, 840.54]),
    ("edge+ar", [1625.29, 1153.18, 964.74, 1429.75, 1512.19, 898.55]),
    ("rms", [3225.57, 2830.56, 1909.88, 2875.84, 3019.28, 1800.32]),
    ("rms+imr", [1529.34, 1091.02, 904.62, 1370.29, 1424.02, 831.96]),
    ("rms+ar", [1620.61, 1147.5, 965.22, 1451.6, 1506.85, 916.27]),
    ("area", [28.45, 24.41, 22.36, 26.98, 27.51, 21.77]),
    ("area+imr", [24.02, 20.52, 18.68, 22.8, 23.27, 18.22]),
    ("area+ar", [24.78, 21.2, 19.44, 23.55, 24.1, 18.94]),
    ("edge+imr+imr", [1079.86, 760.63, 640.01, 964.69, 1008.43, 597.87]),
    ("edge+imr+imr+imr", [789.01, 561.38, 473.49, 708.55, 740.53, 443.34]),
];

/// Numbers of sweeps to convergence, from Table 5.
pub(crate) const SWEEPS: &[(&str, [u32; 6])] = &[
    ("edge", [19, 21, 16, 13, 27, 26]),
    ("edge+imr", [19, 20, 16, 13, 27, 26]),
    ("edge+ar", [19, 20, 16, 13, 27, 26]),
    ("rms", [22, 19, 21, 17, 23, 19]),
    ("rms+imr", [22, 19, 21, 17, 23, 19]),
    ("rms+ar", [22, 19, 21, 17, 23, 19]),
    ("area", [20, 21, 19, 16, 21, 20]),
    ("area+imr", [20, 21, 19, 16, 21, 20]),
    ("area+ar", [20, 21, 19, 16, 21, 20]),
];

/// Seconds per sweep, from Table 5.
pub(crate) const SECONDS_PER_SWEEP: &[(&str, [f64; 6])] = &[
    ("edge", [178.9135, 109.1652, 119.4525, 220.5838, 110.6163, 69.21231]),
    ("edge+imr", [80.98368, 53.886, 56.09625, 103.8746, 52.30333, 32.32846]),
    ("edge+ar", [85.54158, 57.659, 60.29625, 109.9808, 56.0071, 34.55962]),
    ("rms", [146.6168, 148.9768, 90.94667, 169.1671, 131.273, 94.75368]),
    ("rms+imr", [69.51545, 57.42211, 43.07714, 80.60529, 61.91391, 43.78737]),
    ("rms+ar", [73.66409, 60.39632, 45.96286, 85.38824, 65.51522, 48.22474]),
    ("area", [1.4225, 1.162381, 1.176842, 1.68625, 1.31, 1.0885]),
    ("area+imr", [1.201, 0.977143, 0.983158, 1.425, 1.108095, 0.911]),
    ("area+ar", [1.239, 1.009524, 1.023158, 1.471875, 1.147619, 0.947]),
];

/// Percentage of time that EDGE+IMR saves, by the text of Section 3.
pub(crate) const TEXT_EDGE_IMR: [f64; 6] = [54.7, 52.9, 53.0, 52.9, 40.0, 53.3];

/// Returns the row of a scheme in a table; `None` if the table lacks the scheme.
pub(crate) fn row<T: Copy>(table: &[(&str, [T; 6])], scheme: &str) -> Option<[T; 6]> {
    table.iter().find(|(name, _)| *name == scheme).map(|&(_, row)| row)
}

/// Returns the published fraction of time that `scheme` saves against `base`, for each domain.
pub(crate) fn saved(scheme: &str, base: &str) -> Option<[f64; 6]> {
    let (after, before) = (row(SECONDS, scheme)?, row(SECONDS, base)?);
    Some(std::array::from_fn(|i| 1.0 - after[i] / before[i]))
}
