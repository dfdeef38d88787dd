//! A short version of the fuzzing in `fuzz/`, on any toolchain and with fixed inputs. The environment variable
//! `FUZZ_ROUNDS` multiplies the number of rounds. Inputs of former failures are tests of their own.

#[path = "../fuzz/checks.rs"]
mod checks;

use std::env;
use std::path::Path;

use checks::Became;
use gpu_smooth::Backend;
use support::SplitMix64;

/// Returns the number of rounds: `usual`, which take approximately a second, times `FUZZ_ROUNDS`.
fn rounds(usual: usize) -> usize {
    let factor = env::var("FUZZ_ROUNDS").ok().and_then(|text| text.parse().ok());
    usual * factor.unwrap_or(1)
}

fn any_bytes(random: &mut SplitMix64, most: usize) -> Vec<u8> {
    let length = random.below(most + 1);
    (0..length).map(|_| random.below(256) as u8).collect()
}

#[test]
fn meshes_of_any_shape() {
    let mut random = SplitMix64::new(13);
    let became = |bytes: &[u8]| checks::any_mesh(bytes, &Backend::Cpu);
    let all: Vec<Became> = (0..rounds(400)).map(|_| became(&any_bytes(&mut random, 260))).collect();
    // Each kind of result must make up more than a twentieth of all.
    for kind in [Became::Refused, Became::Smoothed, Became::Untangled, Became::StillTangled] {
        let count = all.iter().filter(|became| **became == kind).count();
        assert!(20 * count > all.len(), "{count} of {}", all.len());
    }
}

#[test]
fn meshes_of_any_shape_on_a_gpu() {
    let mut random = SplitMix64::new(14);
    let gpu = Backend::Gpu(gpu_smooth::Gpu::open(None).block().unwrap());
    for _ in 0..rounds(15) {
        checks::any_mesh(&any_bytes(&mut random, 260), &gpu);
    }
}

/// Writes the initial inputs of the fuzzer, if the environment variable FUZZ_CORPUS names a folder.
#[test]
fn the_corpus_can_be_written() {
    let Some(folder) = env::var_os("FUZZ_CORPUS") else { return };
    let write = |target: &str, name: usize, bytes: &[u8]| {
        let folder = Path::new(&folder).join(target);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(name.to_string()), bytes).unwrap();
    };
    let mut random = SplitMix64::new(15);
    (0..40).for_each(|name| write("smooth", name, &any_bytes(&mut random, 260)));
}
