//! Checks of each kernel's WGSL without an adapter: core WebGPU only, within the limits guaranteed by browsers, and
//! translated for each backend.

mod backends;
mod translations;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use gpu_smooth::gpu::Kernel;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Block, Module, ShaderStage, Statement};
use rayon::prelude::*;

/// Guaranteed minimum of WebGPU's `max_compute_invocations_per_workgroup`.
const MOST_INVOCATIONS: u32 = 256;
/// Guaranteed minimum of WebGPU's `max_storage_buffers_per_shader_stage`.
const MOST_STORAGE_BUFFERS: usize = 8;
/// Guaranteed minimum of WebGPU's `max_compute_workgroup_storage_size`.
const MOST_WORKGROUP_BYTES: u32 = 16384;

fn validated(wgsl: &str) -> Result<(Module, ModuleInfo), String> {
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|e| e.emit_to_string(wgsl))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).map_err(|e| e.emit_to_string(wgsl))?;
    Ok((module, info))
}

/// A kernel with a valid module.
struct Validated {
    kernel: Kernel,
    module: Module,
    info: ModuleInfo,
}

/// Returns the distinct modules of each kernel: for meshes bound as a whole, for large meshes, for meshes with targets,
/// for strongly stretched meshes, for bounded meshes, and for quadrilaterals. All tests share them, as validation takes most of their time.
fn modules() -> &'static [Validated] {
    static MODULES: OnceLock<Vec<Validated>> = OnceLock::new();
    MODULES.get_or_init(|| {
        let of_kernel = |kernel: Kernel| {
            let forms = BTreeSet::from([
                kernel.wgsl(),
                kernel.wgsl_for_large_meshes(),
                kernel.wgsl_for_targets(),
                kernel.wgsl_for_stretched_meshes(),
                kernel.wgsl_for_bounded_meshes(),
                kernel.wgsl_for_quadrilaterals(),
            ]);
            forms.into_iter().map(move |wgsl| (kernel.clone(), wgsl))
        };
        let sources: Vec<_> = Kernel::all().into_iter().flat_map(of_kernel).collect();
        let validated = |(kernel, wgsl): (Kernel, String)| {
            let (module, info) =
                validated(&wgsl).unwrap_or_else(|error| panic!("{}: {error}", kernel.label()));
            Validated { kernel, module, info }
        };
        sources.into_par_iter().map(validated).collect()
    })
}

#[test]
fn every_kernel_is_core_webgpu() {
    // Making the modules validates them.
    assert!(modules().len() > Kernel::all().len());
}

#[test]
fn validation_refuses_capabilities_beyond_core_webgpu() {
    let bare = "@compute @workgroup_size(1) fn f() { let x = 1.0; }";
    validated(bare).unwrap();
    validated(&bare.replace("1.0", "f64(1.0)")).unwrap_err();
    validated(&bare.replace("1.0", "undeclared")).unwrap_err();
}

/// Collects the entry points declared by the files of a folder.
fn add_entry_points(folder: &Path, names: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            add_entry_points(&path, names);
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let after = text.split("@compute").skip(1).filter_map(|after| after.split_once("fn "));
        names.extend(after.filter_map(|(_, name)| Some(name.split_once('(')?.0.to_owned())));
    }
}

#[test]
fn every_entry_point_of_the_shader_files_has_a_row_in_the_table() {
    let mut declared = BTreeSet::new();
    add_entry_points(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../shaders"), &mut declared);
    let of_rows = Kernel::all().iter().map(|kernel| kernel.entry_point().to_owned()).collect();
    assert_eq!(declared, of_rows);
}

#[test]
fn every_kernel_has_one_entry_point_of_its_name() {
    for Validated { kernel, module, .. } in modules() {
        let [entry] = &module.entry_points[..] else {
            panic!("{} has {} entry points", kernel.label(), module.entry_points.len());
        };
        assert_eq!(
            (entry.name.as_str(), entry.stage),
            (kernel.entry_point(), ShaderStage::Compute)
        );
    }
}

#[test]
fn workgroups_are_as_wide_as_the_table_says_and_within_the_limit() {
    for Validated { kernel, module, .. } in modules() {
        let size = module.entry_points[0].workgroup_size;
        assert_eq!(size, [kernel.workgroup_size(), 1, 1], "{}", kernel.label());
        assert!(size.iter().product::<u32>() <= MOST_INVOCATIONS);
    }
}

#[test]
fn storage_buffers_and_workgroup_memory_are_within_the_limits() {
    for Validated { kernel, module, .. } in modules() {
        let is_storage = |space| matches!(space, AddressSpace::Storage { .. });
        let spaces = module.global_variables.iter().map(|(_, variable)| variable.space);
        let storage = spaces.filter(|&space| is_storage(space)).count();
        assert!(storage <= MOST_STORAGE_BUFFERS, "{} has {storage}", kernel.label());

        let shared =
            module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::WorkGroup);
        let bytes: u32 = shared.map(|(_, v)| module.types[v.ty].inner.size(module.to_ctx())).sum();
        assert!(bytes <= MOST_WORKGROUP_BYTES, "{} has {bytes} bytes", kernel.label());
    }
}

