/* -ln(1 - u)/u for u < 1; 1 at u = 0. */
static real logarithmic_mean(real u)
{
    if (r_fabs(u) < R(1e-3)) {
        return R(1) + u * (R(1) / R(2) + u * (R(1) / R(3) + u * (R(1) / R(4)
               + u * (R(1) / R(5) + u / R(6)))));
    }
    return -r_log1p(-u) / u;
}
