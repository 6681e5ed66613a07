//! Runs a loop with the widest vectors that the processor has.
//!
//! The loop is plain Rust, compiled once for each [`Width`]. Nothing is fused or reassociated on the
//! way, so that it gives the same bits at every width. A crate of its own, for calling what was
//! compiled for another processor is the one step here that the compiler cannot check.

#![deny(unsafe_op_in_unsafe_fn)]

mod pair;

pub use pair::{Numbers, Pair};

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

/// A loop; mark `run` as `#[inline(always)]`, or it is compiled for the baseline alone.
pub trait Task {
    /// What it returns.
    type Output;
    /// Runs it.
    fn run(self) -> Self::Output;
}

impl Width {
    /// The widest that this processor has.
    pub fn widest() -> Self {
        [Self::Eight, Self::Four]
            .into_iter()
            .find(|width| width.is_there())
            .unwrap_or(Self::Baseline)
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
