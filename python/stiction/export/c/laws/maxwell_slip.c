/* Parallel elasto-slide elements without number: Iwan, J. Appl. Mech. 33 (1966); Lampaert,
 * Al-Bender, Swevers, Physcon (2003). */
#let TOP = COULOMB
#let STEEPEST = INITIAL_STIFFNESS
#let SHAPE = YIELD_SHAPE
#let WEIGHT = [WEIGHT_1, WEIGHT_2, 1.0, WEIGHT_4, WEIGHT_5, WEIGHT_6]
#let SLIDING = COULOMB
#define EXCHANGES
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = VISCOUS
#include "yield_curve.c"
#include "iwan_spring.c"
