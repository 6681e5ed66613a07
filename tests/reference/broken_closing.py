"""Tiny reverse-point springs: one correct, three with a wrong closing rule.

They exist to show that a comparison with the ladder notices a wrong closing rule. The
rule of the correct one (Hsieh and Pan, Wear 242 (2000) 1-17, section 2.2.4, property ii):
a branch that reaches the reverse point before last, where an older branch of the same
direction was left, closes a loop. Both points of the loop are forgotten and motion goes on
along that older branch. With one point left under Masing's rule the target is the mirror
image of that point, and beyond it lies the virgin curve.
"""

from __future__ import annotations

from .ladder_spring import branch_force, virgin_force

WRONG_RULES = ("one point popped", "never", "no mirror")


class ReversePointSpring:
    """Masing spring that remembers its reverse points in a list.

    Parameters
    ----------
    closing : {"correct", "one point popped", "never", "no mirror"}
        "one point popped" forgets only the newer point of a closed loop and leaves a new
        branch at the older one; "never" goes on along the newest branch for ever; "no
        mirror" closes loops, but never returns to the virgin curve.
    """

    def __init__(self, *, initial_stiffness, final_stiffness, decay_distance, closing="correct"):
        if closing not in ("correct", *WRONG_RULES):
            raise ValueError(f"unknown closing rule {closing!r}")
        self.curve = (initial_stiffness, final_stiffness, decay_distance)
        self.closing = closing
        self.points = []  # (displacement, force), oldest first
        self.direction = 0
        self.displacement = 0.0

    def force(self):
        if not self.points:
            return float(virgin_force(self.displacement, *self.curve))
        x_r, f_r = self.points[-1]
        s = self.direction
        return f_r + s * float(branch_force(s * (self.displacement - x_r), *self.curve))

    def _has_closed(self):
        """Whether the present branch has reached its target."""
        if not self.points or self.closing == "never":
            return False
        if len(self.points) == 1:
            if self.closing == "no mirror":
                return False
            target = -self.points[0][0]
        else:
            target = self.points[-2][0]
        return self.direction * (self.displacement - target) >= 0.0

    def advance(self, dx):
        """Make the move dx and return the force at its end."""
        if dx == 0.0:
            return self.force()
        direction = 1 if dx > 0.0 else -1
        if self.direction and direction != self.direction:
            self.points.append((self.displacement, self.force()))
        self.direction = direction
        self.displacement += dx
        while self._has_closed():
            if self.closing == "one point popped":
                # With its points out of step the next target is passed already; stop here.
                self.points.pop()
                break
            del self.points[-2:]
        return self.force()
