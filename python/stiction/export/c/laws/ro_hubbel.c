/* Micro and macro dynamics about a reference position: Ro, Hubbel (1993), by eqs. (2) to (4) of
 * Hsieh, Pan, Wear 242 (2000). */
#let LIMIT = COULOMB / INITIAL_STIFFNESS
#let DRAGGED = COULOMB
#let SLIDING = COULOMB
#let STIFFEST = INITIAL_STIFFNESS
#let CALMS = DAMPING + VISCOUS
#include "bond.c"
