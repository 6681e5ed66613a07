/* See stiction_feedforward.c. */
# ifndef STICTION_FEEDFORWARD_H
# define STICTION_FEEDFORWARD_H
# ifndef STICTION_REAL
# define STICTION_REAL double
# endif
# ifdef __cplusplus
extern "C" {
# endif

#ifdef STEPS
@types@

/* A contact that was never moved. */
void stiction_init(stiction_state *s);
#ifdef POSITION
/* Puts the body where an encoder sees it, before a step; the contact does not move. */
void stiction_set_position(stiction_state *s, STICTION_REAL position);
#endif
/* Once per sample of dt, over which the velocity is held. Returns the friction at its end,
 * positive when it resists positive motion, less the efforts that effects add. effort: all else
 * that acts on the body, gravity included, positive along +x; at velocity 0 a contact with true
 * stick returns it, up to break-away. load: the part of it that loads the contact from outside.
 * A NaN that is passed stays in the state until stiction_init. */
STICTION_REAL stiction_step(stiction_state *s, STICTION_REAL velocity, STICTION_REAL dt,
                            STICTION_REAL effort, STICTION_REAL load, STICTION_REAL temperature);

#endif
/* Effort that friction takes in steady motion at a speed. */
STICTION_REAL stiction_friction(STICTION_REAL velocity);
/* Effort that holds the machine at rest at a position. */
STICTION_REAL stiction_place(STICTION_REAL position);
/* Effort for a reference. */
STICTION_REAL stiction_feedforward(STICTION_REAL velocity, STICTION_REAL acceleration,
                                   STICTION_REAL position);
/* The input of the drive for an effort. */
STICTION_REAL stiction_input(STICTION_REAL effort);
#if HANGS
/* Effort of gravity, positive along +x. */
STICTION_REAL stiction_gravity(STICTION_REAL position);
#endif

typedef struct {
    STICTION_REAL bandwidth, velocity, disturbance;
} stiction_observer;
/* bandwidth in rad/s. */
void stiction_observer_init(stiction_observer *o, STICTION_REAL bandwidth, STICTION_REAL velocity);
/* Once a sample of dt: the input that was held over it, the velocity at its end and the friction of
 * the model; what acts beside these on the body, positive along +x. What else is known, such as
 * gravity, is taken off the friction. */
STICTION_REAL stiction_observe(stiction_observer *o, STICTION_REAL input, STICTION_REAL velocity,
                               STICTION_REAL friction, STICTION_REAL dt);
# ifdef __cplusplus
}
# endif
# endif
