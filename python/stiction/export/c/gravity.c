#if HANGS

/* Effort of gravity, positive along +x: what rests has to bear it, so that it is part of `effort`
 * and of `load` of stiction_step, and it is known beside the input of stiction_observe. */
STICTION_REAL stiction_gravity(STICTION_REAL position)
{
#if GRAVITY != 0
    return -WEIGHT_FORCE - GRAVITY * r_sin(position - GRAVITY_ZERO);
#else
    (void)position;
    return -WEIGHT_FORCE;
#endif
}
#endif
