"""A Preisach plane by play operators: the relays of width w are parted at P_{w/2}[ζ].

(Krasnosel'skii and Pokrovskii.) The density is integrated over the place of the relays in closed
form and over their width by the midpoint rule; no reverse point is remembered.
"""

import numpy as np
from tests.reference.golden import Golden

WIDTHS = 20_000
GOLDEN = Golden(
    reach=6e-4,
    speed=0.05,
    # The midpoint rule over 20 000 widths, with kinks where the memory has corners.
    share=1e-6,
    parameters={
        "coulomb": 0.35,
        "initial_stiffness": 3000.0,
        "edge_density": 2.0,
        "viscous": 0.05,
    },
)


def along(velocity, dt, *, coulomb, initial_stiffness, edge_density, viscous):
    """Friction at the end of each sample."""
    even = 1.0 / (2.0 + edge_density)
    edge = edge_density * even
    diagonal = 4.0 * even + 4.0 / 3.0 * edge
    reach = diagonal * coulomb / initial_stiffness
    step = 2.0 / WIDTHS
    radius = 0.5 * step * np.arange(0.5, WIDTHS)
    parted = np.zeros(WIDTHS)
    place, friction = 0.0, []
    for v in velocity:
        place = float(np.clip(place + v * dt / reach, -1.0, 1.0))
        parted = np.maximum(place - radius, np.minimum(place + radius, parted))
        # Relays below the parting point are on, those above are off.
        relays = 2.0 * np.sum(even * parted + edge * parted**3 / 3.0) * step
        friction.append(coulomb * (diagonal * place - relays) + viscous * v)
    return np.array(friction)
