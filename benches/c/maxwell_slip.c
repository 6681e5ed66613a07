/* One trajectory of a body on elasto-slide elements without number, yield points spread exponentially, as
 * fast as plain C gets: see hsieh_pan.c. The same step as the core's, one to a sample. Along a branch the
 * spring goes on from the step before where the way is short, else from its reverse point.
 */
#include <math.h>
#include <stddef.h>

#include "exponential.h"
#include "reference.h"

#define F_C 0.35
#define K_0 3000.0

#define D_0 (2.0 * F_C / K_0)
#define PER_D_0 (1.0 / D_0)
#define PER_INERTIA (1.0 / INERTIA)
#define HALF (0.5 * DT)
#define SERIES 0.02
#define SYNCHRONISED 256
#define POINTS 4096

#define LIKELY(c) __builtin_expect(!!(c), 1)
#define UNLIKELY(c) __builtin_expect(!!(c), 0)
#define INLINE static inline __attribute__((always_inline))
#define COLD static __attribute__((noinline))

typedef struct {
    double position, force;
} Point;

/* The branch: its direction, where it begins and closes (times the direction), its size. */
typedef struct {
    double at, force, slope;
    double way, origin, origin_force, target, per_distance, stretch, scale;
    int since, points;
    Point point[POINTS];
} Spring;

COLD void adopt(Spring *sp)
{
    int first = sp->points == 0;
    Point anchor = first ? (Point){0.0, 0.0} : sp->point[sp->points - 1];
    sp->origin = anchor.position;
    sp->origin_force = anchor.force;
    sp->target = first ? INFINITY
        : sp->points == 1 ? -anchor.position * sp->way
                          : sp->point[sp->points - 2].position * sp->way;
    sp->per_distance = (first ? 2.0 : 1.0) * PER_D_0 * sp->way;
    sp->stretch = (first ? 2.0 : 1.0) * sp->way;
    sp->scale = (first ? 0.5 : 1.0) * sp->way;
}

/* The present branch, from its reverse point. */
INLINE void afresh(double origin, double origin_force, double stretch, double scale, double at,
    double *force, double *slope)
{
    double gone = faded(-((at - origin) * stretch * PER_D_0));
    *force = origin_force + (K_0 * D_0) * gone * scale;
    *slope = K_0 - K_0 * gone;
}

/* A way that turns round or closes loops. */
COLD void walk(Spring *sp, double moved)
{
    double way = moved > 0.0 ? 1.0 : moved < 0.0 ? -1.0 : sp->way, at = sp->at + moved;
    int added = way != sp->way && sp->way != 0.0, kept = sp->points;
    for (;;) {
        double target;
        int wiped;
        if (added) {
            target = kept == 0 ? -sp->at : sp->point[kept - 1].position;
            wiped = kept != 0;
        } else if (kept == 0) {
            break;
        } else {
            target = kept == 1 ? -sp->point[0].position : sp->point[kept - 2].position;
            wiped = kept == 1 ? 1 : 2;
        }
        if (way * (at - target) < 0.0) break;
        kept -= wiped;
        added = 0;
    }
    if (added) sp->point[kept] = (Point){sp->at, sp->force};
    sp->points = kept + added;
    sp->way = way;
    sp->at = at;
    sp->since = 0;
    adopt(sp);
    if (way != 0.0) {
        afresh(sp->origin, sp->origin_force, sp->stretch, sp->scale, at, &sp->force, &sp->slope);
    }
}

void maxwell_slip(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2])
{
    static Spring springs[1];
    Spring *sp = springs;
    *sp = (Spring){0};
    sp->slope = K_0;
    adopt(sp);
    double x = 0.0, v = 0.0;
    for (size_t k = 0; k < samples; k++) {
        double at = sp->at, force = sp->force, slope = sp->slope, displacement = 0.0;
        double way = sp->way, target = sp->target, per_distance = sp->per_distance;
        double origin = sp->origin, origin_force = sp->origin_force;
        double stretch = sp->stretch, scale = sp->scale;
        int since = sp->since, plain = 1;
        for (; k < samples; k++) {
            double net = effort[k] - force;
            displacement = DT * v + (DT * HALF * PER_INERTIA) * net;
            double next = at + displacement, z = displacement * per_distance;
            plain = z > 0.0 && next * way < target;
            if (UNLIKELY(!plain)) break;
            v += (HALF * PER_INERTIA) * (net + effort[k]);
            if (LIKELY(z < SERIES && since < SYNCHRONISED - 1)) {
                double near = 0.499999999998275 - z * 0.16666666390556875;
                double far = 0.0416659759297064 - z * 0.008278000311740141;
                double square = z * z, bent = (slope * displacement) * z;
                double fallen = slope * z, eased = fallen * z;
                force = ((force + displacement * slope) - bent * near) - (bent * square) * far;
                slope = ((slope - fallen) + eased * near) + (eased * square) * far;
                since++;
            } else {
                afresh(origin, origin_force, stretch, scale, next, &force, &slope);
                since = 0;
            }
            v -= (HALF * PER_INERTIA) * force;
            at = next;
            position[k] = x += displacement;
            velocity[k] = v;
        }
        sp->at = at;
        sp->force = force;
        sp->slope = slope;
        sp->since = since;
        if (k == samples) break;
        double net = effort[k] - force;
        walk(sp, displacement);
        v = (v + (HALF * PER_INERTIA) * (net + effort[k])) - (HALF * PER_INERTIA) * sp->force;
        position[k] = x += displacement;
        velocity[k] = v;
    }
    counted[0] = counted[1] = 0;
}
