//! Runs a loop with the widest vectors that the processor has.
//!
//! The loop is plain Rust, compiled once for each [`Width`]. Nothing is fused or reassociated on the
//! way, so that it gives the same bits at every width. A crate of its own, for calling what was
//! compiled for another processor is the one step here that the compiler cannot check.

#![deny(unsafe_op_in_unsafe_fn)]

mod pair;

use std::sync::atomic::{AtomicU8, Ordering};

pub use pair::{Numbers, Pair, alone};

/// Vectors to compile for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Width {
    /// What every processor of the target has; SSE2 on x86-64.
    Baseline,
    /// AVX2: four numbers.
    Four,
    /// AVX-512: eight numbers.
    Eight,
}

/// The widest that may be chosen.
static MOST: AtomicU8 = AtomicU8::new(Width::Eight as u8);

/// A loop; mark `run` as `#[inline(always)]`, or it is compiled for the baseline alone.
pub trait Task {
    /// What it returns.
    type Output;
    /// Runs it.
    fn run(self) -> Self::Output;
}

impl Width {
    /// The widest that this processor has, of those that [`Self::limit`] allows.
    pub fn widest() -> Self {
        let most = MOST.load(Ordering::Relaxed);
        [Self::Eight, Self::Four]
            .into_iter()
            .find(|width| *width as u8 <= most && width.is_there())
            .unwrap_or(Self::Baseline)
    }

    /// From now on nothing wider than this is [`Self::widest`], in the whole process: for those who
    /// compare what comes out at each width.
    pub fn limit(self) {
        MOST.store(self as u8, Ordering::Relaxed);
    }

    /// Whether this processor has it.
    #[cfg(target_arch = "x86_64")]
    pub fn is_there(self) -> bool {
        match self {
            Self::Baseline => true,
            Self::Four => is_x86_feature_detected!("avx2"),
            Self::Eight => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
        }
    }

    /// Whether this processor has it.
    #[cfg(not(target_arch = "x86_64"))]
    pub fn is_there(self) -> bool {
        self == Self::Baseline
    }

    /// Runs a task compiled for this width, or for the baseline where the processor lacks it.
    #[inline]
    pub fn run<T: Task>(self, task: T) -> T::Output {
        #[cfg(target_arch = "x86_64")]
        if self.is_there() {
            match self {
                // SAFETY: the processor has what the function is compiled for, as just asked.
                Self::Eight => return unsafe { eight(task) },
                // SAFETY: likewise.
                Self::Four => return unsafe { four(task) },
                Self::Baseline => (),
            }
        }
        task.run()
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl")]
fn eight<T: Task>(task: T) -> T::Output {
    task.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn four<T: Task>(task: T) -> T::Output {
    task.run()
}

/// Asks for the cache line of a number that is read soon. A hint: it changes nothing but time.
#[inline(always)]
pub fn fetch(ahead: &f64) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: the address is that of a number, and a hint neither reads nor writes it.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(ahead).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = ahead;
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Sums<'a>(&'a [f64], &'a mut [f64]);

    impl Task for Sums<'_> {
        type Output = f64;

        #[inline(always)]
        fn run(self) -> f64 {
            let mut total = 0.0;
            for (x, y) in self.0.iter().zip(self.1) {
                *y += x * x - 0.1 * x;
                total += *y;
            }
            total
        }
    }

    #[test]
    fn every_width_gives_the_same_bits() {
        let given: Vec<f64> = (0..37).map(|k| f64::from(k).sin()).collect();
        let run = |width: Width| {
            let mut out = vec![0.3; given.len()];
            let total = width.run(Sums(&given, &mut out));
            (total, out)
        };
        let plain = run(Width::Baseline);
        assert!(Width::widest().is_there());
        for width in [Width::Four, Width::Eight] {
            assert_eq!(run(width), plain);
        }
    }
}
