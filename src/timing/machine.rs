//! The machine that the program runs on, as far as the system tells.

use super::recorded::Machine;
use std::fs;

/// The compiler that built the program.
pub const COMPILER: &str = env!("SIGNORINI_RUSTC");

/// The value of `key` in one of the system's files of `key: value` or `key=value` lines.
pub fn field(file: &str, key: &str) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    let (_, value) = line.split_once([':', '='])?;
    Some(value.trim().trim_matches('"').to_owned())
}

/// What a fact is called that the system does not tell.
pub fn unknown() -> String {
    "unknown".into()
}

/// Model of the processor, as it calls itself.
pub fn processor() -> String {
    field("/proc/cpuinfo", "model name").unwrap_or_else(unknown)
}

/// Release of the kernel; empty if it is not told.
pub fn kernel() -> String {
    let release = fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    release.trim().to_owned()
}

/// Cores that this program may use.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Bytes that this program may still allocate, as far as the system tells: what is free on the machine, in
/// its control group, and below the limit of the process (`ulimit -v`).
pub fn available_memory() -> Option<u64> {
    memory_left(|file| fs::read_to_string(file).ok())
}

/// The same, from the system's files.
fn memory_left(read: impl Fn(&str) -> Option<String>) -> Option<u64> {
    // The first number of the line that begins so.
    let number = |file: &str, key: &str| -> Option<u64> {
        let text = read(file)?;
        let mut lines = text.lines().filter_map(|line| line.strip_prefix(key));
        lines.next()?.split_whitespace().find_map(|word| word.parse().ok())
    };
    let free = number("/proc/meminfo", "MemAvailable:").map(|kilobytes| 1024 * kilobytes);
    // Of what the group has, the system drops files that it caches before it runs out of memory.
    let taken = number("/sys/fs/cgroup/memory.stat", "anon ").unwrap_or(0);
    let in_group = number("/sys/fs/cgroup/memory.max", "").map(|most| most.saturating_sub(taken));
    let used = number("/proc/self/status", "VmSize:").unwrap_or(0);
    let space = number("/proc/self/limits", "Max address space");
    let below_limit = space.map(|space| space.saturating_sub(1024 * used));
    [free, in_group, below_limit].into_iter().flatten().min()
}

/// Largest load average of a machine that measures undisturbed: half of one core.
const IDLE: f64 = 0.5;

impl Machine {
    /// Warning that other programs take time from those that are measured, if the load average says so.
    pub(crate) fn busy(&self) -> Option<String> {
        (self.load > IDLE).then(|| {
            format!(
                "warning: the machine is busy (load average {}), so that times are longer than on an idle one; repeat the command when nothing else runs",
                self.load
            )
        })
    }

    /// Asks the system; what it does not tell is called unknown.
    pub(crate) fn here(repeats: usize) -> Self {
        let load = fs::read_to_string("/proc/loadavg").ok();
        let load = load.and_then(|text| text.split(' ').next()?.parse().ok());
        Self {
            cpu: processor(),
            cores: cores(),
            caches: caches().unwrap_or_else(unknown),
            os: format!("{} {} {}", std::env::consts::OS, kernel(), std::env::consts::ARCH),
            rustc: COMPILER.into(),
            load: load.unwrap_or(0.0),
            repeats,
        }
    }
}

/// `L1d 48K, L2 2048K, L3 ...`, as the first core sees them.
fn caches() -> Option<String> {
    let mut found = Vec::new();
    for index in 0..8 {
        let read = |what: &str| {
            let path = format!("/sys/devices/system/cpu/cpu0/cache/index{index}/{what}");
            fs::read_to_string(path).map(|text| text.trim().to_owned()).ok()
        };
        let (Some(level), Some(kind), Some(size)) = (read("level"), read("type"), read("size"))
        else {
            break;
        };
        match kind.as_str() {
            "Instruction" => {}
            "Data" => found.push(format!("L{level}d {size}")),
            _ => found.push(format!("L{level} {size}")),
        }
    }
    (!found.is_empty()).then(|| found.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_busy_machine_is_said_to_be_busy() {
        let here = Machine::here(1);
        let busy = |load| Machine { load, ..here.clone() }.busy();
        assert_eq!(busy(0.2), None);
        assert!(busy(4.58).unwrap().contains("load average 4.58"));
    }

    /// Memory left on a machine with 8000 KiB free, whose other files are these.
    fn left(files: &[(&str, &str)]) -> Option<u64> {
        let meminfo =
            "MemTotal:       16000 kB\nMemFree:         1000 kB\nMemAvailable:    8000 kB\n";
        let files = [&[("/proc/meminfo", meminfo)], files].concat();
        memory_left(|file| {
            files.iter().find(|(name, _)| *name == file).map(|(_, text)| (*text).to_owned())
        })
    }

    #[test]
    fn memory_left_is_the_least_of_machine_group_and_limit() {
        let free = Some(8000 * 1024);
        assert_eq!(left(&[]), free);
        // Files that the group has cached do not count as taken.
        let stat = ("/sys/fs/cgroup/memory.stat", "anon 1000000\nfile 900000\nanon_thp 7\n");
        let max = "/sys/fs/cgroup/memory.max";
        assert_eq!(left(&[(max, "5000000\n"), stat]), Some(4_000_000));
        assert_eq!(left(&[(max, "5000000\n")]), Some(5_000_000));
        assert_eq!(left(&[(max, "900000\n"), stat]), Some(0));
        assert_eq!(left(&[(max, "max\n"), stat]), free);
        assert_eq!(left(&[(max, "900000000\n"), stat]), free);
        let status =
            ("/proc/self/status", "Name:\tsignorini\nVmPeak:\t9999 kB\nVmSize:\t1000 kB\n");
        let limits = |space| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units     \n\
                 Max stack size            8388608              unlimited            bytes     \n\
                 Max address space         {space}              unlimited            bytes     \n"
            )
        };
        assert_eq!(left(&[("/proc/self/limits", &limits("3024000")), status]), Some(2_000_000));
        assert_eq!(left(&[("/proc/self/limits", &limits("1000")), status]), Some(0));
        assert_eq!(left(&[("/proc/self/limits", &limits("unlimited")), status]), free);
        assert_eq!(memory_left(|_| None), None);
    }
}
