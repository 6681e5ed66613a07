/* F = a*arsinh(v/(2*v_0)*exp((F_0 + b*p)/a)), p the logarithm of the age of the contact: Dieterich
 * (1979), Ruina (1983), regularised as in Rice, Lapusta, Ranjith, J. Mech. Phys. Solids 49
 * (2001). */
#let DIRECT = COULOMB * DIRECT_EFFECT
#let YIELDS = COMPLIANCE > 1e-30
#let YIELDING = DIRECT * COMPLIANCE
#if not YIELDS
#include "held.c"
#endif
#let SLIDING = COULOMB
#if not YIELDS
#define STEEP
#endif
#let STIFFEST = (1 / COMPLIANCE if YIELDS else 0) + COULOMB * EVOLUTION_EFFECT / SLIP_DISTANCE
#let CALMS = VISCOUS
typedef struct {
    STICTION_REAL log_age;
#if YIELDS
    STICTION_REAL force;
#endif
} stiction_law;

/* arsinh(e^x); e^x itself may be far out of range. */
static real arcsinh_of_exp(real x)
{
    return x > R(20) ? x + LN_2 : r_asinh(r_exp(x));
}

/* p after a way in a time, the speed held. */
static real aged(real log_age, real way, real duration)
{
    const real worn = way / SLIP_DISTANCE;
#if EVOLUTION == 'ageing'
    const real share = worn < R(1e-3)
        ? R(1) - worn * (R(0.5) - worn * (R(1) / R(6) - worn * (R(1) / R(24) - worn / R(120))))
        : -r_expm1(-worn) / worn;
    if (duration <= R(0)) {
        return log_age;
    }
    return r_log(r_exp(log_age - worn) + duration * (REFERENCE_VELOCITY / SLIP_DISTANCE) * share);
#else
    if (duration <= R(0) || way <= R(0)) {
        return log_age;
    }
    return log_age * r_exp(-worn)
        + r_log(way / (duration * REFERENCE_VELOCITY)) * r_expm1(-worn);
#endif
}

static real exponent(real log_age)
{
    return (R(1) + EVOLUTION_EFFECT * log_age) / DIRECT_EFFECT;
}
#if YIELDS

/* ln(1 + e^x). */
static real raised(real x)
{
    return (x > R(0) ? x : R(0)) + r_log1p(r_exp(-r_fabs(x)));
}

/* Force in units of a of a spring in series with such friction, after a way and a creep in units
 * of their yielding: Riccati's equation, solved in logarithms. `late` is the share of a change of
 * age over the step that counts. */
static real stretched(real z, real way, real creep, real exponent_, real *late)
{
    const real slow = r_exp(-exponent_) * creep, whole = r_hypot(way, R(2) * slow);
    real goal = R(0), log_gone, below, grown, over, under;
    if (way > R(0)) {
        goal = arcsinh_of_exp(r_log(way / (creep * R(2))) + exponent_);
    }
    *late = R(1);
    if (r_log(creep) - exponent_ > R(100) || r_log(way) > R(100)) {
        return goal;
    }
    *late = whole < R(1e-2) ? R(0.5) + whole / R(12)
        : -R(1) / r_expm1(-whole) - R(1) / whole;
    if (creep <= R(0)) {
        return z + way;
    }
    /* In logarithms, for a creep at rest is less than a float can be. */
    if (whole > R(1e-3)) {
        log_gone = r_log(-r_expm1(-whole));
    } else {
        log_gone = whole * (whole / R(24) - R(0.5))
            + (way > R(0) ? r_log(whole) : LN_2 + r_log(creep) - exponent_);
    }
    below = z - goal;
    grown = r_log1p(r_exp(-whole - R(2) * goal));
    over = grown + raised(-R(2) * goal + log_gone - below - grown);
    under = raised(-R(2) * goal + whole) - whole;
    under += raised(below + log_gone - under);
    return z + over - under;
}
#endif

