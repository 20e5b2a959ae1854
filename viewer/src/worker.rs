//! The engine on a thread of its own. The window never waits for it: it leaves what it wants, and picks up what there is.

use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use pairwave::control::Control;
use pairwave::request::Request;

use crate::engine::{Engine, SetId, Snapshot};

/// A handle to the thread; dropping it ends the thread within a step.
pub struct Worker {
    shared: Arc<Shared>,
    #[cfg(not(target_arch = "wasm32"))]
    thread: Option<std::thread::JoinHandle<()>>,
    /// In a browser there is no thread: a step is taken whenever the window asks.
    #[cfg(target_arch = "wasm32")]
    engine: Engine,
}

struct Shared {
    desk: Mutex<Desk>,
    wake: Condvar,
    notify: Box<dyn Fn() + Send + Sync>,
}

/// What lies between the window and the engine: the latest wish and the latest result of each set, never a queue of them.
#[derive(Default)]
struct Desk {
    /// `None`: to be forgotten.
    wishes: BTreeMap<SetId, Option<Request>>,
    /// Realizations to be drawn.
    looks: BTreeMap<SetId, u64>,
    /// Sets to be left as they are, or to go on with.
    holds: BTreeMap<SetId, bool>,
    /// Sets whose variances at fewer points are wanted, or no longer.
    climbs: BTreeMap<SetId, bool>,
    results: BTreeMap<SetId, Arc<Snapshot>>,
    paused: bool,
    stopped: bool,
    /// Time between two results of a set, if another one is wished for.
    pace: Option<Duration>,
    /// Of the step under way, with its set.
    step: Option<(SetId, Arc<Control>)>,
}

impl Shared {
    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Worker {
    /// Starts it. `notify` is called, from its thread, when there is a new result.
    pub fn new(notify: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared { desk: Mutex::default(), wake: Condvar::new(), notify: Box::new(notify) });
        #[cfg(not(target_arch = "wasm32"))]
        {
            let of_thread = shared.clone();
            let thread = std::thread::Builder::new().name("pairwave worker".into()).spawn(move || run(&of_thread))?;
            Ok(Self { shared, thread: Some(thread) })
        }
        #[cfg(target_arch = "wasm32")]
        Ok(Self { shared, engine: Engine::default() })
    }

    /// Asks for a set, or for other settings of it; takes effect within a step.
    pub fn set(&self, id: SetId, request: Request) {
        self.wish(id, Some(request));
    }

    /// Forgets a set.
    pub fn remove(&self, id: SetId) {
        self.wish(id, None);
        self.shared.desk().results.remove(&id);
    }

    fn wish(&self, id: SetId, wish: Option<Request>) {
        let mut desk = self.shared.desk();
        desk.wishes.insert(id, wish);
        if let Some((_, control)) = desk.step.as_ref().filter(|(of, _)| *of == id) {
            control.cancel();
        }
        self.shared.wake.notify_one();
    }

    /// Leaves a set as it is, or goes on with it; a step under way is given up.
    pub fn hold(&self, id: SetId, held: bool) {
        let mut desk = self.shared.desk();
        desk.holds.insert(id, held);
        if let Some((_, control)) = desk.step.as_ref().filter(|(of, _)| held && *of == id) {
            control.cancel();
        }
        self.shared.wake.notify_one();
    }

    /// Has variances of integrals of a set measured at fewer points too, or no longer; a step under way is given up then.
    pub fn climb(&self, id: SetId, climbs: bool) {
        let mut desk = self.shared.desk();
        desk.climbs.insert(id, climbs);
        if let Some((_, control)) = desk.step.as_ref().filter(|(of, _)| !climbs && *of == id) {
            control.cancel();
        }
        self.shared.wake.notify_one();
    }

    /// Has another realization of a set drawn, even while nothing is measured.
    pub fn look(&self, id: SetId, realization: u64) {
        self.shared.desk().looks.insert(id, realization);
        self.shared.wake.notify_one();
    }

    /// Stops measuring until it is told to go on; a step under way is given up.
    pub fn pause(&self, paused: bool) {
        let mut desk = self.shared.desk();
        desk.paused = paused;
        if let Some((_, control)) = desk.step.as_ref().filter(|_| paused) {
            control.cancel();
        }
        self.shared.wake.notify_one();
    }

    /// Gives results of a set no more often than this while realizations come in; those that are last come at once.
    pub fn pace(&self, pace: Duration) {
        self.shared.desk().pace = Some(pace);
    }

    /// The latest of a set.
    pub fn latest(&self, id: SetId) -> Option<Arc<Snapshot>> {
        self.shared.desk().results.get(&id).cloned()
    }

    /// Where there is no thread, takes a step. To be called once per frame.
    pub fn poll(&mut self) {
        #[cfg(target_arch = "wasm32")]
        turn(&self.shared, &mut self.engine);
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        let mut desk = self.shared.desk();
        desk.stopped = true;
        if let Some((_, control)) = &desk.step {
            control.cancel();
        }
        drop(desk);
        self.shared.wake.notify_one();
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(thread) = self.thread.take() {
            // A panic there was reported there.
            let _ = thread.join();
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn run(shared: &Shared) {
    let mut engine = Engine::default();
    loop {
        let desk = shared.desk();
        let nothing = |desk: &mut Desk| {
            let to_do = !desk.paused && !engine.is_idle() || engine.looking().is_some();
            let told =
                desk.wishes.is_empty() && desk.holds.is_empty() && desk.looks.is_empty() && desk.climbs.is_empty();
            !desk.stopped && told && !to_do
        };
        let desk = shared.wake.wait_while(desk, nothing).unwrap_or_else(PoisonError::into_inner);
        if desk.stopped {
            return;
        }
        drop(desk);
        turn(shared, &mut engine);
    }
}

/// Takes the wishes, then one step.
fn turn(shared: &Shared, engine: &mut Engine) {
    let control = Arc::new(Control::default());
    let (of, looking);
    {
        let mut desk = shared.desk();
        for (id, wish) in std::mem::take(&mut desk.wishes) {
            match wish {
                Some(request) => engine.set(id, request),
                None => engine.remove(id),
            }
        }
        for (id, held) in std::mem::take(&mut desk.holds) {
            engine.hold(id, held);
        }
        for (id, climbs) in std::mem::take(&mut desk.climbs) {
            engine.climb(id, climbs);
        }
        for (id, realization) in std::mem::take(&mut desk.looks) {
            engine.look(id, realization);
        }
        if let Some(pace) = desk.pace.take() {
            engine.pace = pace;
        }
        looking = engine.looking();
        if desk.paused && looking.is_none() {
            return;
        }
        let next = looking.or_else(|| engine.next());
        // What is looked at is not to wait, and not to be given up for a pause.
        desk.step = next.filter(|_| looking.is_none()).map(|id| (id, control.clone()));
        of = next.and_then(|id| Some((id, engine.request(id)?.clone())));
    }
    // A panic is a bug of ours: the set it is of stops, the others go on.
    let step = std::panic::AssertUnwindSafe(|| match looking {
        Some(_) => engine.fetch(&control),
        None => engine.step(&control),
    });
    let found = std::panic::catch_unwind(step).unwrap_or_else(|_| of.map(|(id, request)| engine.failed(id, request)));
    let mut desk = shared.desk();
    desk.step = None;
    let Some((id, snapshot)) = found else { return };
    // Forgotten while it was measured.
    if desk.wishes.get(&id).is_some_and(Option::is_none) {
        return;
    }
    desk.results.insert(id, Arc::new(snapshot));
    drop(desk);
    (shared.notify)();
}