/// An event in program order that matters for barriers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    Barrier { in_branch: bool },
    Exit,
}

fn events(module: &Module, block: &Block, in_branch: bool, found: &mut Vec<Event>) {
    for statement in block {
        match statement {
            Statement::ControlBarrier(_) | Statement::WorkGroupUniformLoad { .. } => {
                found.push(Event::Barrier { in_branch });
            }
            Statement::Return { .. } | Statement::Kill => found.push(Event::Exit),
            Statement::Block(inner) => events(module, inner, in_branch, found),
            Statement::If { accept, reject, .. } => {
                events(module, accept, true, found);
                events(module, reject, true, found);
            }
            Statement::Switch { cases, .. } => {
                cases.iter().for_each(|case| events(module, &case.body, true, found));
            }
            Statement::Loop { body, continuing, .. } => {
                events(module, body, in_branch, found);
                events(module, continuing, in_branch, found);
            }
            Statement::Call { function, .. } => {
                // A `return` inside a called function does not end the kernel.
                let mut inner = Vec::new();
                events(module, &module.functions[*function].body, in_branch, &mut inner);
                found.extend(inner.into_iter().filter(|&event| event != Event::Exit));
            }
            _ => {}
        }
    }
}

/// Counts the barriers of a kernel, or returns the reason why a browser would refuse the kernel. All invocations must
/// reach a barrier, which naga does not check. This check ignores the conditions of branches, so it is stricter than
/// browsers.
fn barriers(module: &Module) -> Result<usize, &'static str> {
    let mut found = Vec::new();
    events(module, &module.entry_points[0].function.body, false, &mut found);
    if found.contains(&Event::Barrier { in_branch: true }) {
        return Err("a barrier in a branch");
    }
    let is_barrier = |event: &Event| matches!(event, Event::Barrier { .. });
    let Some(last) = found.iter().rposition(is_barrier) else { return Ok(0) };
    if found[..last].contains(&Event::Exit) {
        return Err("a return before a barrier");
    }
    Ok(found.iter().filter(|event| is_barrier(event)).count())
}

#[test]
fn no_invocation_leaves_before_a_barrier() {
    for Validated { kernel, module, .. } in modules() {
        let count = barriers(module).unwrap_or_else(|fault| panic!("{}: {fault}", kernel.label()));
        // Only invocations that share results wait for each other. They form one workgroup of the largest guaranteed
        // size.
        let shares = kernel.workgroup_size() == MOST_INVOCATIONS;
        assert_eq!(count > 0, shares, "{}", kernel.label());
    }
}

#[test]
fn a_barrier_that_not_all_invocations_reach_is_found() {
    let check = |body: &str| {
        let text = format!(
            "fn meet() {{ workgroupBarrier(); return; }}
            @compute @workgroup_size(64)
            fn f(@builtin(local_invocation_index) i: u32) {{ {body} }}"
        );
        barriers(&validated(&text).unwrap().0)
    };
    assert_eq!(check("for (var k = 0u; k < 4u; k++) { meet(); } if i > 0u { return; }"), Ok(1));
    assert_eq!(
        check("if i > 9u { return; } workgroupBarrier();"),
        Err("a return before a barrier")
    );
    assert_eq!(check("if i > 9u { return; } meet();"), Err("a return before a barrier"));
    assert_eq!(check("if i > 9u { workgroupBarrier(); }"), Err("a barrier in a branch"));
    assert_eq!(
        check("switch i { case 1u: { meet(); } default: {} }"),
        Err("a barrier in a branch")
    );
}
