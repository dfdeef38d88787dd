#!/usr/bin/env bash
# Measures a graphics card within thirty minutes, on a machine that has neither Rust nor a network.
#
#   benches/on-gpu.sh --pack ARCHIVE.tar.xz [--profile release|dev]
#       builds the programs and packs them with this script; needs Rust, and apt for a Vulkan loader to take along
#   tar xf ARCHIVE.tar.xz && gpu-figures/on-gpu.sh [FOLDER] [--adapter NAME] [--sizes N,...] [--limit SECONDS] [--total SECONDS]
#       measures; FOLDER, by default `figures`, gets one file for each step, and steps.txt with the result of each
#
# Every step has a time limit and stands alone: after a failure, the next step begins. The order is by value, so that a visit that
# ends early has the most telling figures. --sizes are the numbers of vertices of kernels, runs and frames, --limit the seconds of
# a step at most, --total the seconds of all steps, by default 1800.
set -u

here=$(cd "$(dirname "$0")" && pwd)

pack() {
    set -e
    local archive=$1 profile=$2 place file name
    cd "$here/.."
    place=$(mktemp -d)
    mkdir "$place/gpu-figures"
    # cargo names each program in a line of JSON.
    cargo build --profile "$profile" --bin gpu-smooth --bench frames --bench convergence \
        --test embed --test metrics --test sweeps --message-format json-render-diagnostics > "$place/built"
    for file in $(sed -n 's/.*"executable":"\([^"]*\)".*/\1/p' "$place/built"); do
        # The programs of benchmarks and tests end in a hash.
        name=$(basename "$file" | sed 's/-[0-9a-f]\{16\}$//')
        cp "$file" "$place/gpu-figures/$name"
        strip "$place/gpu-figures/$name" 2>/dev/null || true
    done
    cp "$here/on-gpu.sh" "$place/gpu-figures/"
    cp -r meshes "$place/gpu-figures/"
    git log -1 --format='%H %cI' > "$place/gpu-figures/version.txt" 2>/dev/null || true
    # A bare machine with a driver may lack the loader.
    mkdir "$place/gpu-figures/deb"
    (cd "$place/gpu-figures/deb" && apt-get download libvulkan1) >/dev/null 2>&1 ||
        echo "no package libvulkan1 to take along: the machine must have a Vulkan loader" >&2
    tar -C "$place" -caf "$archive" gpu-figures
    rm -r "$place"
    ls -l "$archive"
}

out='' adapter='' sizes=10000,100000,1000000,10000000 limit=600 total=1800 archive='' profile=release
while [ $# -gt 0 ]; do
    case $1 in
        --pack) archive=$(realpath -m "${2:?}"); shift 2 ;;
        --profile) profile=${2:?}; shift 2 ;;
        --adapter) adapter=${2:?}; shift 2 ;;
        --sizes) sizes=${2:?}; shift 2 ;;
        --limit) limit=${2:?}; shift 2 ;;
        --total) total=${2:?}; shift 2 ;;
        -*) sed -n '2,/^set/s/^# \{0,1\}//p' "$0"; exit 2 ;;
        *) out=$1; shift ;;
    esac
done
if [ -n "$archive" ]; then
    pack "$archive" "$profile"
    exit
fi
if [ ! -x "$here/gpu-smooth" ]; then
    echo "no program gpu-smooth beside this script: pack an archive first ($0 --pack ARCHIVE.tar.xz)" >&2
    exit 2
fi

