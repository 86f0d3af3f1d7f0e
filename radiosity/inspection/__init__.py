"""What is difficult about a scene's geometry, all of it at once, in words; and normals that face the right way."""

from ..finding import Finding as Finding
from ..finding import listed as listed
from .inspect import findings as findings
from .normals import fixed_normals as fixed_normals
