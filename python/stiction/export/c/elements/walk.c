#include "spring.c"
/* Where a displacement leads, without doing it. */
static walked walk(const stiction_spring *spring, real displacement)
{
    walked end;
    end.way = spring->way;
    end.force = spring->force;
    end.kept = spring->points;
    end.turned = 0;
    end.direction = spring->direction;
    if (displacement == R(0)) {
        return end;
    }
    end.direction = displacement > R(0) ? 1 : -1;
    if (spring->direction == -end.direction) {
        end.turned = 1;
        end.way = R(0);
    }
    end.way += r_fabs(displacement);
    for (;;) {
        const int points = end.kept + end.turned;
        const real last = end.turned ? spring->way : points ? spring->widths[points - 1] : R(0);
        if (points >= 2 && end.way >= last) {
            end.way = spring->widths[points - 2] + (end.way - last);
            end.kept = points - 2;
            end.turned = 0;
#ifdef CLOSES_AT_MIRROR
        } else if (points == 1 && end.way >= R(2) * last) {
            end.way -= last;
            end.kept = 0;
            end.turned = 0;
#endif
        } else {
            break;
        }
    }
    if (end.kept + end.turned == 0) {
        end.force = (real)end.direction * virgin(spring, end.way);
    } else {
        const real from = end.turned ? spring->force : spring->forces[end.kept - 1];
        end.force = from + (real)end.direction * branch(spring, end.direction, end.way);
    }
    return end;
}
