/* r after a way, where dr/dw = -r*rate(r, of), 0 < r <= 1: Runge-Kutta of fourth order on -ln r, in
 * steps that grow as r^(-1/4). What the rate is one of stands in `of`. */
static real approach(real r, real way, const real *of)
{
    for (;;) {
        real k1, k2, k3, k4, reach, h;
        /* Also where it is no number: a step is to end. */
        if (!(way > R(0))) {
            return r;
        }
        if (r < R(1e-17)) {
            return R(0);
        }
        k1 = rate(r, of);
        reach = R(1) / R(32) / (r_sqrt(r_sqrt(r)) * k1);
        h = way <= reach ? way : reach;
        k2 = rate(r * r_exp(-k1 * h * R(0.5)), of);
        k3 = rate(r * r_exp(-k2 * h * R(0.5)), of);
        k4 = rate(r * r_exp(-k3 * h), of);
        r *= r_exp(-(k1 + (k2 + k3) * R(2) + k4) / R(6) * h);
        if (way <= reach) {
            return r;
        }
        way -= h;
    }
}
