//! How much memory a run may take.

use std::fmt;
use std::str::FromStr;
use std::sync::OnceLock;

use bytesize::ByteSize;

/// Bytes that transforms and sums may take, beside points and results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Memory(pub u64);

/// What is taken for a machine that does not say what it has: a browser.
const UNKNOWN: u64 = 2 << 30;

impl Memory {
    /// Half of what the machine has, or of what this process may have of it (`ulimit`, a container, a job of a cluster). Read once.
    pub fn of_machine() -> Self {
        static HALF: OnceLock<u64> = OnceLock::new();
        Self(*HALF.get_or_init(|| {
            let Ok(mut system) = sysinfo::System::new() else { return UNKNOWN };
            system.refresh_memory();
            let limit = system.cgroup_limits().map(|limits| limits.total_memory).filter(|&bytes| bytes > 0);
            let all = limit.unwrap_or(u64::MAX).min(system.total_memory()).min(allowed());
            if all == 0 { UNKNOWN } else { all / 2 }
        }))
    }
}

/// What this process may address: `ulimit -v`.
fn allowed() -> u64 {
    #[cfg(unix)]
    let limit = rustix::process::getrlimit(rustix::process::Resource::As).current;
    #[cfg(not(unix))]
    let limit = None;
    limit.unwrap_or(u64::MAX)
}

impl fmt::Display for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let units = [("GiB", 1 << 30), ("MiB", 1 << 20), ("KiB", 1 << 10)];
        match units.into_iter().find(|(_, unit)| self.0 > 0 && self.0.is_multiple_of(*unit)) {
            Some((name, unit)) => write!(f, "{}{name}", self.0 / unit),
            None => write!(f, "{}B", self.0),
        }
    }
}

impl FromStr for Memory {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bytes: ByteSize = text.parse().map_err(|_| EXPECTED.to_string())?;
        if bytes.0 < 1 << 20 { Err(EXPECTED.into()) } else { Ok(Self(bytes.0)) }
    }
}

const EXPECTED: &str = "expected bytes, at least 1 MiB, such as 500MB or 4GiB";

#[cfg(test)]
mod tests {
    use super::Memory;

    #[test]
    fn what_is_printed_reads_back() {
        for (text, bytes) in [("4GiB", 4 << 30), ("500MB", 500_000_000), ("1048577", 1_048_577), ("1.5 GiB", 3 << 29)] {
            let memory: Memory = text.parse().unwrap();
            assert_eq!(memory, Memory(bytes), "{text}");
            assert_eq!(memory.to_string().parse(), Ok(memory), "{text}");
        }
        for text in ["", "4 parsecs", "-1GiB", "12", "NaN", "1e400GB"] {
            assert!(text.parse::<Memory>().is_err(), "{text}");
        }
        assert!(Memory::of_machine() > Memory(1 << 24));
    }
}
