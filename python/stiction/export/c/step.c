#ifdef SUMS

/* Kahan's sum: in floats, a long time is not to swallow its steps. */
static void add_up(stiction_sum *all, real more)
{
    const real next = more - all->rest, reached = all->value + next;
    all->rest = (reached - all->value) - next;
    all->value = reached;
}
#endif
#ifdef POSITION

void stiction_set_position(stiction_state *s, STICTION_REAL position)
{
    s->position.value = position;
    s->position.rest = R(0);
}
#endif

STICTION_REAL stiction_step(stiction_state *s, STICTION_REAL velocity, STICTION_REAL dt,
                            STICTION_REAL effort, STICTION_REAL load, STICTION_REAL temperature)
{
    motion it;
    const motion *const m = &it;
    real friction;
#ifdef EFFORTS
    real added = R(0);
#endif
    it.velocity = velocity;
    it.dt = dt;
    it.displacement = velocity * dt;
    it.effort = effort;
    it.load = load;
#ifdef TEMPERATURE
    it.temperature = temperature;
#else
    (void)temperature;
#endif
#ifdef POSITION
    add_up(&s->position, it.displacement);
#endif
#ifdef TIME
    add_up(&s->time, dt);
#endif
#ifdef PATH
    add_up(&s->path, r_fabs(it.displacement));
#endif
#each remember
    EFFECT_remember(s, m);
#end
#ifdef EFFORTS
#each effort
    added += EFFECT_effort(s, m);
#end
    it.effort += added;
#endif
#ifdef LEVELS
    it.level = R(1);
    it.viscous_level = R(1);
#each level
    it.level += EFFECT_level(s, m);
#end
#each viscous_level
    it.viscous_level += EFFECT_viscous_level(s, m);
#end
    it.level = it.level < R(0) ? R(0) : it.level;
    it.viscous_level = it.viscous_level < R(0) ? R(0) : it.viscous_level;
#endif
#each creep
    it.displacement -= EFFECT_creep(s, m);
#end
    friction = law_step(s, m);
#ifdef DRAGS
    friction += VISCOUS * VISCOUS_LEVEL * velocity;
#endif
    s->friction = friction;
#ifdef EFFORTS
    friction -= added;
#endif
    return friction;
}
