//! Independent tasks, done by one thread or by a pool.

use std::sync::{Mutex, PoisonError};

use crate::error::Result;
use crate::pool::Pool;

/// Does every task once, on the calling thread or on all threads of the pool, each with a worker of its own. There must be as
/// many workers as threads. Which thread does which task is left open, so tasks must not share what they write.
pub(super) fn share<W: Send, I: Iterator + Send>(
    pool: Option<&Pool>,
    workers: &mut [W],
    tasks: I,
    work: impl Fn(&mut W, I::Item) -> Result<()> + Sync,
) -> Result<()>
where
    I::Item: Send,
{
    let Some(pool) = pool else {
        return tasks.into_iter().try_for_each(|task| work(&mut workers[0], task));
    };
    let tasks = Mutex::new(tasks);
    let next = || tasks.lock().unwrap_or_else(PoisonError::into_inner).next();
    let workers: Vec<Mutex<&mut W>> = workers.iter_mut().map(Mutex::new).collect();
    let results = pool.broadcast(|index| {
        let mut worker = workers[index].lock().unwrap_or_else(PoisonError::into_inner);
        while let Some(task) = next() {
            work(&mut worker, task)?;
        }
        Ok(())
    });
    results.into_iter().collect()
}