static real law_step(stiction_state *s, const motion *m)
{
#if YIELDS
    const real z = s->law.force / DIRECT, side = m->displacement < R(0) ? R(-1) : R(1);
    const real way = m->displacement * side / YIELDING;
    const real creep = m->dt * REFERENCE_VELOCITY / YIELDING;
    real counted = s->law.log_age, log_age = counted, end = z, late;
    int k;
    /* The age changes on the way: predicted, then taken from where it counts. */
    for (k = 0; k < 2; ++k) {
        end = side * stretched(z * side, way, creep, exponent(counted), &late);
        log_age = aged(s->law.log_age, r_fabs(m->displacement - YIELDING * (end - z)), m->dt);
        counted = s->law.log_age + (log_age - s->law.log_age) * late;
    }
    s->law.log_age = log_age;
    s->law.force = DIRECT * end;
    return s->law.force * LEVEL;
#else
    const real still = m->velocity == R(0) ? REFERENCE_VELOCITY : r_fabs(m->velocity);
    real size;
    s->law.log_age = aged(s->law.log_age, r_fabs(m->displacement), m->dt);
    size = DIRECT * arcsinh_of_exp(r_log(still / (R(2) * REFERENCE_VELOCITY))
                                   + exponent(s->law.log_age)) * LEVEL;
    if (m->velocity == R(0)) {
        return held(m->effort, size);
    }
    return m->velocity > R(0) ? size : -size;
#endif
}
#if not YIELDS
#ifdef MACHINE

/* Velocity at which arsinh(v/(2*v_0)*e^q) is z. */
static real velocity_of(real z, real q)
{
    return REFERENCE_VELOCITY * (r_exp(z - q) - r_exp(-z - q));
}

/* Mean friction over a step that ends at z, in units of a: of a motion that its own inertia carries
 * the mean of both ends, of one that friction holds what is at its end. */
static real mean_friction(real z, real old, real heavy, real q)
{
    const real momentum = r_fabs(heavy * velocity_of(z, q)), change = z - old;
    const real weight = R(0.5) * momentum / (momentum + R(1));
    return z - weight * change / r_sqrt(R(1) + R(0.25) * change * change);
}

/* Where a step takes the body whose contact ends it at this age: J*(v1 - v0) = h*(E - F), F the
 * mean friction, solved for the friction at the end, which rises too steeply from rest to be
 * linearised. */
static void law_arrive(real log_age, real level, real drag, real v, real friction, real effort,
                       real h, real *velocity, real *displacement)
{
    const real half = R(0.5) * drag * h, direct = DIRECT * level;
    const real impulse = (INERTIA - half) * v + h * effort, q = exponent(log_age);
    const real heavy = (INERTIA + half) / (h * direct), wanted = impulse / (h * direct);
    const real old = (friction - v * drag) / direct;
    real low, high, z, changed, pace;
    int k;
    *velocity = impulse / (INERTIA + half);
    *displacement = R(0.5) * h * (v + *velocity);
    if (!(h * direct > R(1e-150) * INERTIA) || r_log(heavy * REFERENCE_VELOCITY) - q > R(60)) {
        return;
    }
    high = r_fabs(wanted) + R(1);
    z = arcsinh_of_exp(r_log(high / (R(2) * heavy * REFERENCE_VELOCITY)) + q);
    high = z < high ? z : high;
    low = R(0);
    for (k = 0; k < 200 && wanted != R(0) && high - low > R(1e-16) * high; ++k) {
        const real size = R(0.5) * (low + high);
        real excess;
        z = wanted < R(0) ? -size : size;
        excess = heavy * velocity_of(z, q) + mean_friction(z, old, heavy, q) - wanted;
        if (wanted < R(0) ? excess < R(0) : excess > R(0)) {
            high = size;
        } else {
            low = size;
        }
    }
    z = wanted < R(0) ? -low : low;
    *velocity = velocity_of(z, q);
    if (heavy * r_fabs(*velocity) > R(1)) {
        *velocity = (wanted - mean_friction(z, old, heavy, q)) / heavy;
    }
    *displacement = R(0.5) * h * (v + *velocity);
    /* What a body brakes on its way to rest is done before the step ends. */
    changed = *velocity - v;
    pace = (effort - friction) / INERTIA;
    if (changed * v < R(0) && changed * pace > R(0) && r_fabs(changed) < r_fabs(pace) * h) {
        const real square = (z - old) * (z - old);
        *displacement += R(0.5) * (h - changed / pace) * square / (square + R(1)) * changed;
    }
}
#endif
#endif
