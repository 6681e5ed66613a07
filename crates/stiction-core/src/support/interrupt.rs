//! Long work that its caller may want to end early.
//!
//! The core knows no signals. Who calls it says how to ask whether to go on, and loops ask now and then:
//! at most every [`PERIOD`] the caller is asked, on the caller's own thread; other threads look at a flag.
//! Once the answer was to stop, all loops end as soon as they ask, and what they leave is for nobody.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crate::support::error::{Error, Result};

/// Time between two questions to the caller.
const PERIOD: Duration = Duration::from_millis(40);
/// A caller whose own share of the work is done looks at the other threads that often.
const GLANCE: Duration = Duration::from_millis(2);

/// How the work of a thread is watched.
#[derive(Debug)]
struct Watch {
    /// Asks the caller whether to stop; on the caller's thread alone.
    asks: Option<fn() -> bool>,
    /// When to ask next.
    next: Instant,
    stopped: Arc<AtomicBool>,
}

thread_local! {
    static WATCH: Cell<Option<Watch>> = const { Cell::new(None) };
}

impl Watch {
    fn due(&mut self) -> bool {
        if self.stopped.load(Ordering::Relaxed) {
            return true;
        }
        let Some(asks) = self.asks else { return false };
        let now = Instant::now();
        if now < self.next {
            return false;
        }
        if asks() {
            self.stopped.store(true, Ordering::Relaxed);
            return true;
        }
        // After the answer, which may have taken long.
        self.next = Instant::now() + PERIOD;
        false
    }

    /// Does the work of this thread under this watch.
    fn over<R>(self, work: impl FnOnce() -> R) -> R {
        /// Puts back what was there before, whatever the work does.
        struct Before(Option<Watch>);
        impl Drop for Before {
            fn drop(&mut self) {
                WATCH.set(self.0.take());
            }
        }
        let _before = Before(WATCH.replace(Some(self)));
        work()
    }
}

/// Does some work that ends early once `asks` says so; whether it did.
pub fn watched<R>(asks: fn() -> bool, work: impl FnOnce() -> R) -> (R, bool) {
    let stopped = Arc::new(AtomicBool::new(false));
    let watch =
        Watch { asks: Some(asks), next: Instant::now() + PERIOD, stopped: Arc::clone(&stopped) };
    let result = watch.over(work);
    (result, stopped.load(Ordering::Relaxed))
}

/// Whether the work of this thread is to end. Some tens of nanoseconds: asked once a chunk of samples.
#[inline(never)]
pub fn due() -> bool {
    // Taken out, for what is asked may call the core again.
    let Some(mut watch) = WATCH.take() else { return false };
    let stop = watch.due();
    WATCH.set(Some(watch));
    stop
}

/// An error where the work of this thread is to end.
pub fn check() -> Result<()> {
    if due() { Err(Error::Interrupted) } else { Ok(()) }
}

/// Steps that are taken between two questions: some tenths of a millisecond.
const STRIDE: u64 = 2048;

/// Asks after so many steps of work.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pace {
    since: u64,
}

impl Pace {
    /// Whether the work is to end, after so many steps more.
    #[inline(always)]
    pub fn due(&mut self, steps: u64) -> bool {
        self.since += steps;
        if self.since < STRIDE {
            return false;
        }
        self.since = 0;
        due()
    }
}

/// Does the same work on so many threads, this one among them, all under the watch of this one.
pub fn shared(threads: usize, labour: impl Fn() + Sync) {
    let others = threads.saturating_sub(1);
    let watch = WATCH.take();
    let stopped = watch.as_ref().map(|watch| Arc::clone(&watch.stopped));
    WATCH.set(watch);
    let working = AtomicUsize::new(others);
    std::thread::scope(|scope| {
        for _ in 0..others {
            scope.spawn(|| {
                /// One thread less, whatever its work did.
                struct Done<'a>(&'a AtomicUsize);
                impl Drop for Done<'_> {
                    fn drop(&mut self) {
                        self.0.fetch_sub(1, Ordering::Release);
                    }
                }
                let _done = Done(&working);
                match &stopped {
                    None => labour(),
                    Some(stopped) => {
                        let stopped = Arc::clone(stopped);
                        Watch { asks: None, next: Instant::now(), stopped }.over(&labour);
                    }
                }
            });
        }
        labour();
        if stopped.is_some() {
            while working.load(Ordering::Acquire) > 0 && !due() {
                std::thread::sleep(GLANCE);
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    thread_local! {
        static ASKED: Cell<u32> = const { Cell::new(0) };
    }

    fn third() -> bool {
        ASKED.set(ASKED.get() + 1);
        ASKED.get() >= 3
    }

    #[test]
    fn work_ends_on_all_threads_once_the_caller_says_so() {
        let began = Instant::now();
        let ((), stopped) = watched(third, || {
            shared(3, || {
                while !due() {
                    std::thread::sleep(Duration::from_millis(1));
                }
            });
        });
        assert!(stopped && ASKED.get() == 3);
        assert!(began.elapsed() < 20 * PERIOD);
        assert!(!due(), "nobody watches any more");
    }

    #[test]
    fn work_that_nobody_watches_goes_on() {
        let mut pace = Pace::default();
        assert!((0..10).all(|_| !pace.due(STRIDE)));
        let ran = AtomicUsize::new(0);
        shared(2, || {
            ran.fetch_add(1, Ordering::Relaxed);
        });
        assert_eq!(ran.into_inner(), 2);
    }
}
