/* r after a way, where dr/dw = -r*rate(r, of), 0 < r <= 1: Runge-Kutta of fourth order on -ln r, in
 * steps that grow as r^(-1/4). What the rate is one of stands in `of`.
 *
 * With `bend` > 0 the rate is nowhere below 1 and 1 + bend*r - ... near the end: no more than
 * r*exp(-way) is left then. Of a long way that is little, so that large steps are as good, and the
 * closed form of 1 + bend*r ends the way as soon as it errs by no more than they do. */
static real approach(real r, real way, real bend, const real *of)
{
    for (;;) {
        real k1, k2, k3, k4, longer, reach, h;
        /* Also where it is no number: a step is to end. */
        if (!(way > R(0))) {
            return r;
        }
        if (r < R(1e-17)) {
            return R(0);
        }
        longer = R(1) / r_sqrt(r_sqrt(r));
        if (bend > R(0) && way > R(1)) {
            const real end = r * r_exp(-way);
            const real bent = bend * r;
            const real off = bent * r * (R(0.5) + bent / R(9));
            real least;
            if (end * (off < R(1) ? off : R(1)) <= R(1e-10)) {
                return way > R(40) ? R(0) : r / (r_expm1(way) * (bent + R(1)) + R(1));
            }
            least = R(1) / r_sqrt(r_sqrt(end));
            least = least < R(32) ? least : R(32);
            longer = longer > least ? longer : least;
        }
        k1 = rate(r, of);
        reach = longer / (R(32) * k1);
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
