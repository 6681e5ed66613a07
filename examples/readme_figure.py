"""The figure of the README: loops before the slip, and a mass pulled through a spring.

python examples/readme_figure.py [figure.png]
"""

import sys

from presliding_loops import ARC_SECOND, TURNS, walk
from stick_slip import pull

from stiction import plot


def draw():
    figure, (loops, slips) = plot.figure(1, 2, height=2.9)
    position, friction, turns = walk()
    loops.plot(position / ARC_SECOND, friction, color=plot.SIMULATED, linewidth=1.2)
    # Each turn once: the way back meets the same points.
    for letter, turn, (force, _) in zip("abcd", TURNS[1:5], turns, strict=False):
        loops.plot(turn, force, "o", color=plot.ACCENT, markersize=4)
        beside, align = ((-6, 2), "right") if turn > 0 else ((6, -9), "left")
        loops.annotate(
            letter, (turn, force), beside, textcoords="offset points", ha=align, fontsize=plot.TEXT
        )
    loops.set_xlabel("position (arcsec)")
    loops.set_ylabel("friction (N·m)")
    loops.set_title("Before the slip: loops close, points recur", fontsize=plot.TEXT, loc="left")

    speed = 0.1  # rad/s
    time, position, _, _ = pull(speed, 1.2)
    slips.plot(time, speed * time, color=plot.FAINT, linewidth=1.2, label="end of the spring")
    slips.plot(*plot.thinned(time, position), color=plot.SIMULATED, linewidth=1.4, label="mass")
    plot.legend(slips, loc="upper left")
    slips.set_xlabel("time (s)")
    slips.set_ylabel("position (rad)")
    slips.set_title("Pulled through a spring: stick-slip", fontsize=plot.TEXT, loc="left")
    return figure


if __name__ == "__main__":
    drawn = draw()
    if len(sys.argv) > 1:
        print("wrote", plot.save(drawn, sys.argv[1]))
