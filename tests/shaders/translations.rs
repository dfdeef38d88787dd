//! naga's translations of each kernel, made with the options that wgpu uses on each of its backends.
//!
//! wgpu decides these options in wgpu-hal: `vulkan/adapter.rs`, `metal/device.rs`, `dx12/device.rs` and
//! `gles/device.rs`. All checks at run time are on, as they are for modules of `Device::create_shader_module`.

use std::collections::BTreeMap;

use naga::back::{TaskDispatchLimits, glsl, hlsl, msl, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::ModuleInfo;
use naga::{AddressSpace, Module, ResourceBinding, ShaderStage, StorageAccess};

/// Limits of mesh shaders, which no kernel uses.
const LIMITS: TaskDispatchLimits =
    TaskDispatchLimits { max_mesh_workgroups_per_dim: 0, max_mesh_workgroups_total: 0 };

/// A version of Vulkan, with the options that depend on the driver.
#[derive(Clone, Copy)]
pub(crate) struct Vulkan {
    /// The environment in the words of `spirv-val`.
    pub(crate) environment: &'static str,
    /// The version of SPIR-V that wgpu takes with this version of Vulkan.
    spirv: (u8, u8),
    /// Whether the driver has `robustBufferAccess2` and clears the memory of workgroups by itself.
    is_robust: bool,
}

/// The oldest and the newest version of Vulkan that wgpu distinguishes.
pub(crate) const VULKAN: [Vulkan; 2] = [
    Vulkan { environment: "vulkan1.0", spirv: (1, 0), is_robust: false },
    Vulkan { environment: "vulkan1.3", spirv: (1, 6), is_robust: true },
];

/// OpenGL ES 3.1, the oldest version with compute shaders, and the newest version of desktop OpenGL that naga knows.
pub(crate) const OPEN_GL: [glsl::Version; 2] =
    [glsl::Version::Embedded { version: 310, is_webgl: false }, glsl::Version::Desktop(450)];

/// The languages of macOS 10.13 and of macOS 26.
pub(crate) const METAL: [(u8, u8); 2] = [(2, 0), (4, 0)];

/// The shader model of Microsoft's old compiler, and the newest of the new one.
pub(crate) const DIRECT3D: [hlsl::ShaderModel; 2] =
    [hlsl::ShaderModel::V5_1, hlsl::ShaderModel::V6_9];

/// A valid module with a single entry point.
pub(crate) struct Kernel<'m> {
    pub(crate) module: &'m Module,
    pub(crate) info: &'m ModuleInfo,
    pub(crate) entry_point: &'m str,
}

/// The access of a kernel to one binding.
#[derive(Clone, Copy, PartialEq)]
enum Access {
    Uniform,
    Read,
    ReadWrite,
}

