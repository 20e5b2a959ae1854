//! Where parallel work runs.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::setting::Setting;

/// More threads than this are a typing error.
const MAX_THREADS: usize = 4096;

/// Whether that many threads can be asked for.
///
/// # Errors
/// 0, or more than anybody has.
pub fn check_threads(threads: usize) -> Result<()> {
    if (1..=MAX_THREADS).contains(&threads) {
        return Ok(());
    }
    Err(Error::setting(Setting::Threads, threads, format!("expected 1 to {MAX_THREADS}")))
}

/// Threads of its own, or the current one where a platform has no others (a browser). A clone shares the threads.
#[derive(Debug, Clone)]
pub struct Pool(Option<Arc<rayon::ThreadPool>>);

impl Pool {
    /// `threads` threads, or as many as the machine offers.
    ///
    /// # Errors
    /// A number of threads that cannot be, or that the platform does not start.
    pub fn new(threads: Option<usize>) -> Result<Self> {
        threads.map_or(Ok(()), check_threads)?;
        // 0 lets rayon ask the operating system.
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.unwrap_or(0))
            .thread_name(|k| format!("pairwave-{k}"))
            .build();
        match pool {
            Ok(pool) => Ok(Self(Some(Arc::new(pool)))),
            Err(error) if unsupported(&error) => Ok(Self(None)),
            Err(error) => {
                let reason = format!("cannot start them: {error}; expected fewer, or more memory for their stacks");
                match threads {
                    Some(threads) => Err(Error::setting(Setting::Threads, threads, reason)),
                    None => {
                        Err(Error::input("threads of this machine", format!("{reason} (`threads` sets the number)")))
                    }
                }
            }
        }
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.0.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// Whether the current thread is one of several that share the work.
    pub(crate) fn is_within(&self) -> bool {
        self.0.as_ref().is_some_and(|pool| pool.current_thread_index().is_some())
    }

    /// Does `work`, whose parallel parts are shared between these threads.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// Does `work` once on every thread, which is handed its index.
    pub(crate) fn broadcast<R: Send>(&self, work: impl Fn(usize) -> R + Sync) -> Vec<R> {
        match &self.0 {
            Some(pool) => pool.broadcast(|thread| work(thread.index())),
            None => vec![work(0)],
        }
    }
}

/// Whether there are no threads here at all.
fn unsupported(error: &rayon::ThreadPoolBuildError) -> bool {
    let cause = std::error::Error::source(error).and_then(|cause| cause.downcast_ref::<std::io::Error>());
    cause.is_some_and(|cause| cause.kind() == std::io::ErrorKind::Unsupported)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    #[test]
    fn work_runs_on_the_threads_it_was_given() {
        for threads in [1, 3] {
            let pool = Pool::new(Some(threads)).unwrap();
            assert_eq!(pool.threads(), threads);
            assert_eq!(pool.broadcast(|index| index), (0..threads).collect::<Vec<_>>());
            assert!(!pool.is_within());
            let name = || std::thread::current().name().unwrap_or_default().to_string();
            let names: Vec<String> = pool.install(|| (0..100).into_par_iter().map(|_| name()).collect());
            assert!(names.iter().all(|name| name.starts_with("pairwave-")));
        }
        assert!(Pool::new(Some(0)).is_err() && Pool::new(Some(MAX_THREADS + 1)).is_err());
    }

    #[test]
    fn without_threads_the_current_one_works() {
        let pool = Pool(None);
        let here = std::thread::current().id();
        assert_eq!(pool.install(|| std::thread::current().id()), here);
        assert_eq!(pool.broadcast(|index| (index, std::thread::current().id())), [(0, here)]);
        assert_eq!((pool.threads(), pool.is_within()), (1, false));
    }
}
