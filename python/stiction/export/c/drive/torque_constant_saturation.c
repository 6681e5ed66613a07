/* Effort per input that is lost at large inputs. */
static real torque_constant_saturation_input(const stiction_state *s, real input, real velocity)
{
    const real ratio = input / torque_constant_saturation_INPUT;
    (void)s;
    (void)velocity;
    return input - torque_constant_saturation_LOSS * ratio * ratio * input;
}
