//! Each kernel on each backend of wgpu: naga translates it, and the validators of Khronos accept the result.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use gpu_smooth::gpu::Kernel;
use rayon::prelude::*;
use tempfile::TempDir;

use crate::translations::{self, DIRECT3D, METAL, OPEN_GL, VULKAN};
use crate::{Validated, modules, validated};

/// Runs a validator. The message of a failure says how to install the validator.
fn run(command: &mut Command, package: &str) -> Output {
    command.output().unwrap_or_else(|error| {
        panic!(
            "{:?} does not start: {error}. tests/run installs it; on Debian, `apt-get install {package}` does",
            command.get_program()
        )
    })
}

fn spirv_val(environment: &str, file: &Path) -> Result<(), String> {
    let mut command = Command::new("spirv-val");
    let output = run(command.args(["--target-env", environment]).arg(file), "spirv-tools");
    match output.status.success() {
        true => Ok(()),
        false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
    }
}

/// Checks GLSL files, whose names end in `.comp`, in one process.
fn glslang(files: &[String], folder: &Path) -> Result<(), String> {
    let mut command = Command::new("glslangValidator");
    let output = run(command.arg("-t").args(files).current_dir(folder), "glslang-tools");
    match output.status.success() {
        true => Ok(()),
        false => Err(String::from_utf8_lossy(&output.stdout).into_owned()),
    }
}

/// Calls `check` for each distinct module of the kernels, on all threads. The first argument of `check` is a file name
/// with the number of the module and the label of the kernel.
fn for_each_module(check: impl Fn(&str, translations::Kernel<'_>) + Sync) {
    modules().par_iter().enumerate().for_each(|(number, Validated { kernel, module, info })| {
        let name = format!("{number}-{}", kernel.label().replace([' ', '+', '/'], "-"));
        check(&name, translations::Kernel { module, info, entry_point: kernel.entry_point() });
    });
}

fn words_as_bytes(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

#[test]
fn spirv_val_accepts_every_kernel_on_the_oldest_and_newest_vulkan() {
    let folder = TempDir::new().unwrap();
    for_each_module(|name, kernel| {
        for vulkan in VULKAN {
            let words = kernel.spirv(vulkan).unwrap_or_else(|error| panic!("{name}: {error}"));
            let file = folder.path().join(format!("{name}-{}.spv", vulkan.environment));
            fs::write(&file, words_as_bytes(&words)).unwrap();
            spirv_val(vulkan.environment, &file)
                .unwrap_or_else(|error| panic!("{name} on {}: {error}", vulkan.environment));
        }
    });
}

#[test]
fn glslang_accepts_every_kernel_on_opengl() {
    let folder = TempDir::new().unwrap();
    for_each_module(|name, kernel| {
        for (number, version) in OPEN_GL.into_iter().enumerate() {
            let text = kernel.glsl(version).unwrap_or_else(|error| panic!("{name}: {error}"));
            fs::write(folder.path().join(format!("{name}-{number}.comp")), text).unwrap();
        }
    });
    let files = fs::read_dir(folder.path()).unwrap();
    let mut files: Vec<String> =
        files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    files.sort();
    assert!(files.len() > 2 * Kernel::all().len(), "only {} files", files.len());
    // glslang takes a second for a hundred files, most of it for its own declarations.
    let failures: Vec<String> = files
        .par_chunks(files.len().div_ceil(rayon::current_num_threads()))
        .filter_map(|files| glslang(files, folder.path()).err())
        .collect();
    assert_eq!(failures, [""; 0]);
}

#[test]
fn every_kernel_has_a_translation_for_metal_and_direct3d() {
    for_each_module(|name, kernel| {
        for version in METAL {
            let text = kernel.msl(version).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(text.contains("kernel void"), "{name} for Metal {version:?}");
        }
        for model in DIRECT3D {
            let (text, entry_point) =
                kernel.hlsl(model).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(text.contains(&format!("void {entry_point}(")), "{name} for {model:?}");
        }
    });
}

const SMALL: &str = "@group(0) @binding(0) var<storage, read_write> a: array<f32>;
    @compute @workgroup_size(64) fn f(@builtin(global_invocation_id) i: vec3<u32>) { a[i.x] += 1.0; }";

#[test]
fn validators_refuse_damaged_kernels() {
    let folder = TempDir::new().unwrap();
    let (module, info) = validated(SMALL).unwrap();
    let kernel = translations::Kernel { module: &module, info: &info, entry_point: "f" };
    let file = folder.path().join("f.spv");
    let words = kernel.spirv(VULKAN[0]).unwrap();
    let check = |words: &[u32]| {
        fs::write(&file, words_as_bytes(words)).unwrap();
        spirv_val(VULKAN[0].environment, &file)
    };
    check(&words).unwrap();
    // Without its end, the last function has no OpFunctionEnd.
    check(&words[..words.len() - 1]).unwrap_err();

    let text = kernel.glsl(OPEN_GL[0]).unwrap();
    let check = |text: &str| {
        fs::write(folder.path().join("f.comp"), text).unwrap();
        glslang(&["f.comp".to_owned()], folder.path())
    };
    check(&text).unwrap();
    check(&text.replace("1.0", "undeclared")).unwrap_err();
}

#[test]
fn checks_at_run_time_are_in_the_translations() {
    // A loop whose number of rounds the compiler does not know.
    let looping =
        SMALL.replace("a[i.x] += 1.0;", "for (var k = 0u; k < i.x; k++) { a[k] += 1.0; }");
    let (module, info) = validated(&looping).unwrap();
    let kernel = translations::Kernel { module: &module, info: &info, entry_point: "f" };
    let msl = kernel.msl(METAL[0]).unwrap();
    let (hlsl, _) = kernel.hlsl(DIRECT3D[0]).unwrap();
    assert!(msl.contains("loop_bound") && hlsl.contains("loop_bound"), "{msl}\n{hlsl}");
    assert!(msl.contains("_buffer_sizes") && msl.contains("metal::min("), "{msl}");
    let [checked, robust] = VULKAN.map(|vulkan| kernel.spirv(vulkan).unwrap().len());
    assert!(checked > robust, "{checked} words with checks of bounds, {robust} without");
}

/// Returns the dependency on a crate that a package of Cargo.lock has: the name, with the version where there are several.
fn dependency(lock: &str, package: &str, on: &str) -> Option<String> {
    let block =
        lock.split("[[package]]").find(|b| b.contains(&format!("\nname = \"{package}\"\n")))?;
    let (_, dependencies) = block.split_once("dependencies = [")?;
    let mut names = dependencies.split('"').skip(1).step_by(2);
    names.find(|name| name.split(' ').next() == Some(on)).map(str::to_owned)
}

#[test]
fn naga_is_of_the_version_that_wgpu_uses() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.lock");
    let lock = fs::read_to_string(file).unwrap();
    let of = |package| {
        let found = dependency(&lock, package, "naga");
        found.unwrap_or_else(|| panic!("{package} does not depend on naga in Cargo.lock"))
    };
    for package in ["wgpu-core", "wgpu-hal"] {
        assert_eq!(
            of("gpu-smooth-tests"),
            of(package),
            "set the version of naga in tests/Cargo.toml to that of {package}"
        );
    }
    let two = "[[package]]\nname = \"a\"\ndependencies = [\n \"b 1\",\n \"naga 29.0.0\",\n]\n";
    assert_eq!(dependency(two, "a", "naga").as_deref(), Some("naga 29.0.0"));
}
