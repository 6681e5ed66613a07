#include "short_ways.c"
/* Greatest hardening of a plastic module under a force, f(s) = c*s^n. */
static real limit(real force)
{
#if HARDENING_EXPONENT == 2
    return HARDENING_COEFFICIENT * force * force;
#else
    return HARDENING_COEFFICIENT * r_pow(r_fabs(force), HARDENING_EXPONENT);
#endif
}

/* Slope of that by the size of the force. */
static real limit_slope(real force)
{
    return force == R(0) ? R(0) : HARDENING_EXPONENT * limit(force) / r_fabs(force);
}
