/* (1 - exp(-z))/z and what is left of it over z: phi_1 and phi_2 of exponential integrators. */
static real second_mean(real z)
{
    if (z < R(0.01)) {
        return R(0.5) - z * (R(1) / R(6) - z * (R(1) / R(24) - z * (R(1) / R(120)
               - z / R(720))));
    }
    return (R(1) + r_expm1(-z) / z) / z;
}

static real first_mean(real z)
{
    return z < R(0.01) ? R(1) - z * second_mean(z) : -r_expm1(-z) / z;
}
