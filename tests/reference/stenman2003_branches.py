"""The valve of Stenman et al. (2003): it jumps to OP or stays."""

import math


def stenman2003_branches(op, d, x0):
    """Return the positions; while OP is missing they hold."""
    position = [x0]
    for u in op:
        stays = math.isnan(u) or abs(u - position[-1]) <= d
        position.append(position[-1] if stays else u)
    return position[1:]
