//! The instance, the requested physical device, and a queue on it.

use std::error::Error;
use std::ffi::CStr;

use ash::{Device, Entry, Instance, vk};

/// A device with one graphics queue.
pub struct Gpu {
    /// The loader's library, which must outlive everything created through it.
    _entry: Entry,
    instance: Instance,
    physical: vk::PhysicalDevice,
    pub device: Device,
    pub queue: vk::Queue,
    pub family: u32,
    pub name: String,
    pub limits: vk::PhysicalDeviceLimits,
}

impl Gpu {
    /// The device whose name contains `part`; without `part`, a graphics card in preference to software.
    pub fn open(part: Option<&str>) -> Result<Self, Box<dyn Error>> {
        // SAFETY: the Vulkan loader of the system is what its name says, and may be initialised.
        let entry = unsafe { Entry::load()? };
        let application =
            vk::ApplicationInfo::default().application_name(c"conformance").api_version(vk::API_VERSION_1_1);
        let info = vk::InstanceCreateInfo::default().application_info(&application);
        // SAFETY: the structures outlive the call.
        let instance = unsafe { entry.create_instance(&info, None)? };
        match choose(&instance, part) {
            // SAFETY: the queue family is one of this device.
            Ok((physical, family)) => unsafe { Self::new(entry, instance, physical, family) },
            Err(why) => {
                // SAFETY: nothing was created from it.
                unsafe { instance.destroy_instance(None) };
                Err(why)
            }
        }
    }

    /// # Safety
    /// The physical device is one of the instance, and the family one of the device.
    unsafe fn new(
        entry: Entry,
        instance: Instance,
        physical: vk::PhysicalDevice,
        family: u32,
    ) -> Result<Self, Box<dyn Error>> {
        let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
        let features = vk::PhysicalDeviceFeatures::default().logic_op(true);
        let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_features(&features);
        // SAFETY: the structures outlive the calls; `choose` checked for the feature.
        unsafe {
            let device = instance.create_device(physical, &info, None)?;
            let queue = device.get_device_queue(family, 0);
            let limits = instance.get_physical_device_properties(physical).limits;
            let name = describe(&instance, physical);
            Ok(Self { _entry: entry, instance, physical, device, queue, family, name, limits })
        }
    }

    /// A memory type that is among `allowed` and has the first of `wishes` that is available.
    pub fn memory_type(&self, allowed: u32, wishes: &[vk::MemoryPropertyFlags]) -> Result<u32, Box<dyn Error>> {
        // SAFETY: the physical device is one of this instance.
        let memory = unsafe { self.instance.get_physical_device_memory_properties(self.physical) };
        let types = &memory.memory_types[..memory.memory_type_count as usize];
        let fits = |wish: vk::MemoryPropertyFlags| {
            (0..types.len()).find(|&i| allowed >> i & 1 == 1 && types[i].property_flags.contains(wish))
        };
        let found = wishes.iter().find_map(|&wish| fits(wish)).ok_or("the device has no memory of the kind needed")?;
        Ok(found as u32)
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        // SAFETY: everything created from the device holds a reference to this structure, and is gone.
        unsafe {
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

fn text(name: &[std::ffi::c_char]) -> String {
    // SAFETY: ash's character arrays have the length in the specification, and are NUL-terminated.
    unsafe { CStr::from_ptr(name.as_ptr()) }.to_string_lossy().into_owned()
}

/// The device's name and its driver's, with their versions.
fn describe(instance: &Instance, physical: vk::PhysicalDevice) -> String {
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
    // SAFETY: the physical device is one of this instance. A device without driver properties leaves zeros.
    unsafe { instance.get_physical_device_properties2(physical, &mut all) };
    let version = all.properties.api_version;
    let name = text(&all.properties.device_name);
    let (major, minor) = (vk::api_version_major(version), vk::api_version_minor(version));
    format!("{name}, {} {}, Vulkan {major}.{minor}", text(&driver.driver_name), text(&driver.driver_info))
}

fn choose(instance: &Instance, part: Option<&str>) -> Result<(vk::PhysicalDevice, u32), Box<dyn Error>> {
    let mut seen = Vec::new();
    let mut found = Vec::new();
    // SAFETY: the physical devices are those of this instance.
    unsafe {
        for physical in instance.enumerate_physical_devices()? {
            let name = describe(instance, physical);
            let families = instance.get_physical_device_queue_family_properties(physical);
            let family = families.iter().position(|f| f.queue_flags.contains(vk::QueueFlags::GRAPHICS));
            let logic = instance.get_physical_device_features(physical).logic_op == vk::TRUE;
            let wanted = part.is_none_or(|part| name.to_lowercase().contains(&part.to_lowercase()));
            let rank = match instance.get_physical_device_properties(physical).device_type {
                vk::PhysicalDeviceType::DISCRETE_GPU => 0,
                vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
                vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
                _ => 3,
            };
            match family {
                Some(family) if logic && wanted => found.push((rank, physical, family as u32)),
                _ => {}
            }
            seen.push(if logic { name } else { format!("{name} (without logical operations)") });
        }
    }
    let best = found.into_iter().min_by_key(|f| f.0);
    best.map(|(_, physical, family)| (physical, family))
        .ok_or_else(|| format!("no matching Vulkan device; available: {seen:?}").into())
}
