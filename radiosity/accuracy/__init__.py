"""Light to a stated accuracy: patches, rays and bounces chosen so that three errors together stay below it.

    total = √(sampling² + discretisation²) + truncation

relative to B - E, area-weighted L2 over patch means and channels: the first two are independent of each other.
Sampling comes from the spread of independent replicates, which together are the answer. Discretisation comes from the
gap between the light of patches and that of the same patches put together two by two along each edge, **by the same
rays**: the coarse form factors are sums of the fine ones, so that the gap costs no ray, and most of the sampling error
drops out of it. Truncation is what a geometric series would still add.
"""

from .result import Accuracy, Trial
from .search import Found, light_to

__all__ = ["Accuracy", "Found", "Trial", "light_to"]
