//! How long something takes, and what the machine could do in that time.

use std::hint::black_box;

use crate::compute::cpu::{SimdLevel, fma_gflop};
use crate::control::{Control, Instant};
use crate::error::Result;
use crate::pool::Pool;

/// Seconds on the wall that one of something takes, over several runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Their median.
    pub median: f64,
    /// The fastest run.
    pub least: f64,
    /// The slowest.
    pub most: f64,
    /// How many there were.
    pub runs: usize,
}

impl Timing {
    /// Of a number of runs, at least one.
    pub(super) fn of(mut seconds: Vec<f64>) -> Self {
        seconds.sort_by(f64::total_cmp);
        let at = |k: usize| seconds.get(k).copied().unwrap_or(f64::NAN);
        let (n, middle) = (seconds.len(), seconds.len() / 2);
        let median = if n.is_multiple_of(2) && n > 0 { 0.5 * (at(middle - 1) + at(middle)) } else { at(middle) };
        Self { median, least: at(0), most: at(n.saturating_sub(1)), runs: n }
    }

    /// That of one of `parts` equal parts.
    pub(super) fn each(self, parts: f64) -> Self {
        Self { median: self.median / parts, least: self.least / parts, most: self.most / parts, ..self }
    }
}

/// How thoroughly things are timed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Care {
    /// Runs that count.
    pub(super) runs: usize,
    /// Seconds of a run, at least: what is quicker is done several times.
    pub(super) least: f64,
    /// Seconds after which nothing is run again.
    pub(super) enough: f64,
}

impl Care {
    /// How long `work` takes, and what it makes. It is done once before, so that memory and caches are there.
    pub(super) fn time<T>(self, control: &Control, mut work: impl FnMut() -> Result<T>) -> Result<(Timing, T)> {
        let once = |work: &mut dyn FnMut() -> Result<T>| -> Result<(f64, T)> {
            control.check()?;
            let start = Instant::now();
            let made = work()?;
            Ok((start.elapsed().as_secs_f64(), made))
        };
        let (first, mut made) = once(&mut work)?;
        if first > self.enough {
            return Ok((Timing::of(vec![first]), made));
        }
        let times = (self.least / first.max(1e-9)).ceil().clamp(1.0, 1e6) as usize;
        let (mut seconds, mut spent) = (Vec::new(), first);
        while seconds.len() < self.runs && (spent < self.enough || seconds.is_empty()) {
            let mut run = 0.0;
            for _ in 0..times {
                let (took, again) = once(&mut work)?;
                run += took;
                made = again;
            }
            spent += run;
            seconds.push(run / times as f64);
        }
        Ok((Timing::of(seconds), made))
    }
}

/// What the machine can do.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// The device of the CPU path, in words.
    pub cpu: String,
    /// What the processor says it is; empty where it does not.
    pub processor: String,
    /// Threads.
    pub threads: usize,
    /// f32 multiply-adds of all threads, in 1e9 operations per second (two for each multiply-add).
    pub gflops: f64,
    /// Bytes that all threads read and write, per second, in 1e9: `a[i] = b[i] + s c[i]` over arrays of 32 MB
    /// (the triad of McCalpin's STREAM).
    pub gigabytes: f64,
}

/// Values of an array of the triad.
const TRIAD: usize = 1 << 22;

impl Machine {
    /// Measures it, in well below a second.
    pub(super) fn measure(cpu: String, pool: &Pool, care: Care, control: &Control) -> Result<Self> {
        let level = SimdLevel::detect();
        let rounds = 2_000_000;
        let threads = pool.threads();
        // The fastest: what is in the way of a limit is no limit.
        let (timing, each) = care.time(control, || Ok(pool.broadcast(|_| fma_gflop(level, black_box(rounds)))))?;
        let gflop: f64 = black_box(&each).iter().map(|(gflop, _)| gflop).sum();
        let arrays = |value: f64| (0..threads).map(|_| vec![value; TRIAD / threads]).collect::<Vec<_>>();
        let (b, c) = (arrays(1.0), arrays(2.0));
        let a: Vec<_> = arrays(0.0).into_iter().map(std::sync::Mutex::new).collect();
        let (triad, ()) = care.time(control, || {
            pool.broadcast(|thread| {
                let mut a = a[thread].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                for ((a, b), c) in a.iter_mut().zip(&b[thread]).zip(&c[thread]) {
                    *a = b + 3.0 * c;
                }
                black_box(&*a);
            });
            Ok(())
        })?;
        let bytes = (TRIAD / threads * threads * 24) as f64;
        let processor = sysinfo::System::new().ok().and_then(|mut system| {
            system.refresh_cpu_list(sysinfo::CpuRefreshKind::nothing());
            Some(system.cpus().first()?.brand().trim().to_string())
        });
        Ok(Self {
            cpu,
            processor: processor.unwrap_or_default(),
            threads,
            gflops: gflop / timing.least,
            gigabytes: 1e-9 * bytes / triad.least,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_told_by_their_median() {
        let odd = Timing::of(vec![3.0, 1.0, 2.0]);
        assert_eq!(odd, Timing { median: 2.0, least: 1.0, most: 3.0, runs: 3 });
        assert_eq!(Timing::of(vec![4.0, 1.0, 2.0, 3.0]).median, 2.5);
        assert_eq!(odd.each(2.0), Timing { median: 1.0, least: 0.5, most: 1.5, runs: 3 });
    }

    #[test]
    fn what_takes_long_is_done_once() {
        let mut calls = 0;
        let care = Care { runs: 5, least: 0.0, enough: 0.0 };
        let mut slow = || {
            calls += 1;
            std::thread::sleep(std::time::Duration::from_millis(1));
            Ok(calls)
        };
        let (timing, made) = care.time(&Control::default(), &mut slow).unwrap();
        assert!(timing.runs == 1 && timing.median >= 1e-3 && made == 1);
        let (timing, made) = Care { enough: 10.0, ..care }.time(&Control::default(), slow).unwrap();
        assert_eq!((timing.runs, made), (5, 7));
    }
}
