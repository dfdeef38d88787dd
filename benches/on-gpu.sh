#!/usr/bin/env bash
# Measures a real GPU for docs/performance.md: the adapter and its driver, whole sweeps and kernels from 10,000 to 10
# million vertices, the speed of copying, convergence, and all tests. Writes to a folder, by default gpu-figures.
#
#   benches/on-gpu.sh [FOLDER] [ADAPTER]
set -euo pipefail
folder=$(mkdir -p "${1:-gpu-figures}" && cd "${1:-gpu-figures}" && pwd)
cd "$(dirname "$0")/.."
adapter=(${2:+--adapter "$2"})

cargo build --release
smooth=target/release/gpu-smooth
"$smooth" adapters | tee "$folder/adapters.txt"
if [ -z "${2:-}" ] && head -1 "$folder/adapters.txt" | grep -q '(CPU: software,'; then
    echo "no GPU among these adapters: install its Vulkan driver, or name one" >&2
    exit 1
fi
for scheme in imr edge edge+imr; do
    "$smooth" bench --engine gpu "${adapter[@]}" --scheme "$scheme" \
        --vertices 10000,100000,1000000,4000000,10000000 | tee "$folder/bench-$scheme.txt"
done
"$smooth" bench --engine gpu "${adapter[@]}" --json \
    --vertices 10000,100000,1000000,4000000,10000000 > "$folder/bench.json"
cargo bench -p gpu-smooth-cli --bench whole -- 62534 1000000 | tee "$folder/whole.txt"
cargo bench --bench convergence -- 57000 1000000 | tee "$folder/convergence.txt"
cargo test --release | tee "$folder/tests.txt"
