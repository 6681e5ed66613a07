/* z' = A*v*(1 - (b*sgn(z*v) + 1 - b)*|z/F_c|^n): Wen, J. Eng. Mech. Div. ASCE 102 (1976). Against
 * the force by quadrature of its way, through zero by a series, towards F_c by Runge-Kutta. */
#let STIFFENING = 2 * UNLOADING_SHARE - 1
#let SMALL = 0.1
#let STRIDE = min(4 / EXPONENT, 1) / 32
#let NODE = [0.0469100770306680, 0.2307653449471585, 0.5, 0.7692346550528415, 0.9530899229693320]
#let PART = [0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832, \
             0.1184634425280945]
#include "logarithmic_mean.c"
#let SLIDING = COULOMB
#define EXCHANGES
#let STIFFEST = INITIAL_STIFFNESS * (1 + STIFFENING)
#let CALMS = VISCOUS
typedef struct {
    STICTION_REAL force;
} stiction_law;

/* Slope as a share of A, at u = z/F_c in the direction of motion. */
static real slope(real u)
{
    const real power = r_pow(r_fabs(u), EXPONENT);
    return u < R(0) ? R(1) + power * STIFFENING : R(1) - power;
}

/* Way over which u rises by a part against the force: Gauss's rule of five points. */
static real way_over(real u, real part)
{
    real sum = R(0);
    int k;
    for (k = 0; k < 5; ++k) {
        sum += PART[k] / slope(u + part * NODE[k]);
    }
    return sum * part;
}

/* Way from zero to a small u: the integral of the geometric series of 1/slope. */
static real small_way(real u)
{
    const real power = r_pow(r_fabs(u), EXPONENT);
    const real ratio = u < R(0) ? -power * STIFFENING : power;
    real sum = R(1), term = R(1);
    int k;
    for (k = 1; k <= 10; ++k) {
        term *= ratio;
        sum += term / (EXPONENT * (real)k + R(1));
    }
    return u * sum;
}

/* Of r = 1 - u, towards F_c. */
static real rate(real r, const real *of)
{
    (void)of;
    return -r_expm1(-r * logarithmic_mean(r) * EXPONENT) / r;
}
#include "approach.c"

/* u after a way. */
static real followed(real u, real left)
{
    int k;
    if (u < -SMALL) {
        const real step = STRIDE * (u < R(-1) ? -u : R(1));
        const real reach = left * slope(u);
        if (reach <= step && u + reach < -SMALL) {
            const real k1 = slope(u), k2 = slope(u + left * k1 * R(0.5));
            const real k3 = slope(u + left * k2 * R(0.5)), k4 = slope(u + left * k3);
            return u + left * (k1 + (k2 + k3) * R(2) + k4) / R(6);
        }
        while (u < -SMALL) {
            const int last = -u - SMALL <= R(1.5) * step;
            real part = last ? -(u + SMALL) : step;
            const real needed = way_over(u, part);
            if (needed > left) {
                part = left * slope(u);
                for (k = 0; k < 4; ++k) {
                    part += (left - way_over(u, part)) * slope(u + part);
                }
                return u + part;
            }
            left -= needed;
            u = last ? -SMALL : u + part;
        }
    }
    if (u < SMALL) {
        const real from = small_way(u), to = small_way(SMALL), target = from + left;
        if (target <= to) {
            u = target;
            for (k = 0; k < 4; ++k) {
                u += (target - small_way(u)) * slope(u);
            }
            return u;
        }
        left -= to - from;
        u = SMALL;
    }
    return u >= R(1) ? R(1) : R(1) - approach(R(1) - u, left, R(0), (const real *)0);
}

static real law_step(stiction_state *s, const motion *m)
{
    const real side = m->displacement > R(0) ? COULOMB : -COULOMB;
    if (m->displacement != R(0)) {
        const real way = INITIAL_STIFFNESS * r_fabs(m->displacement) / COULOMB;
        s->law.force = side * followed(s->law.force / side, way);
    }
    return s->law.force * LEVEL;
}
