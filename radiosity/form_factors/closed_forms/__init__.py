"""Form factors in closed form: plain functions to check solvers with, and to calculate with.

Sources are J. R. Howell's catalogue (A Catalog of Radiation Heat Transfer Configuration Factors, 3rd edition,
http://www.thermalradiation.net; "C-11" is its section C, number 11) and the papers it draws on. The formulas are
rearranged where the printed ones subtract nearly equal numbers: results keep nearly all their digits at every ratio
of the lengths, and tend to the right limits.

Factors are from the first-named surface to the second, F_12; the share that the other sends back is F_21 = A_1 F_12
/ A_2. Lengths are in any unit, the same for all. Surfaces are diffuse, and nothing is between them.
"""

from .elements import (
    element_to_parallel_disk,
    element_to_parallel_rectangle,
    element_to_perpendicular_disk,
    element_to_perpendicular_rectangle,
    element_to_sphere,
)
from .rectangles import (
    parallel_rectangles,
    parallel_rectangles_offset,
    perpendicular_rectangles,
    perpendicular_rectangles_offset,
)
from .round_bodies import (
    ConcentricFactors,
    ConeFactors,
    CylinderFactors,
    coaxial_cylinders,
    coaxial_disk_to_sphere,
    coaxial_disks,
    concentric_spheres,
    cone_interior,
    cylinder_interior,
    sphere_interior,
    sphere_to_coaxial_disk,
    sphere_to_rectangle,
    spherical_cap_interior,
)
from .strips import (
    crossed_strings,
    cylinder_to_strip,
    long_triangular_duct,
    parallel_cylinders,
    parallel_strips,
    perpendicular_strips,
    strips_in_a_wedge,
)

__all__ = [
    "ConcentricFactors",
    "ConeFactors",
    "CylinderFactors",
    "coaxial_cylinders",
    "coaxial_disk_to_sphere",
    "coaxial_disks",
    "concentric_spheres",
    "cone_interior",
    "crossed_strings",
    "cylinder_interior",
    "cylinder_to_strip",
    "element_to_parallel_disk",
    "element_to_parallel_rectangle",
    "element_to_perpendicular_disk",
    "element_to_perpendicular_rectangle",
    "element_to_sphere",
    "long_triangular_duct",
    "parallel_cylinders",
    "parallel_rectangles",
    "parallel_rectangles_offset",
    "parallel_strips",
    "perpendicular_rectangles",
    "perpendicular_rectangles_offset",
    "perpendicular_strips",
    "sphere_interior",
    "sphere_to_coaxial_disk",
    "sphere_to_rectangle",
    "spherical_cap_interior",
    "strips_in_a_wedge",
]
