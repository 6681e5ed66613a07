static real between(const STICTION_REAL *x, const STICTION_REAL *y, int n,
                             STICTION_REAL at)
{
    int low = 0, high = n - 1;
    if (at <= x[0]) {
        return y[0];
    }
    if (at >= x[high]) {
        return y[high];
    }
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (x[middle] <= at) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return y[low] + (y[high] - y[low]) * (at - x[low]) / (x[high] - x[low]);
}

/* Effort that friction takes at a speed; between the slowest speeds of both directions a line. */
STICTION_REAL stiction_friction(STICTION_REAL velocity)
{
    return between(SPEED_AT, FRICTION_AT, SPEEDS, velocity);
}

/* Effort that holds the machine at rest at a position. */
STICTION_REAL stiction_place(STICTION_REAL position)
{
    const STICTION_REAL turn = PLACE_AT[PLACES - 1];
    if (turn > R(0)) {
        const STICTION_REAL turns = position / turn;
        long whole = (long)turns;
        if ((STICTION_REAL)whole > turns) {
            whole -= 1;
        }
        position -= turn * (STICTION_REAL)whole;
    }
    return between(PLACE_AT, EFFORT_AT, PLACES, position);
}

/* Effort for a reference. */
STICTION_REAL stiction_feedforward(STICTION_REAL velocity, STICTION_REAL acceleration,
                                   STICTION_REAL position)
{
    return INERTIA * acceleration + stiction_friction(velocity) + stiction_place(position);
}

/* The input of the drive for that effort. */
STICTION_REAL stiction_input(STICTION_REAL effort)
{
    return effort / GAIN;
}
