//! Runs a loop with the widest vectors that the processor has.
//!
//! The loop is plain Rust, compiled once for each [`Width`]. Nothing is fused or reassociated on the
//! way, so that it gives the same bits at every width. A crate of its own, for calling what was
//! compiled for another processor is the one step here that the compiler cannot check.

#![deny(unsafe_op_in_unsafe_fn)]

mod pair;
mod vector;

use std::sync::atomic::{AtomicU8, Ordering};

pub use pair::{Numbers, Pair, alone};
pub use vector::{CHUNKS, Mask, ROW, Vector};

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

/// The same, written in vectors.
pub trait Wide {
    /// What it returns.
    type Output;
    /// Runs it in vectors of this kind.
    fn run<V: Vector>(self) -> Self::Output;
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

    /// Likewise of a task that is written in vectors.
    #[inline]
    pub fn run_wide<T: Wide>(self, task: T) -> T::Output {
        #[cfg(target_arch = "x86_64")]
        if self.is_there() {
            match self {
                // SAFETY: the processor has what the function is compiled for, as just asked.
                Self::Eight => return unsafe { eight_wide(task) },
                // SAFETY: likewise.
                Self::Four => return unsafe { four_wide(task) },
                Self::Baseline => (),
            }
        }
        task.run::<vector::Two>()
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl")]
fn eight_wide<T: Wide>(task: T) -> T::Output {
    task.run::<vector::Eight>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn four_wide<T: Wide>(task: T) -> T::Output {
    task.run::<vector::Four>()
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

    /// All operations of vectors on two rows, in the order below.
    struct All<'a>(&'a [f64; ROW], &'a [f64; ROW]);

    impl Wide for All<'_> {
        type Output = Vec<u64>;

        #[inline(always)]
        fn run<V: Vector>(self) -> Vec<u64> {
            let mut found = vec![[0.0; ROW]; 15];
            let (mut bits, mut across) = ([0_u8; 3], vec![[0.0; ROW]; ROW]);
            for chunk in 0..V::CHUNKS {
                let (a, b) = (V::load(self.0, chunk), V::load(self.1, chunk));
                let (below, within) = (a.below(b), a.within(b));
                let all = [
                    a + b,
                    a - b,
                    a * b,
                    a / b,
                    a.abs(),
                    a.flipped(b),
                    a.minus(),
                    a.kept(below),
                    a.or(within, b),
                    V::all(0.3),
                    a.unless_below(b, -0.5, V::all(7.0)),
                    a.kept(below.same(within)),
                    a.at_least(b),
                    a.at_most(b),
                    V::all(3.0).power_of_two(),
                ];
                for (row, one) in found.iter_mut().zip(all) {
                    one.store(row, chunk);
                }
                let masks = [
                    below.and(within),
                    within.same(below),
                    V::Mask::of(0b0110_1001 >> (chunk * V::LANES)),
                ];
                for (bits, mask) in bits.iter_mut().zip(masks) {
                    let lanes = ((1_u32 << V::LANES) - 1) as u8;
                    *bits |= (mask.bits() & lanes) << (chunk * V::LANES);
                }
                assert_eq!(a.below_in(within, b).bits(), below.and(within).bits());
            }
            let rows: [[f64; ROW]; ROW] =
                std::array::from_fn(|row| std::array::from_fn(|k| (10 * row + k) as f64));
            for (k, vectors) in V::across(rows.each_ref()).iter().enumerate() {
                for (chunk, vector) in vectors.iter().enumerate().take(V::CHUNKS) {
                    vector.store(&mut across[k], chunk);
                }
            }
            for (k, row) in across.iter().enumerate() {
                assert_eq!(*row, std::array::from_fn(|lane| (10 * lane + k) as f64));
            }
            let numbers = found.iter().flatten().map(|x| x.to_bits());
            numbers.chain(bits.map(u64::from)).collect()
        }
    }

    #[test]
    fn vectors_of_every_kind_do_what_numbers_do() {
        let a = [0.0, -0.0, 1.5, -2.25, f64::NAN, f64::INFINITY, -7e-300, 0.1];
        let b = [-0.0, 0.0, 1.5, -2.0, 1.0, -f64::INFINITY, 3.0, -0.7];
        let plain = Width::Baseline.run_wide(All(&a, &b));
        for width in [Width::Four, Width::Eight] {
            assert_eq!(width.run_wide(All(&a, &b)), plain, "{width:?}");
        }
        let row = |k: usize| &plain[k * ROW..(k + 1) * ROW];
        for k in 0..ROW {
            let (x, y) = (a[k], b[k]);
            let (below, within) = (x < y, x <= y);
            let flipped = if y.is_sign_negative() { -x } else { x };
            let all = [
                x + y,
                x - y,
                x * y,
                x / y,
                x.abs(),
                flipped,
                -x,
                if below { x } else { 0.0 },
                if within { y } else { x },
                0.3,
                if y < -0.5 { 7.0 } else { x },
                if below == within { x } else { 0.0 },
                if below { y } else { x },
                if y < x { y } else { x },
            ];
            for (k_of, expected) in all.into_iter().enumerate() {
                let given = f64::from_bits(row(k_of)[k]);
                let alike = given.to_bits() == expected.to_bits();
                assert!(alike || (given.is_nan() && expected.is_nan()), "{k_of} {x} {y} {given}");
            }
            let bit = |which: usize| plain[15 * ROW + which] >> k & 1 == 1;
            assert_eq!((bit(0), bit(1)), (below && within, below == within));
            assert_eq!(bit(2), 0b0110_1001 >> k & 1 == 1);
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
