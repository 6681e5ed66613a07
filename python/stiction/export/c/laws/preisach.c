/* Relays on a bounded Preisach plane, by the integral of their density over triangles (Everett):
 * Mayergoyz, Mathematical Models of Hysteresis (1991). */
#let EVENLY = 1 / (2 + EDGE_DENSITY)
#let AT_EDGE = EDGE_DENSITY / (2 + EDGE_DENSITY)
#let WHOLE = 4 * EVENLY + 4 * AT_EDGE / 3
#let HALF = WHOLE * COULOMB / INITIAL_STIFFNESS
#let SLIDING = COULOMB
#define EXCHANGES
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = VISCOUS

/* Force from a reverse point over the way 2*h, its middle at m, both as shares of HALF. */
static real risen(real middle, real h)
{
    const real mm = middle * middle, hh = h * h;
    return COULOMB * (WHOLE * h * R(2) - EVENLY * hh * R(4)
                      - AT_EDGE * hh * (mm * R(4) + hh * (R(2) / R(3))));
}
#define CLOSES_AT_MIRROR
#define BOUNDED
#define virgin(spring, way) (R(0.5) * risen(R(0), (way) / HALF))
#define branch(spring, direction, way) \
    risen(((spring)->position * (real)(direction) - R(0.5) * (way)) / HALF, R(0.5) * (way) / HALF)
#include "walk.c"
typedef stiction_spring stiction_law;

static real law_step(stiction_state *s, const motion *m)
{
    stiction_spring *contact = &s->law;
    const real before = contact->position;
    walked end;
    contact->position += m->displacement;
    if (r_fabs(contact->position) >= HALF) {
        contact->position = contact->position > R(0) ? HALF : -HALF;
    }
    end = walk(contact, contact->position - before);
    accept(contact, &end);
    return contact->force * LEVEL;
}
