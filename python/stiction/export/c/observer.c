
/* What acts on the body beside the input and the friction of the model, positive along +x:
 *
 *     d' = w*(J*v' - gain*u + F - d)
 *
 * a filter of first order with the bandwidth w: Ohishi, Nakao, Ohnishi, Miyachi, IEEE Trans. Ind.
 * Electron. IE-34 (1987) 44-49; Chen, Ballance, Gawthrop, O'Reilly, IEEE Trans. Ind. Electron. 47
 * (2000) 932-938. Over a sample in which input, friction and disturbance are held it is solved
 * exactly (zero-order hold), and takes the change of the velocity and not its derivative:
 *
 *     d <- d + (1 - exp(-w*dt))*(J*(v - v_before)/dt - gain*u + F - d)
 */
void stiction_observer_init(stiction_observer *o, STICTION_REAL bandwidth, STICTION_REAL velocity)
{
    o->bandwidth = bandwidth;
    o->velocity = velocity;
    o->disturbance = R(0);
}

STICTION_REAL stiction_observe(stiction_observer *o, STICTION_REAL input, STICTION_REAL velocity,
                               STICTION_REAL friction, STICTION_REAL dt)
{
    if (dt > R(0)) {
        const real acting = INERTIA * (velocity - o->velocity) / dt - GAIN * input + friction;
        o->disturbance += (acting - o->disturbance) * -r_expm1(-o->bandwidth * dt);
    }
    o->velocity = velocity;
    return o->disturbance;
}
