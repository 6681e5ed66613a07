//! Vectors of SSE2, AVX2 and AVX-512.

use std::arch::x86_64 as arch;
use std::ops::Div;

use super::{CHUNKS, Mask, ROW, Vector};
use crate::pair::Numbers;

/// SSE2.
#[derive(Debug, Clone, Copy)]
pub struct Two(arch::__m128d);
/// AVX2.
#[derive(Debug, Clone, Copy)]
pub struct Four(arch::__m256d);
/// AVX-512.
#[derive(Debug, Clone, Copy)]
pub struct Eight(arch::__m512d);

/// Bits of [`Two`], all of a number or none.
#[derive(Debug, Clone, Copy)]
pub struct TwoBits(arch::__m128d);
/// The same of [`Four`].
#[derive(Debug, Clone, Copy)]
pub struct FourBits(arch::__m256d);

operations!(Two, arch::_mm_add_pd, arch::_mm_sub_pd, arch::_mm_mul_pd, arch::_mm_div_pd);
operations!(
    Four,
    arch::_mm256_add_pd,
    arch::_mm256_sub_pd,
    arch::_mm256_mul_pd,
    arch::_mm256_div_pd
);
operations!(
    Eight,
    arch::_mm512_add_pd,
    arch::_mm512_sub_pd,
    arch::_mm512_mul_pd,
    arch::_mm512_div_pd
);

const SIGN: f64 = -0.0;

// Of a function that is unsafe for what it is compiled for alone: the caller has a vector of the kind,
// or is about to, and that only a loop has which runs on a processor with it.
macro_rules! numbers {
    ($name:ident, $set:ident, $cast:ident, $back:ident, $shift:ident, $more:ident, $ones:ident) => {
        impl Numbers for $name {
            #[inline(always)]
            fn all(number: f64) -> Self {
                // SAFETY: as above.
                Self(unsafe { arch::$set(number) })
            }

            #[inline(always)]
            fn power_of_two(self) -> Self {
                // SAFETY: as above.
                unsafe {
                    let power = arch::$shift::<52>(arch::$cast(self.0));
                    let one = arch::$ones(1.0_f64.to_bits().cast_signed());
                    Self(arch::$back(arch::$more(power, one)))
                }
            }

            #[inline(always)]
            fn unless_below(self, x: Self, least: f64, other: Self) -> Self {
                self.or(x.below(Self::all(least)), other)
            }
        }
    };
}

numbers!(
    Two,
    _mm_set1_pd,
    _mm_castpd_si128,
    _mm_castsi128_pd,
    _mm_slli_epi64,
    _mm_add_epi64,
    _mm_set1_epi64x
);
numbers!(
    Four,
    _mm256_set1_pd,
    _mm256_castpd_si256,
    _mm256_castsi256_pd,
    _mm256_slli_epi64,
    _mm256_add_epi64,
    _mm256_set1_epi64x
);
numbers!(
    Eight,
    _mm512_set1_pd,
    _mm512_castpd_si512,
    _mm512_castsi512_pd,
    _mm512_slli_epi64,
    _mm512_add_epi64,
    _mm512_set1_epi64
);

// What is the same of all kinds: places and bits.
macro_rules! moves {
    ($load:ident, $store:ident, $and:ident, $andnot:ident, $xor:ident) => {
        #[inline(always)]
        fn load(row: &[f64; ROW], chunk: usize) -> Self {
            let from: &[f64; Self::LANES] = row.as_chunks().0.get(chunk).unwrap_or(&[0.0; _]);
            // SAFETY: as many numbers as are read.
            Self(unsafe { arch::$load(from.as_ptr()) })
        }

        #[inline(always)]
        fn store(self, row: &mut [f64; ROW], chunk: usize) {
            let to: Option<&mut [f64; Self::LANES]> = row.as_chunks_mut().0.get_mut(chunk);
            if let Some(to) = to {
                // SAFETY: as many numbers as are written.
                unsafe { arch::$store(to.as_mut_ptr(), self.0) };
            }
        }

        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: as above.
            Self(unsafe { arch::$andnot(Self::all(SIGN).0, self.0) })
        }

        #[inline(always)]
        fn flipped(self, by: Self) -> Self {
            // SAFETY: as above.
            Self(unsafe { arch::$xor(self.0, arch::$and(by.0, Self::all(SIGN).0)) })
        }
    };
}

