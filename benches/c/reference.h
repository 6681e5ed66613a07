/* What the loops in C share: the machine of benches/lib.rs, as compile-time constants. */
#ifndef STICTION_REFERENCE_H
#define STICTION_REFERENCE_H

#include <stddef.h>

#define INERTIA 0.0076
#define DT 1e-4

/* From rest under these efforts; positions and velocities at the ends of the samples. `counted`
 * receives the numbers of break-aways and of sticks. */
void hsieh_pan(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2]);
void hsieh_pan_direct(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2]);
void lugre(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2]);
void coulomb(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2]);
void maxwell_slip(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2]);
void dahl(const double *restrict effort, size_t samples, double *restrict position,
    double *restrict velocity, long counted[2]);

#endif
