//! Facts on the machine that runs the program, from the system.

use super::recorded::Machine;
use std::fs;

/// Compiler that built the program.
pub const COMPILER: &str = env!("SIGNORINI_RUSTC");

/// Returns the value of `key` in a file of the system with `key: value` or `key=value` lines.
pub fn field(file: &str, key: &str) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    let (_, value) = line.split_once([':', '='])?;
    Some(value.trim().trim_matches('"').to_owned())
}

/// Returns the word for a fact that the system does not tell.
pub fn unknown() -> String {
    "unknown".into()
}

/// Returns the model of the processor, as it calls itself.
pub fn processor() -> String {
    field("/proc/cpuinfo", "model name").unwrap_or_else(unknown)
}

/// Returns the release of the kernel; empty if the system does not tell it.
pub fn kernel() -> String {
    let release = fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    release.trim().to_owned()
}

/// Number of cores that this program may use.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Number of bytes that this program may still allocate: the least of those free on the machine, in its control group,
/// and below the limit of the process (`ulimit -v`); `None` if the system tells none of them.
pub fn available_memory() -> Option<u64> {
    memory_left(|file| fs::read_to_string(file).ok())
}

/// Returns the [`available_memory`] according to the system's files, which `read` reads.
fn memory_left(read: impl Fn(&str) -> Option<String>) -> Option<u64> {
    let free =
        number_after("MemAvailable:", read("/proc/meminfo")).map(|kilobytes| 1024 * kilobytes);
    // Files that the system caches count as free: the system drops them before it runs out of memory.
    let taken = number_after("anon ", read("/sys/fs/cgroup/memory.stat")).unwrap_or(0);
    let limit = number_after("", read("/sys/fs/cgroup/memory.max"));
    let in_group = limit.map(|limit| limit.saturating_sub(taken));
    let used = 1024 * number_after("VmSize:", read("/proc/self/status")).unwrap_or(0);
    let limit = number_after("Max address space", read("/proc/self/limits"));
    let below_limit = limit.map(|limit| limit.saturating_sub(used));
    [free, in_group, below_limit].into_iter().flatten().min()
}

/// Returns the first number in the first line that begins with `key`.
fn number_after(key: &str, text: Option<String>) -> Option<u64> {
    let text = text?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().find_map(|word| word.parse().ok())
}

/// Largest load average of an idle machine: half of one core.
const IDLE: f64 = 0.5;

impl Machine {
    /// Returns a warning if the load average shows that other programs run.
    pub(crate) fn busy(&self) -> Option<String> {
        (self.load > IDLE).then(|| {
            format!(
                "warning: the machine is busy (load average {}), so that times are longer than on an idle one; \
                 repeat the command when nothing else runs",
                self.load
            )
        })
    }

    /// Returns the facts that the system tells, and `unknown` for others.
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

/// Returns the caches of the first core, such as `L1d 48K, L2 2048K`.
fn caches() -> Option<String> {
    let mut found = Vec::new();
    for index in 0..8 {
        let [level, kind, size] = ["level", "type", "size"].map(|fact| {
            let path = format!("/sys/devices/system/cpu/cpu0/cache/index{index}/{fact}");
            Some(fs::read_to_string(path).ok()?.trim().to_owned())
        });
        let (Some(level), Some(kind), Some(size)) = (level, kind, size) else { break };
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
        let mut here = Machine::here(1);
        here.load = 0.2;
        assert_eq!(here.busy(), None);
        here.load = 4.58;
        assert!(here.busy().unwrap().contains("load average 4.58"));
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
        assert_eq!(left(&[("/proc/self/limits", &limits("3024000")), status]), Some(2_000_000));
        assert_eq!(left(&[("/proc/self/limits", &limits("1000")), status]), Some(0));
        assert_eq!(left(&[("/proc/self/limits", &limits("unlimited")), status]), free);
        assert_eq!(memory_left(|_| None), None);
    }

    /// Limits of a process with this address space, as Linux writes them.
    fn limits(space: &str) -> String {
        format!(
            "Limit                     Soft Limit           Hard Limit           Units     \n\
             Max stack size            8388608              unlimited            bytes     \n\
             Max address space         {space}              unlimited            bytes     \n"
        )
    }
}
