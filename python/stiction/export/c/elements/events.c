/* The zero of a margin that is positive at 0 and, `beyond`, not at the end of a span: by the secant
 * of the last two attempts, bisection as a guard. */
static real locate(real (*margin)(const stiction_law *, const motion *, real),
                   const stiction_law *law, const motion *m, real span, real beyond)
{
    real low = R(0), high = span, at_low = margin(law, m, R(0)), at_high = beyond;
    real before = low, at_before = at_low, last = high, at_last = at_high;
    real older = R(2) * high, newer = R(2) * high, past, within;
    const real tolerance = (EPSILON > R(1e-10) ? EPSILON : R(1e-13)) * high;
    int k;
    if (at_low <= R(0) || high <= R(0)) {
        return R(0);
    }
    if (beyond >= R(0)) {
        return span;
    }
    past = tolerance;
    for (k = 0; k < 100 && high - low > tolerance; ++k) {
        const real secant = last - at_last * (last - before) / (at_last - at_before);
        const real middle = R(0.5) * (low + high);
        const int sound = secant > low && secant < high
            && r_fabs(secant - last) <= R(0.5) * older;
        real next = sound ? secant : middle, there;
        if (r_fabs(next - last) < tolerance) {
            if (last == low) {
                next = low + past < middle ? low + past : middle;
            } else {
                next = high - past > middle ? high - past : middle;
            }
            past *= R(4);
        }
        there = margin(law, m, next);
        older = newer;
        newer = r_fabs(next - last);
        before = last;
        at_before = at_last;
        last = next;
        at_last = there;
        if (there == R(0)) {
            return next;
        }
        if (there > R(0)) {
            low = next;
            at_low = there;
        } else {
            high = next;
            at_high = there;
        }
    }
    within = at_low / (at_low - at_high);
    return low + (high - low) * within;
}