impl Vector for Two {
    type Mask = TwoBits;
    const LANES: usize = 2;

    moves!(_mm_loadu_pd, _mm_storeu_pd, _mm_and_pd, _mm_andnot_pd, _mm_xor_pd);

    #[inline(always)]
    fn below(self, other: Self) -> TwoBits {
        // SAFETY: as above.
        TwoBits(unsafe { arch::_mm_cmplt_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn within(self, other: Self) -> TwoBits {
        // SAFETY: as above.
        TwoBits(unsafe { arch::_mm_cmple_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn kept(self, mask: TwoBits) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm_and_pd(self.0, mask.0) })
    }

    #[inline(always)]
    fn or(self, mask: TwoBits, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe {
            let (kept, new) =
                (arch::_mm_andnot_pd(mask.0, self.0), arch::_mm_and_pd(mask.0, other.0));
            arch::_mm_or_pd(kept, new)
        })
    }

    #[inline(always)]
    fn at_least(self, other: Self) -> Self {
        // SAFETY: as above. Of numbers that do not compare it gives the second.
        Self(unsafe { arch::_mm_max_pd(other.0, self.0) })
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm_min_pd(other.0, self.0) })
    }

    #[inline(always)]
    fn across(rows: [&[f64; ROW]; ROW]) -> [[Self; CHUNKS]; ROW] {
        let mut found = [[Self::default(); CHUNKS]; ROW];
        for chunk in 0..CHUNKS {
            for part in 0..CHUNKS {
                let a = Self::load(rows[2 * chunk], part).0;
                let b = Self::load(rows[2 * chunk + 1], part).0;
                // SAFETY: as above.
                let (low, high) =
                    unsafe { (arch::_mm_unpacklo_pd(a, b), arch::_mm_unpackhi_pd(a, b)) };
                found[2 * part][chunk] = Self(low);
                found[2 * part + 1][chunk] = Self(high);
            }
        }
        found
    }
}

impl Vector for Four {
    type Mask = FourBits;
    const LANES: usize = 4;

    moves!(_mm256_loadu_pd, _mm256_storeu_pd, _mm256_and_pd, _mm256_andnot_pd, _mm256_xor_pd);

    #[inline(always)]
    fn below(self, other: Self) -> FourBits {
        // SAFETY: as above.
        FourBits(unsafe { arch::_mm256_cmp_pd::<{ arch::_CMP_LT_OQ }>(self.0, other.0) })
    }

    #[inline(always)]
    fn within(self, other: Self) -> FourBits {
        // SAFETY: as above.
        FourBits(unsafe { arch::_mm256_cmp_pd::<{ arch::_CMP_LE_OQ }>(self.0, other.0) })
    }

    #[inline(always)]
    fn kept(self, mask: FourBits) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm256_and_pd(self.0, mask.0) })
    }

    #[inline(always)]
    fn or(self, mask: FourBits, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm256_blendv_pd(self.0, other.0, mask.0) })
    }

    #[inline(always)]
    fn at_least(self, other: Self) -> Self {
        // SAFETY: as above. Of numbers that do not compare it gives the second.
        Self(unsafe { arch::_mm256_max_pd(other.0, self.0) })
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm256_min_pd(other.0, self.0) })
    }

    #[inline(always)]
    fn across(rows: [&[f64; ROW]; ROW]) -> [[Self; CHUNKS]; ROW] {
        let mut found = [[Self::default(); CHUNKS]; ROW];
        for chunk in 0..Self::CHUNKS {
            for part in 0..Self::CHUNKS {
                let (a, b) =
                    (Self::load(rows[4 * chunk], part).0, Self::load(rows[4 * chunk + 1], part).0);
                let (c, d) = (
                    Self::load(rows[4 * chunk + 2], part).0,
                    Self::load(rows[4 * chunk + 3], part).0,
                );
                // SAFETY: as above.
                let across = unsafe {
                    let (even, odd) =
                        (arch::_mm256_unpacklo_pd(a, b), arch::_mm256_unpackhi_pd(a, b));
                    let (even_too, odd_too) =
                        (arch::_mm256_unpacklo_pd(c, d), arch::_mm256_unpackhi_pd(c, d));
                    [
                        arch::_mm256_permute2f128_pd::<0x20>(even, even_too),
                        arch::_mm256_permute2f128_pd::<0x20>(odd, odd_too),
                        arch::_mm256_permute2f128_pd::<0x31>(even, even_too),
                        arch::_mm256_permute2f128_pd::<0x31>(odd, odd_too),
                    ]
                };
                for (k, across) in across.into_iter().enumerate() {
                    found[4 * part + k][chunk] = Self(across);
                }
            }
        }
        found
    }
}

