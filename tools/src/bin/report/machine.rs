//! When and on what machine the page's figures were measured.

use std::time::SystemTime;

use demo::options::Isa;

/// The processor as the system names it, the number of processors, and the instruction sets.
pub fn machine() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|l| l.strip_prefix("model name")).and_then(|l| l.split_once(':'));
    let model = model.map_or("processor unknown", |(_, name)| name.trim());
    let count = std::thread::available_parallelism().map_or(1, |n| n.get());
    let isas: Vec<String> = Isa::available().into_iter().map(Isa::name).collect();
    let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
    format!("{model}, {count} processors, {os} on {arch}; {}", isas.join(", "))
}

/// The date, as in 2026-11-23 (UTC).
pub fn day() -> String {
    let mut time = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
    time.truncate("2026-11-23".len());
    time
}
