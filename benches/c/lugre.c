/* One trajectory of a body on LuGre's bristles, as fast as plain C gets: see hsieh_pan.c. The same
 * step as the core's, two to a sample: bristles that follow g over the path, velocity Verlet with
 * what the velocity at the end damps solved for.
 */
#include <math.h>
#include <stddef.h>

#include "exponential.h"
#include "reference.h"

#define SIGMA_0 3000.0
#define SIGMA_1 1.0
#define F_S 0.5
#define F_C (0.7 * F_S)
#define V_S 0.1

#define PARTS 2
#define SPAN (DT / PARTS)
#define HALF (0.5 * SPAN)
#define PER_INERTIA (1.0 / INERTIA)
#define INLINE static inline __attribute__((always_inline))

/* g and its slope by speed. */
INLINE double level(double v, double *steepness)
{
    double share = v * (1.0 / V_S), power = share * share;
    double left = fading(-power) * (F_S - F_C);
    *steepness = -2.0 * left * fabs(v) * (1.0 / (V_S * V_S));
    return F_C + left;
}

void lugre(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2])
{
    double x = 0.0, v = 0.0, bent = 0.0;
    double from = F_S, per_from = 1.0 / F_S;
    for (size_t k = 0; k < samples; k++) {
        double u = effort[k];
        for (int part = 0; part < PARTS; part++) {
            double unused;
            double net = u - (bent + SIGMA_1 * (v - bent * fabs(v) * per_from));
            double displacement = SPAN * v + (SPAN * HALF * PER_INERTIA) * net;
            double predicted = v + (SPAN * PER_INERTIA) * net;
            double steepness, to = level(predicted, &steepness), by_end = 0.0;
            double per_to = 1.0 / to;
            if (displacement != 0.0) {
                double s = displacement > 0.0 ? 1.0 : -1.0;
                double z = (SIGMA_0 * fabs(displacement)) * (0.5 * per_from + 0.5 * per_to);
                double gone = faded(-z);
                double share = z < 1e-5 ? 0.5 * z : 1.0 - gone * (1.0 / z);
                bent = (from + (to - from) * share + (bent * s - from) * (1.0 - gone)) * s;
                by_end = steepness * share;
            }
            double s = predicted > 0.0 ? 1.0 : predicted < 0.0 ? -1.0 : 0.0;
            double slips = bent * s * per_to, bends = 1.0 - slips;
            double turned = (by_end * per_to - slips * steepness * per_to) * s;
            double slope = by_end + SIGMA_1 * (bends - predicted * turned);
            double damping = slope > 0.0 ? slope : 0.0;
            double left = bent + SIGMA_1 * (predicted * bends) - damping * predicted;
            v = (INERTIA * v + HALF * (net + u - left)) / (INERTIA + HALF * damping);
            x += displacement;
            from = level(v, &unused);
            per_from = 1.0 / from;
        }
        position[k] = x;
        velocity[k] = v;
    }
    counted[0] = counted[1] = 0;
}
