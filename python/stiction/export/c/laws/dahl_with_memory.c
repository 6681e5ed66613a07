/* Dahl's loop as the branch of a spring that remembers its reverse points. */
#let TOP = COULOMB
#let STEEPEST = INITIAL_STIFFNESS * 2**EXPONENT
#let SHAPE = 1 - EXPONENT
#let WEIGHT = [1.0] * 6
#let SLIDING = COULOMB
#define EXCHANGES
#let STIFFEST = STEEPEST
#let CALMS = VISCOUS
#include "yield_curve.c"
#include "iwan_spring.c"
