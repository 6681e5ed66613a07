typedef struct {
    STICTION_REAL force;
    STICTION_REAL way; /* from the last reverse point, or from where it was never moved */
    STICTION_REAL widths[STICTION_REVERSALS]; /* of the way that led to each reverse point */
    STICTION_REAL forces[STICTION_REVERSALS]; /* there */
#ifdef BOUNDED
    STICTION_REAL position;
#endif
    int points;
    int direction;
} stiction_spring;

/* A spring that remembers where it turned round: a branch from each reverse point, which is
 * forgotten, with the one before it, where its loop closes; the first one at its mirror (Masing).
 * Widths of ways are kept and no positions, so that a float loses nothing far from the start. */
typedef struct {
    real way, force;
    int kept, turned, direction;
} walked;

/* Where there are too many points, the two are forgotten that lie between loops most alike. */
static void forget_two(stiction_spring *spring)
{
    int k, at = 1;
    for (k = 2; k + 2 < STICTION_REVERSALS; ++k) {
        if (spring->widths[k] - spring->widths[k + 2]
            < spring->widths[at] - spring->widths[at + 2]) {
            at = k;
        }
    }
    spring->widths[at + 2] += spring->widths[at] - spring->widths[at + 1];
    for (k = at; k + 2 < STICTION_REVERSALS; ++k) {
        spring->widths[k] = spring->widths[k + 2];
        spring->forces[k] = spring->forces[k + 2];
    }
    spring->points -= 2;
}

static void accept(stiction_spring *spring, const walked *end)
{
    spring->points = end->kept;
    if (end->turned) {
        if (spring->points == STICTION_REVERSALS) {
            forget_two(spring);
        }
        spring->widths[spring->points] = spring->way;
        spring->forces[spring->points] = spring->force;
        spring->points += 1;
    }
    spring->way = end->way;
    spring->force = end->force;
    spring->direction = end->direction;
}
