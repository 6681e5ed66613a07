#include "short_ways.c"
/* What follows a target that goes linearly from one value to another, after z time constants. */
static real lagging(real follower, real from, real to, real z)
{
    const real mean = first_mean(z);
    return from + (to - from) * (R(1) - mean) + (follower - from) * (R(1) - z * mean);
}