mkdir -p "${out:=figures}" && out=$(cd "$out" && pwd) || exit 1
cd "$here" || exit 1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
# Drivers keep compiled kernels in these folders. They begin empty, so that the first start is a cold one.
export XDG_RUNTIME_DIR=$scratch XDG_CACHE_HOME=$scratch/cache MESA_SHADER_CACHE_DIR=$scratch/cache
export __GL_SHADER_DISK_CACHE_PATH=$scratch/cache
mkdir "$scratch/cache"
if ! ldconfig -p 2>/dev/null | grep -q 'libvulkan\.so\.1'; then
    for package in deb/*.deb; do
        if [ -e "$package" ]; then dpkg -x "$package" "$scratch/root"; fi
    done
    export LD_LIBRARY_PATH=$scratch/root/usr/lib/$(uname -m)-linux-gnu
fi
export g=./gpu-smooth scratch
export adapter GPU_SMOOTH_ADAPTER=$adapter
if [ -z "$adapter" ]; then unset GPU_SMOOTH_ADAPTER; fi

# Runs a step: name, seconds at most, commands. The output goes to a file of that name.
step() {
    local name=$1 most=$2 began=$SECONDS code
    shift 2
    if [ "$most" -gt "$limit" ]; then most=$limit; fi
    if [ "$most" -gt $((total - SECONDS)) ]; then most=$((total - SECONDS)); fi
    if [ "$most" -lt 1 ]; then
        echo "$name: left out, as $total s are over" | tee -a "$out/steps.txt"
        return
    fi
    timeout --kill-after 10 "$most" bash -c "$*" > "$out/$name.txt" 2>&1
    code=$?
    if [ $code -eq 124 ] || [ $code -eq 137 ]; then code="$code (over $most s)"; fi
    printf '%-20s exit status %s, %d s\n' "$name" "$code" $((SECONDS - began)) | tee -a "$out/steps.txt"
}

: > "$out/steps.txt"
step system 30 'date -u; cat version.txt; uname -a; nproc; lscpu; free -m
    ls /usr/share/vulkan/icd.d /etc/vulkan/icd.d; nvidia-smi; nvidia-smi -q -d CLOCK,POWER,PERFORMANCE; true'
step adapters 60 '$g adapters'
if [ -z "$adapter" ] && head -1 "$out/adapters.txt" | grep -q '(CPU: software,'; then
    echo "no graphics card among the adapters, so software is measured: $(head -1 "$out/adapters.txt")" | tee -a "$out/steps.txt"
fi
# The first start compiles all kernels, the others take them from the driver's cache. `in one process` leaves out the process that
# tries the driver first.
step start 120 'rm -rf "$scratch"/cache/*
    for how in cold warm warm; do echo "== $how"
        time $g meshes/plate.node "$scratch/o.node" --force --engine gpu ${adapter:+--adapter "$adapter"}; done
    for how in "two processes" "two processes"; do echo "== adapters, $how"; time $g adapters; done
    for how in "one process" "one process"; do echo "== adapters, $how"; time GPU_SMOOTH_IS_TRIAL=1 $g adapters; done'
step right 120 'for m in meshes/*.node; do for e in gpu cpu; do
        set --; if [ $e = gpu ] && [ -n "$adapter" ]; then set -- --adapter "$adapter"; fi
        $g "$m" "$scratch/$e.node" --force --engine $e "$@" || exit 1; done
        $g compare "$m" "$scratch/gpu.node" || exit 1; $g compare "$scratch/cpu.node" "$scratch/gpu.node"; done'
for n in ${sizes//,/ }; do
    step "runs-$n" 240 "\$g bench --runs --engine gpu \${adapter:+--adapter \"\$adapter\"} --seconds 1 --markdown --vertices $n
        \$g bench --runs --engine cpu --seconds 1 --markdown --vertices $n"
    step "kernels-$n" 120 "\$g bench --engine gpu \${adapter:+--adapter \"\$adapter\"} --seconds 1 --markdown --vertices $n"
done
step runs-json 240 "\$g bench --runs --engine gpu \${adapter:+--adapter \"\$adapter\"} --seconds 1 --json --vertices ${sizes%,*}"
small=''
for n in ${sizes//,/ }; do if [ "$n" -le 1000000 ]; then small="$small $n"; fi; done
step frames 90 "./frames $small"
step kernels-edge 120 "\$g bench --engine gpu \${adapter:+--adapter \"\$adapter\"} --seconds 1 --scheme edge --markdown --vertices 100000"
export GPU_SMOOTH_MESHES=$here/meshes
# Tests take the best adapter. Those of counts need Mesa's software driver.
for t in metrics sweeps embed; do
    step "tests-$t" 240 "./$t --test-threads $(nproc) --skip counts::"
done
step convergence 240 './convergence 57000'
tar -C "$(dirname "$out")" -czf "$out.tar.gz" "$(basename "$out")" && echo "$out.tar.gz has all figures"