impl Vector for Eight {
    type Mask = u8;
    const LANES: usize = 8;

    moves!(_mm512_loadu_pd, _mm512_storeu_pd, _mm512_and_pd, _mm512_andnot_pd, _mm512_xor_pd);

    #[inline(always)]
    fn below(self, other: Self) -> u8 {
        // SAFETY: as above.
        unsafe { arch::_mm512_cmp_pd_mask::<{ arch::_CMP_LT_OQ }>(self.0, other.0) }
    }

    #[inline(always)]
    fn below_in(self, mask: u8, other: Self) -> u8 {
        // SAFETY: as above.
        unsafe { arch::_mm512_mask_cmp_pd_mask::<{ arch::_CMP_LT_OQ }>(mask, self.0, other.0) }
    }

    #[inline(always)]
    fn within(self, other: Self) -> u8 {
        // SAFETY: as above.
        unsafe { arch::_mm512_cmp_pd_mask::<{ arch::_CMP_LE_OQ }>(self.0, other.0) }
    }

    #[inline(always)]
    fn kept(self, mask: u8) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm512_maskz_mov_pd(mask, self.0) })
    }

    #[inline(always)]
    fn or(self, mask: u8, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm512_mask_mov_pd(self.0, mask, other.0) })
    }

    #[inline(always)]
    fn at_least(self, other: Self) -> Self {
        // SAFETY: as above. Of numbers that do not compare it gives the second.
        Self(unsafe { arch::_mm512_max_pd(other.0, self.0) })
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm512_min_pd(other.0, self.0) })
    }

    #[inline(always)]
    fn across(rows: [&[f64; ROW]; ROW]) -> [[Self; CHUNKS]; ROW] {
        let [a, b, c, d, e, f, g, h] = rows;
        let (a, b, c, d) =
            (Self::load(a, 0).0, Self::load(b, 0).0, Self::load(c, 0).0, Self::load(d, 0).0);
        let (e, f, g, h) =
            (Self::load(e, 0).0, Self::load(f, 0).0, Self::load(g, 0).0, Self::load(h, 0).0);
        // SAFETY: as above.
        let across = unsafe {
            // Numbers of two rows beside one another, quarters of four rows, halves of all.
            let even = [
                arch::_mm512_unpacklo_pd(a, b),
                arch::_mm512_unpacklo_pd(c, d),
                arch::_mm512_unpacklo_pd(e, f),
                arch::_mm512_unpacklo_pd(g, h),
            ];
            let odd = [
                arch::_mm512_unpackhi_pd(a, b),
                arch::_mm512_unpackhi_pd(c, d),
                arch::_mm512_unpackhi_pd(e, f),
                arch::_mm512_unpackhi_pd(g, h),
            ];
            let [[a, e], [c, g]] = quarters(even);
            let [[b, f], [d, h]] = quarters(odd);
            [a, b, c, d, e, f, g, h]
        };
        let mut found = [[Self::default(); CHUNKS]; ROW];
        for (found, across) in found.iter_mut().zip(across) {
            *found = [Self(across); CHUNKS];
        }
        found
    }
}

