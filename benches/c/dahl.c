/* One trajectory of a body on Dahl's curve of exponent 2, as fast as plain C gets: see hsieh_pan.c.
 * The same step as the core's, two to a sample; the power and its integral are a quotient here.
 */
#include <math.h>
#include <stddef.h>

#include "reference.h"

#define F_C 0.35
#define GAMMA 3000.0

#define PARTS 2
#define SPAN (DT / PARTS)
#define HALF (0.5 * SPAN)
#define PER_INERTIA (1.0 / INERTIA)

void dahl(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2])
{
    double x = 0.0, v = 0.0, dry = 0.0;
    for (size_t k = 0; k < samples; k++) {
        double u = effort[k];
        for (int part = 0; part < PARTS; part++) {
            double net = u - dry;
            double displacement = SPAN * v + (SPAN * HALF * PER_INERTIA) * net;
            double unbraked = v + (HALF * PER_INERTIA) * (net + u);
            double s = copysign(1.0, displacement);
            double r = 1.0 - dry * s * (1.0 / F_C);
            dry = (1.0 - r / (1.0 + fabs(displacement) * (GAMMA / F_C) * fabs(r))) * (F_C * s);
            v = unbraked - (HALF * PER_INERTIA) * dry;
            x += displacement;
        }
        position[k] = x;
        velocity[k] = v;
    }
    counted[0] = counted[1] = 0;
}