impl Kernel<'_> {
    fn bindings(&self) -> impl Iterator<Item = (ResourceBinding, Access)> {
        self.module.global_variables.iter().filter_map(|(_, variable)| {
            let access = match variable.space {
                AddressSpace::Uniform => Access::Uniform,
                AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => {
                    Access::ReadWrite
                }
                _ => Access::Read,
            };
            Some((variable.binding?, access))
        })
    }

    /// Numbers the bindings from 0 on, by the group that `group` returns for the access.
    fn numbered<G: Ord>(&self, group: impl Fn(Access) -> G) -> Vec<(ResourceBinding, Access, u32)> {
        let mut next = BTreeMap::new();
        let number = |(binding, access)| {
            let next: &mut u32 = next.entry(group(access)).or_default();
            *next += 1;
            (binding, access, *next - 1)
        };
        self.bindings().map(number).collect()
    }

    /// Translates the kernel to SPIR-V, as wgpu does on Vulkan.
    pub(crate) fn spirv(&self, vulkan: Vulkan) -> Result<Vec<u32>, String> {
        let policy = match vulkan.is_robust {
            true => BoundsCheckPolicy::Unchecked,
            false => BoundsCheckPolicy::Restrict,
        };
        // The binding of a slot is its number in the group.
        let binding = |(at, _, binding)| {
            (at, spv::BindingInfo { descriptor_set: 0, binding, binding_array_size: None })
        };
        let options = spv::Options {
            lang_version: vulkan.spirv,
            flags: spv::WriterFlags::LABEL_VARYINGS | spv::WriterFlags::FORCE_POINT_SIZE,
            // Those that every driver has. wgpu adds further ones for features that this library does not ask for.
            capabilities: Some(
                [spv::Capability::Shader, spv::Capability::Matrix].into_iter().collect(),
            ),
            bounds_check_policies: BoundsCheckPolicies {
                index: BoundsCheckPolicy::Restrict,
                buffer: policy,
                image_load: policy,
                binding_array: BoundsCheckPolicy::Unchecked,
            },
            zero_initialize_workgroup_memory: match vulkan.is_robust {
                true => spv::ZeroInitializeWorkgroupMemoryMode::Native,
                false => spv::ZeroInitializeWorkgroupMemoryMode::Polyfill,
            },
            force_loop_bounding: true,
            ray_query_initialization_tracking: true,
            use_storage_input_output_16: false,
            fake_missing_bindings: false,
            binding_map: self.numbered(|_| ()).into_iter().map(binding).collect(),
            debug_info: None,
            task_dispatch_limits: Some(LIMITS),
            mesh_shader_primitive_indices_clamp: true,
            trace_ray_argument_validation: true,
            emit_int_div_checks: true,
        };
        let pipeline = spv::PipelineOptions {
            shader_stage: ShaderStage::Compute,
            entry_point: self.entry_point.to_owned(),
        };
        spv::write_vec(self.module, self.info, &options, Some(&pipeline))
            .map_err(|error| error.to_string())
    }

    /// Translates the kernel to GLSL, as wgpu does on OpenGL.
    pub(crate) fn glsl(&self, version: glsl::Version) -> Result<String, String> {
        let slots = self.numbered(|access| access == Access::Uniform);
        let options = glsl::Options {
            version,
            writer_flags: glsl::WriterFlags::ADJUST_COORDINATE_SPACE
                | glsl::WriterFlags::FORCE_POINT_SIZE,
            binding_map: slots.into_iter().map(|(at, _, slot)| (at, slot as u8)).collect(),
            zero_initialize_workgroup_memory: true,
        };
        let pipeline = glsl::PipelineOptions {
            shader_stage: ShaderStage::Compute,
            entry_point: self.entry_point.to_owned(),
            multiview: None,
        };
        let policies = BoundsCheckPolicies {
            index: BoundsCheckPolicy::Unchecked,
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: BoundsCheckPolicy::Unchecked,
            binding_array: BoundsCheckPolicy::Unchecked,
        };
        let mut text = String::new();
        glsl::Writer::new(&mut text, self.module, self.info, &options, &pipeline, policies)
            .and_then(|mut writer| writer.write())
            .map_err(|error| error.to_string())?;
        Ok(text)
    }

    /// Translates the kernel to Metal's language, as wgpu does on Metal.
    pub(crate) fn msl(&self, lang_version: (u8, u8)) -> Result<String, String> {
        let slots = self.numbered(|_| ());
        let sizes = slots.len() as u8;
        let target = |(at, access, slot)| {
            let mutable = access == Access::ReadWrite;
            let target =
                msl::BindTarget { buffer: Some(slot as u8), mutable, ..Default::default() };
            (at, target)
        };
        let resources = msl::EntryPointResources {
            resources: slots.into_iter().map(target).collect(),
            immediates_buffer: None,
            sizes_buffer: Some(sizes),
        };
        let options = msl::Options {
            lang_version,
            per_entry_point_map: [(self.entry_point.to_owned(), resources)].into(),
            inline_samplers: Vec::new(),
            spirv_cross_compatibility: false,
            fake_missing_bindings: false,
            bounds_check_policies: BoundsCheckPolicies {
                index: BoundsCheckPolicy::Restrict,
                buffer: BoundsCheckPolicy::Restrict,
                image_load: BoundsCheckPolicy::Restrict,
                binding_array: BoundsCheckPolicy::Unchecked,
            },
            zero_initialize_workgroup_memory: true,
            force_loop_bounding: true,
            task_dispatch_limits: Some(LIMITS),
            mesh_shader_primitive_indices_clamp: true,
            emit_int_div_checks: true,
            ray_query_initialization_tracking: true,
        };
        let pipeline = msl::PipelineOptions {
            entry_point: Some((ShaderStage::Compute, self.entry_point.to_owned())),
            allow_and_force_point_size: false,
            vertex_pulling_transform: true,
            vertex_buffer_mappings: Vec::new(),
            binding_array_length_map: Default::default(),
        };
        let (text, names) = msl::write_string(self.module, self.info, &options, &pipeline)
            .map_err(|error| error.to_string())?;
        names
            .entry_point_names
            .into_iter()
            .next()
            .ok_or("no entry point")?
            .map_err(|e| e.to_string())?;
        Ok(text)
    }

    /// Translates the kernel to HLSL, as wgpu does on Direct3D 12. Returns the text and the name of the entry point.
    pub(crate) fn hlsl(&self, shader_model: hlsl::ShaderModel) -> Result<(String, String), String> {
        let registers = self.numbered(|access| match access {
            Access::Uniform => 'b',
            Access::Read => 't',
            Access::ReadWrite => 'u',
        });
        let uniforms = registers.iter().filter(|(_, access, _)| *access == Access::Uniform).count();
        let target = |(at, access, register)| {
            // wgpu restricts indices into uniforms at dynamic offsets. Here every uniform counts as such.
            let restrict_indexing = access == Access::Uniform;
            (at, hlsl::BindTarget { register, restrict_indexing, ..Default::default() })
        };
        let options = hlsl::Options {
            shader_model,
            binding_map: registers.into_iter().map(target).collect(),
            fake_missing_bindings: false,
            special_constants_binding: Some(hlsl::BindTarget {
                register: uniforms as u32,
                ..Default::default()
            }),
            zero_initialize_workgroup_memory: true,
            restrict_indexing: true,
            force_loop_bounding: true,
            task_dispatch_limits: Some(LIMITS),
            mesh_shader_primitive_indices_clamp: true,
            ray_query_initialization_tracking: true,
            // Kernels have neither samplers nor textures nor storage buffers at dynamic offsets.
            ..hlsl::Options::default()
        };
        let pipeline = hlsl::PipelineOptions {
            entry_point: Some((ShaderStage::Compute, self.entry_point.to_owned())),
        };
        let mut text = String::new();
        let names = hlsl::Writer::new(&mut text, &options, &pipeline)
            .write(self.module, self.info, None)
            .map_err(|error| error.to_string())?;
        let name = names.entry_point_names.into_iter().next().ok_or("no entry point")?;
        Ok((text, name.map_err(|error| error.to_string())?))
    }
}
