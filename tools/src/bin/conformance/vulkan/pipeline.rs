//! The pipeline: positions are passed through, no culling, no depth, exclusive-or into an integer target.

use std::error::Error;

use ash::{Device, vk};
use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Four unsigned words per pixel; every device supports it as a render target.
pub const FORMAT: vk::Format = vk::Format::R32G32B32A32_UINT;

pub struct Pipeline {
    device: Device,
    pub pass: vk::RenderPass,
    layout: vk::PipelineLayout,
    pub pipeline: vk::Pipeline,
}

impl Pipeline {
    pub fn new(device: &Device) -> Result<Self, Box<dyn Error>> {
        let code = spirv()?;
        // SAFETY: the device is alive, the structures outlive the calls, and the shader was validated.
        unsafe {
            let pass = render_pass(device)?;
            let layout = device.create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default(), None)?;
            let module = device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&code), None)?;
            let pipeline = pipeline(device, pass, layout, module);
            device.destroy_shader_module(module, None);
            Ok(Self { device: device.clone(), pass, layout, pipeline: pipeline? })
        }
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        // SAFETY: the device outlives the pipeline, and no commands that use it are executing.
        unsafe {
            self.device.destroy_pipeline(self.pipeline, None);
            self.device.destroy_pipeline_layout(self.layout, None);
            self.device.destroy_render_pass(self.pass, None);
        }
    }
}

fn spirv() -> Result<Vec<u32>, Box<dyn Error>> {
    let source = include_str!("shader.wgsl");
    let module = naga::front::wgsl::parse_str(source).map_err(|why| why.emit_to_string(source))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module)?;
    // Without naga's default flags, one of which flips y.
    let options = spv::Options { flags: spv::WriterFlags::empty(), ..spv::Options::default() };
    Ok(spv::write_vec(&module, &info, &options, None)?)
}

/// Clears the target, and leaves it in a layout to be copied from.
///
/// # Safety
/// The device is alive.
unsafe fn render_pass(device: &Device) -> Result<vk::RenderPass, vk::Result> {
    let attachments = [vk::AttachmentDescription::default()
        .format(FORMAT)
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(vk::AttachmentStoreOp::STORE)
        .initial_layout(vk::ImageLayout::UNDEFINED)
        .final_layout(vk::ImageLayout::TRANSFER_SRC_OPTIMAL)];
    let colours = [vk::AttachmentReference::default().attachment(0).layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)];
    let subpasses = [vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .color_attachments(&colours)];
    let dependencies = [vk::SubpassDependency::default()
        .src_subpass(0)
        .dst_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT)
        .src_access_mask(vk::AccessFlags::COLOR_ATTACHMENT_WRITE)
        .dst_stage_mask(vk::PipelineStageFlags::TRANSFER)
        .dst_access_mask(vk::AccessFlags::TRANSFER_READ)];
    let info =
        vk::RenderPassCreateInfo::default().attachments(&attachments).subpasses(&subpasses).dependencies(&dependencies);
    // SAFETY: the structures outlive the call.
    unsafe { device.create_render_pass(&info, None) }
}

/// # Safety
/// All handles are of this device, and the module has both entry points.
unsafe fn pipeline(
    device: &Device,
    pass: vk::RenderPass,
    layout: vk::PipelineLayout,
    module: vk::ShaderModule,
) -> Result<vk::Pipeline, vk::Result> {
    let stage = |stage, name| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(name);
    let stages = [stage(vk::ShaderStageFlags::VERTEX, c"corner"), stage(vk::ShaderStageFlags::FRAGMENT, c"pixel")];
    let bindings = [vk::VertexInputBindingDescription::default().stride(16)];
    let attributes = [vk::VertexInputAttributeDescription::default().format(vk::Format::R32G32B32A32_SFLOAT)];
    let input = vk::PipelineVertexInputStateCreateInfo::default()
        .vertex_binding_descriptions(&bindings)
        .vertex_attribute_descriptions(&attributes);
    let assembly = vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
    let raster = vk::PipelineRasterizationStateCreateInfo::default()
        .polygon_mode(vk::PolygonMode::FILL)
        .cull_mode(vk::CullModeFlags::NONE)
        .line_width(1.0);
    let samples = vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
    let targets = [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
    let blend = vk::PipelineColorBlendStateCreateInfo::default()
        .logic_op_enable(true)
        .logic_op(vk::LogicOp::XOR)
        .attachments(&targets);
    let dynamic = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic);
    let info = vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&raster)
        .multisample_state(&samples)
        .color_blend_state(&blend)
        .dynamic_state(&dynamic)
        .layout(layout)
        .render_pass(pass);
    // SAFETY: the structures outlive the call; the handles are valid by the caller's contract.
    unsafe { device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) }
        .map(|made| made[0])
        .map_err(|(_, why)| why)
}
