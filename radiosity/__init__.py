"""Diffuse global illumination, bounce by bounce.

Light that leaves a diffuse surface obeys B = E + ρ F B. This package cuts a scene into patches, finds the
form factors F between them, and sums the Neumann series B = E + T E + T² E + …, T = ρ F, whose order k is
the light that has bounced exactly k times. ``import radiosity as rad`` gives every public name; what a name
needs is loaded when it is first used.
"""

import lazy_loader

# The list of public names is the stub beside this file, so that editors and type checkers read the same list.
# `form_factors` and `solve` are functions, and also the names of the package and the module that they live in;
# lazy_loader keeps the function under the name, whichever of the two is imported first.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
