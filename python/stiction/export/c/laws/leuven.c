/* LuGre's dynamics on a hysteresis with closing loops: Swevers, Al-Bender, Ganseman, Prajogo, IEEE
 * Trans. Autom. Control 45 (2000), with z' of Lampaert, Swevers, Al-Bender, ibid. 47 (2002). The
 * branches that a path leads along are followed one by one. */
#let TOP = SATURATION * BREAKAWAY
#include "mean_level.c"
#include "bristle_damping.c"
#include "logarithmic_mean.c"
#let SLIDING = BREAKAWAY
#let STIFFEST = 2 * INITIAL_STIFFNESS
#let CALMS = DAMPING + VISCOUS
#let FALLS_BY = EXCESS
#include "spring.c"
typedef stiction_spring stiction_law;

/* How r = (g - F)/g falls along a branch: of[0] its gap at the end, of[1] its length, of[2] +1
 * towards g from below and -1 from above. */
#if EXPONENT != 1

static real rate(real r, const real *of)
{
    const real a = R(1) - of[2] * r;
    real bends;
    if (r < R(1e-4)) {
        bends = EXPONENT * (R(1) - r * (R(0.5) * of[2] * (EXPONENT - R(1))
                                        - r * (EXPONENT - R(1)) * (EXPONENT - R(2)) / R(6)));
    } else {
        const real power = r_pow(r_fabs(a), EXPONENT);
        bends = of[2] * (R(1) - (a < R(0) ? -power : power)) / r;
    }
    return (r + of[0]) / of[1] * bends;
}
#include "approach.c"
#let NODE = [0.046910077030668, 0.23076534494715845, 0.5, 0.7692346550528415, 0.953089922969332]
#let PART = [0.11846344252809454, 0.23931433524968323, 0.28444444444444444, 0.23931433524968323, \
             0.11846344252809454]

/* The way from r to a target below it: Gauss's rule of five points over ln r. */
static real way_to(real r, real target, const real *of)
{
    const real begin = r_log(r), width = begin - r_log(target);
    real parts = r_ceil(width / R(0.25)), sum = R(0);
    int part, k;
    parts = parts < R(1) ? R(1) : parts > R(200) ? R(200) : parts;
    for (part = 0; part < (int)parts; ++part) {
        for (k = 0; k < 5; ++k) {
            const real share = ((real)part + NODE[k]) / parts;
            sum += PART[k] / rate(r_exp(begin - width * share), of);
        }
    }
    return sum * width / parts;
}
#else

/* The same in closed form. */
static real approach(real r, real way, real bend, const real *of)
{
    const real z = of[0] * way / of[1];
    (void)bend;
    return z > R(40) ? R(0) : r / (r_expm1(z) * (r / of[0] + R(1)) + R(1));
}

static real way_to(real r, real target, const real *of)
{
    return r_log1p((r - target) * of[0] / (target * (of[0] + r))) * of[1] / of[0];
}
#endif

/* Leads the deflection along a path of the body at this g. */
static void bend(stiction_spring *spring, int side, real path, real level)
{
    const int rising = spring->force * (real)side <= level;
    const int direction = rising ? side : -side;
    const real goal = rising ? level : -level;
    const int turned = spring->direction == -direction;
    walked end;
    real force = spring->force * (real)direction, along;
    end.kept = spring->points;
    end.turned = turned;
    end.direction = direction;
    for (;;) {
        const int points = end.kept + end.turned;
        const real from = points == 0 ? R(0) : (real)direction
            * (end.turned ? spring->force : spring->forces[points - 1]);
        const real span = points ? R(2) * TOP : TOP;
        const real r = (goal - force) / level;
        real of[3], closing = R(0), stop;
        int closes = 1, crosses;
        of[0] = (from + span - goal) / level;
        of[1] = span / INITIAL_STIFFNESS;
        of[2] = rising ? R(1) : R(-1);
        if (points >= 2) {
            closing = (real)direction * spring->forces[points - 2];
        } else if (points == 1) {
            closing = -from;
        } else {
            closes = 0;
        }
        closes = closes && closing < goal;
        /* Where the force changes sign the rate is not smooth. */
        crosses = rising && r > R(1) && (!closes || closing > R(0));
        if (closes || crosses) {
            const real size = r_fabs(force) > level ? r_pow(r_fabs(force) / level, EXPONENT) : R(1);
            real needed = R(0);
            stop = crosses ? R(0) : closing;
            if (stop - force <= INITIAL_STIFFNESS * path * (R(1) + size)) {
                if (stop > force) {
                    needed = way_to(r, (goal - stop) / level, of);
                }
                if (needed <= path) {
                    path -= needed;
                    force = stop;
                    if (!crosses) {
                        end.kept = points >= 2 ? points - 2 : 0;
                        end.turned = 0;
                    }
                    continue;
                }
            }
        }
        if (r > R(0)) {
            force = goal - approach(r, path, R(0), of) * level;
        }
        along = (force - from) / span;
        along = along > R(0) ? along : R(0);
        along = along < R(1) - EPSILON ? along : R(1) - EPSILON;
        end.way = of[1] * along * logarithmic_mean(along);
        end.force = (real)direction * force;
        accept(spring, &end);
        return;
    }
}

static real law_step(stiction_state *s, const motion *m)
{
    const real level = sliding_level(m->velocity);
    real a, size;
    if (m->displacement != R(0)) {
        bend(&s->law, m->displacement > R(0) ? 1 : -1, r_fabs(m->displacement), mean_level(m));
    }
    if (m->velocity == R(0)) {
        return s->law.force * LEVEL;
    }
    a = (m->velocity > R(0) ? s->law.force : -s->law.force) / level;
    size = r_pow(r_fabs(a), EXPONENT);
    return (s->law.force + bristle_damping(m->velocity, a < R(0) ? -size : size)) * LEVEL;
}
