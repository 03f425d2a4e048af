//! Buffers and images, each with its own memory.

use std::error::Error;
use std::rc::Rc;

use ash::vk;

use super::device::Gpu;

/// A buffer that stays mapped.
pub struct Buffer {
    gpu: Rc<Gpu>,
    pub buffer: vk::Buffer,
    memory: vk::DeviceMemory,
    mapped: *mut u8,
    size: usize,
}

impl Buffer {
    pub fn new(gpu: &Rc<Gpu>, size: usize, usage: vk::BufferUsageFlags) -> Result<Self, Box<dyn Error>> {
        use vk::MemoryPropertyFlags as Memory;
        let seen = Memory::HOST_VISIBLE | Memory::HOST_COHERENT;
        let info = vk::BufferCreateInfo::default().size(size as u64).usage(usage);
        // SAFETY: the device is alive, and the buffer is bound to its memory before anything uses it.
        unsafe {
            let device = &gpu.device;
            let buffer = device.create_buffer(&info, None)?;
            let needs = device.get_buffer_memory_requirements(buffer);
            let kind = gpu.memory_type(needs.memory_type_bits, &[seen | Memory::HOST_CACHED, seen])?;
            let wanted = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(kind);
            let memory = device.allocate_memory(&wanted, None)?;
            device.bind_buffer_memory(buffer, memory, 0)?;
            let mapped = device.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())?.cast();
            Ok(Self { gpu: Rc::clone(gpu), buffer, memory, mapped, size })
        }
    }

    /// Its contents.
    ///
    /// # Safety
    /// The device is not writing to it, and will not as long as the slice lives.
    pub unsafe fn bytes(&self) -> &[u8] {
        // SAFETY: this many bytes are mapped, and stay mapped until the buffer is dropped.
        unsafe { std::slice::from_raw_parts(self.mapped, self.size) }
    }

    /// Copies to its beginning.
    ///
    /// # Safety
    /// The device is not reading it.
    pub unsafe fn write(&mut self, bytes: &[u8]) {
        assert!(bytes.len() <= self.size);
        // SAFETY: it is mapped and large enough.
        unsafe { self.mapped.copy_from_nonoverlapping(bytes.as_ptr(), bytes.len()) };
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: the owner has waited for the device before dropping it.
        unsafe {
            self.gpu.device.destroy_buffer(self.buffer, None);
            self.gpu.device.free_memory(self.memory, None);
        }
    }
}

/// An image to draw into, and its view.
pub struct Image {
    gpu: Rc<Gpu>,
    pub image: vk::Image,
    pub view: vk::ImageView,
    memory: vk::DeviceMemory,
}

impl Image {
    pub fn new(gpu: &Rc<Gpu>, format: vk::Format, extent: vk::Extent2D) -> Result<Self, Box<dyn Error>> {
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(extent.into())
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC);
        // SAFETY: the device is alive, and the image is bound to its memory before anything uses it.
        unsafe {
            let device = &gpu.device;
            let image = device.create_image(&info, None)?;
            let needs = device.get_image_memory_requirements(image);
            let any = [vk::MemoryPropertyFlags::DEVICE_LOCAL, vk::MemoryPropertyFlags::empty()];
            let kind = gpu.memory_type(needs.memory_type_bits, &any)?;
            let wanted = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(kind);
            let memory = device.allocate_memory(&wanted, None)?;
            device.bind_image_memory(image, memory, 0)?;
            let info = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(format)
                .subresource_range(vk::ImageSubresourceRange {
                    aspect_mask: vk::ImageAspectFlags::COLOR,
                    base_mip_level: 0,
                    level_count: 1,
                    base_array_layer: 0,
                    layer_count: 1,
                });
            let view = device.create_image_view(&info, None)?;
            Ok(Self { gpu: Rc::clone(gpu), image, view, memory })
        }
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        // SAFETY: the owner has waited for the device before dropping it.
        unsafe {
            self.gpu.device.destroy_image_view(self.view, None);
            self.gpu.device.destroy_image(self.image, None);
            self.gpu.device.free_memory(self.memory, None);
        }
    }
}
