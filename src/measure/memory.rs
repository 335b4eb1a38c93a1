//! The most memory that this process has held at once, as the system counts it.

/// Peak resident memory in bytes: `VmHWM` of `/proc/self/status` on Linux, `None` elsewhere. It never falls, so that it tells
/// of everything from loading to the last frame.
pub fn peak_memory_bytes() -> Option<u64> {
    peak_of(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// The figure in the text of a status file: `VmHWM:      1234 kB`.
fn peak_of(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim_end().parse().ok()?;
    kib.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_is_found_and_nothing_else_is_taken_for_it() {
        assert_eq!(
            peak_of("Name:\thomcull\nVmPeak:\t  9999 kB\nVmHWM:\t  1234 kB\nVmRSS:\t 7 kB\n"),
            Some(1234 * 1024)
        );
        for status in ["", "VmRSS:\t 7 kB\n", "VmHWM:\t1234\n", "VmHWM:\t-1 kB\n", "VmHWM:\t99999999999999999999 kB\n"]
        {
            assert_eq!(peak_of(status), None, "{status:?}");
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_peak_is_at_least_what_is_held() {
        let held = vec![1u8; 8 << 20];
        assert!(peak_memory_bytes().is_some_and(|peak| peak >= std::hint::black_box(&held).len() as u64));
    }
}
