/* Distance slid of a displacement: beyond a window about an anchor that is dragged behind. */
static real slid(real *offset, real displacement, real window)
{
    const real left_behind = *offset - displacement;
    *offset = left_behind > window ? window : left_behind < -window ? -window : left_behind;
    return r_fabs(*offset - left_behind);
}
