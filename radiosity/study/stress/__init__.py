"""Stiff and extreme cases: what is expected of each, what came, and whether that is the same.

A case of your own is a function that gives what it found, in a file for ``radiosity stress my_cases.py``:

>>> import radiosity as rad
>>> from radiosity.study.stress import case, within
>>> @case("a furnace at one part in a thousand", expected="B = E / α within 1e-6")
... def thousandth():
...     solution = rad.solve(rad.scenes.furnace(absorptance=1e-3), patch_count=24, solver=rad.Neumann(maxiter=20_000))
...     return within(solution.radiosity * 1e-3, 1.0, 1e-3)
>>> thousandth.run().verdict
'as expected'
"""

from .case import Case, Got, Outcome, case, refuses, truth, warns, within

__all__ = ["Case", "Got", "Outcome", "case", "refuses", "truth", "warns", "within"]
