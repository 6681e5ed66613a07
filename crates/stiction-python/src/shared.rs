//! What a Python object holds: for one thread at a time, and for no child of a fork in its midst.
//!
//! A process that forks takes a copy of every object along, but none of the other threads: what one of
//! them was working on stays half done, and locked, for ever. A child is told so instead of waiting.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;

use pyo3::prelude::*;

use crate::error::input_error;
use crate::interrupt::detached;

/// Forks that lie between the first process and this one.
static FORKS: AtomicU64 = AtomicU64::new(0);

/// How often one who waits looks whether it is free, and whether Ctrl-C was pressed.
const LOOK: Duration = Duration::from_micros(200);

/// Has Python count forks.
pub fn count_forks(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let counted = pyo3::wrap_pyfunction!(forked, module)?;
    let os = module.py().import("os")?;
    // Where a system has no forks there is nothing to count.
    if let Some(register) = os.getattr_opt("register_at_fork")? {
        let when = pyo3::types::PyDict::new(module.py());
        when.set_item("after_in_child", counted)?;
        register.call((), Some(&when))?;
    }
    Ok(())
}

#[pyfunction]
fn forked() {
    FORKS.fetch_add(1, Ordering::Relaxed);
}

/// Something that one thread at a time may see and change.
pub struct Shared<T> {
    inner: Mutex<T>,
    /// What [`FORKS`] was when it was last taken.
    taken: AtomicU64,
}

impl<T> Shared<T> {
    pub fn new(inner: T) -> Self {
        Self { inner: Mutex::new(inner), taken: AtomicU64::new(0) }
    }

    /// What is held, once no other thread has it.
    ///
    /// Raises an `InputError` where that is a thread of another process, and what a signal raises.
    #[inline]
    pub fn lock(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, T>> {
        match self.taken_at_once() {
            Some(guard) => Ok(guard),
            None => self.waited_for(py),
        }
    }

    /// Works on it without the interpreter; a signal whose handler raises ends it with that.
    pub fn apart<R: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut T) -> R + Send,
    ) -> PyResult<R>
    where
        T: Send,
    {
        // Only looked at: a guard stays in the thread and with the interpreter that it was made with.
        drop(self.lock(py)?);
        detached(py, || {
            let mut guard = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
            self.taken.store(FORKS.load(Ordering::Relaxed), Ordering::Relaxed);
            work(&mut guard)
        })
    }

    #[inline]
    fn taken_at_once(&self) -> Option<MutexGuard<'_, T>> {
        let guard = match self.inner.try_lock() {
            Ok(guard) => guard,
            // A panic is reported where it was; what it left is a state like any other.
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return None,
        };
        self.taken.store(FORKS.load(Ordering::Relaxed), Ordering::Relaxed);
        Some(guard)
    }

    #[cold]
    fn waited_for(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, T>> {
        loop {
            if let Some(guard) = self.taken_at_once() {
                return Ok(guard);
            }
            if self.taken.load(Ordering::Relaxed) != FORKS.load(Ordering::Relaxed) {
                return Err(lost(py));
            }
            py.detach(|| std::thread::sleep(LOOK));
            py.check_signals()?;
        }
    }
}

/// An object whose state another thread took along.
#[cold]
fn lost(py: Python<'_>) -> PyErr {
    input_error(
        py,
        "this object was at work in another thread when the process was forked, and its state is lost \
         here; give the child a copy that is made before, or start it with 'spawn'",
    )
}