/// Of pairs of numbers of four times two rows, those at 0 and 4 of each four pairs … across.
///
/// # Safety
///
/// The processor has AVX-512.
#[inline(always)]
unsafe fn quarters([a, b, c, d]: [arch::__m512d; 4]) -> [[arch::__m512d; 2]; 2] {
    // SAFETY: as the caller says.
    unsafe {
        let (near, near_too) = (
            arch::_mm512_shuffle_f64x2::<0b1000_1000>(a, b),
            arch::_mm512_shuffle_f64x2::<0b1000_1000>(c, d),
        );
        let (far, far_too) = (
            arch::_mm512_shuffle_f64x2::<0b1101_1101>(a, b),
            arch::_mm512_shuffle_f64x2::<0b1101_1101>(c, d),
        );
        [
            [
                arch::_mm512_shuffle_f64x2::<0b1000_1000>(near, near_too),
                arch::_mm512_shuffle_f64x2::<0b1101_1101>(near, near_too),
            ],
            [
                arch::_mm512_shuffle_f64x2::<0b1000_1000>(far, far_too),
                arch::_mm512_shuffle_f64x2::<0b1101_1101>(far, far_too),
            ],
        ]
    }
}

impl Mask for TwoBits {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm_and_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm_or_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn but(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm_andnot_pd(other.0, self.0) })
    }

    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: as above.
        let all = Self(unsafe { arch::_mm_castsi128_pd(arch::_mm_set1_epi64x(-1)) });
        all.but(self)
    }

    #[inline(always)]
    fn same(self, other: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            let differ = arch::_mm_castpd_si128(arch::_mm_xor_pd(self.0, other.0));
            Self(arch::_mm_castsi128_pd(arch::_mm_xor_si128(differ, arch::_mm_set1_epi64x(-1))))
        }
    }

    #[inline(always)]
    fn bits(self) -> u8 {
        // SAFETY: as above.
        unsafe { arch::_mm_movemask_pd(self.0) as u8 }
    }

    #[inline(always)]
    fn of(bits: u8) -> Self {
        let spelt = |k: u8| i64::from(bits >> k & 1).wrapping_neg();
        // SAFETY: as above.
        Self(unsafe { arch::_mm_castsi128_pd(arch::_mm_set_epi64x(spelt(1), spelt(0))) })
    }
}

impl Mask for FourBits {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm256_and_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm256_or_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn but(self, other: Self) -> Self {
        // SAFETY: as above.
        Self(unsafe { arch::_mm256_andnot_pd(other.0, self.0) })
    }

    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: as above.
        let all = Self(unsafe { arch::_mm256_castsi256_pd(arch::_mm256_set1_epi64x(-1)) });
        all.but(self)
    }

    #[inline(always)]
    fn same(self, other: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            let differ = arch::_mm256_castpd_si256(arch::_mm256_xor_pd(self.0, other.0));
            let same = arch::_mm256_xor_si256(differ, arch::_mm256_set1_epi64x(-1));
            Self(arch::_mm256_castsi256_pd(same))
        }
    }

    #[inline(always)]
    fn bits(self) -> u8 {
        // SAFETY: as above.
        unsafe { arch::_mm256_movemask_pd(self.0) as u8 }
    }

    #[inline(always)]
    fn of(bits: u8) -> Self {
        let spelt = |k: u8| i64::from(bits >> k & 1).wrapping_neg();
        // SAFETY: as above.
        Self(unsafe {
            let lanes = arch::_mm256_set_epi64x(spelt(3), spelt(2), spelt(1), spelt(0));
            arch::_mm256_castsi256_pd(lanes)
        })
    }
}

impl Mask for u8 {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self | other
    }

    #[inline(always)]
    fn but(self, other: Self) -> Self {
        self & !other
    }

    #[inline(always)]
    fn not(self) -> Self {
        !self
    }

    #[inline(always)]
    fn same(self, other: Self) -> Self {
        !(self ^ other)
    }

    #[inline(always)]
    fn bits(self) -> u8 {
        self
    }

    #[inline(always)]
    fn of(bits: u8) -> Self {
        bits
    }
}
