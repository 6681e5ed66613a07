/* e^x and 1 - e^x for x <= 0 as a polynomial, which the compiler can place among the work around it and
 * two of which go side by side: in loops of one trajectory faster than the library's. To 2 units in the
 * last place: x = n*ln 2 + r, and (e^r - 1 - r)/r^2 interpolated at the nodes of Chebyshev.
 */
#ifndef STICTION_EXPONENTIAL_H
#define STICTION_EXPONENTIAL_H

typedef double Pair __attribute__((vector_size(16)));
typedef long long PairBits __attribute__((vector_size(16)));

#define ROUNDER 6755399441055744.0
#define LEAST -708.0
#define LOG2_E 1.4426950408889634
#define LN_2_HIGH 6.931471803691238e-1
#define LN_2_LOW 1.9082149292705877e-10

/* (e^r - 1 - r)/r^2 of numbers of either kind; r2 and r4 are powers of r. */
#define QUOTIENT(r, r2, r4) \
    ((((0.5000000000000001 + (r) * 0.1666666666666667) \
         + (r2) * (0.04166666666662412 + (r) * 0.008333333333326134)) \
         + ((r4) * (r4)) * (2.762008948195459e-07 + (r) * 2.5105217695684516e-08)) \
        + (r4) * ((0.0013888888917215586 + (r) * 0.00019841269874822307) \
            + (r2) * (2.4801521293463862e-05 + (r) * 2.755725539833871e-06)))

/* e^x. */
static inline __attribute__((always_inline)) double fading(double x)
{
    double rounded = x * LOG2_E + ROUNDER, n = rounded - ROUNDER;
    double r = (x - n * LN_2_HIGH) - n * LN_2_LOW, r2 = r * r, r4 = r2 * r2;
    union {
        double number;
        unsigned long long bits;
    } scale = {rounded};
    scale.bits = (scale.bits << 52) + 0x3ff0000000000000ULL;
    double s = scale.number, found = (s + s * r) + (s * r2) * QUOTIENT(r, r2, r4);
    return x < LEAST ? 0.0 : found;
}

/* 1 - e^x. */
static inline __attribute__((always_inline)) double faded(double x)
{
    double rounded = x * LOG2_E + ROUNDER, n = rounded - ROUNDER;
    double r = (x - n * LN_2_HIGH) - n * LN_2_LOW, r2 = r * r, r4 = r2 * r2;
    union {
        double number;
        unsigned long long bits;
    } scale = {rounded};
    scale.bits = (scale.bits << 52) + 0x3ff0000000000000ULL;
    double s = scale.number, found = ((1.0 - s) - s * r) - (s * r2) * QUOTIENT(r, r2, r4);
    return x < LEAST ? 1.0 : found;
}

/* The one of the first and the other of the second. */
static inline __attribute__((always_inline)) Pair fading_and_faded(double first, double second)
{
    Pair x = {first, second}, whole = {0.0, 1.0}, sign = {1.0, -1.0}, one = {1.0, 1.0};
    Pair rounded = x * LOG2_E + ROUNDER, n = rounded - ROUNDER;
    Pair r = (x - n * LN_2_HIGH) - n * LN_2_LOW, r2 = r * r, r4 = r2 * r2;
    Pair s = (Pair)(((PairBits)rounded << 52) + (PairBits)one) * sign;
    Pair found = ((whole + s) + s * r) + (s * r2) * QUOTIENT(r, r2, r4);
    PairBits below = x < LEAST;
    return (Pair)((below & (PairBits)whole) | (~below & (PairBits)found));
}

#endif
