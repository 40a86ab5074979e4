//! The machine on which times are measured: its description, its threads, and the memory of this process.

use std::env::consts::{ARCH, OS};
use std::fs;
use std::thread;

/// Returns processor, cores, memory, system and compiler in one line, without unknown parts.
pub fn machine_description() -> String {
    let processor = line_of("/proc/cpuinfo", "model name").unwrap_or_else(|| format!("{ARCH} processor"));
    let cores = available_threads();
    let memory = line_of("/proc/meminfo", "MemTotal").and_then(|text| kibibytes(&text));
    let system = line_of("/etc/os-release", "PRETTY_NAME").map(|name| name.trim_matches('"').to_owned());
    let mut parts = vec![processor, format!("{cores} cores")];
    parts.extend(memory.map(|bytes| format!("{:.0} GiB", bytes as f64 / (1_u64 << 30) as f64)));
    parts.push(system.map_or_else(|| format!("{OS} {ARCH}"), |name| format!("{name} ({OS} {ARCH})")));
    let compiler = env!("SSCC_RUSTC");
    parts.extend((!compiler.is_empty()).then(|| compiler.to_owned()));
    parts.push(format!("sscc {}", env!("CARGO_PKG_VERSION")));
    parts.join(", ")
}

/// Returns the number of threads that this process can run at once; 1 if the system does not report it.
pub fn available_threads() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Peak memory of this process since [`PeakMemory::start`] (Linux).
pub struct PeakMemory(());

impl PeakMemory {
    /// Starts the measurement. None if the system cannot reset its peak.
    pub fn start() -> Option<Self> {
        // Resets the peak of the kernel (proc(5), clear_refs).
        fs::write("/proc/self/clear_refs", "5").ok().map(|()| Self(()))
    }

    /// Returns the peak memory (bytes) since [`PeakMemory::start`]; None if the system does not report it.
    pub fn bytes(self) -> Option<u64> {
        line_of("/proc/self/status", "VmHWM").and_then(|text| kibibytes(&text))
    }
}

/// Returns the value of the first line that begins with a name.
fn line_of(file: &str, name: &str) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(rest.trim_start().trim_start_matches([':', '=']).trim().to_owned())
}

/// Returns the bytes of a text like `16314272 kB`.
fn kibibytes(text: &str) -> Option<u64> {
    Some(text.strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn the_peak_memory_is_that_since_the_start() {
        let before = PeakMemory::start().unwrap().bytes().unwrap();
        let size = 200 << 20;
        let peak = PeakMemory::start().unwrap();
        let block = std::hint::black_box(vec![1_u8; size]);
        assert!(peak.bytes().unwrap() >= before / 2 + block.len() as u64);
    }

    #[test]
    fn kibibytes_are_read_as_bytes() {
        assert_eq!(kibibytes("2 kB"), Some(2048));
        assert_eq!(kibibytes("many"), None);
    }
}
