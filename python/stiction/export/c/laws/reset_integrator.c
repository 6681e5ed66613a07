/* A bond that stretches, tears and is dragged along until the motion turns: Haessig, Friedland,
 * J. Dyn. Syst. Meas. Control 113 (1991). */
#let LIMIT = BREAKAWAY / INITIAL_STIFFNESS
#let DRAGGED = COULOMB
#let SLIDING = BREAKAWAY
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = DAMPING + VISCOUS
#include "bond.c"
