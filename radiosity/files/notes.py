"""What a reader left out or replaced, collected while it reads and said once at its end."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field

from ..errors import RadiosityWarning, UnusedFeatureWarning


@dataclass
class Notes:
    """Collects remarks about a file.

    Attributes
    ----------
    unused : dict
        Feature → where it was met, for features that a diffuse solver does not use.
    replaced : list of str
        Sentences about what is taken otherwise than the file has it.
    exact : bool
        Whether this package wrote the file, so that the scene comes back as it was.
    """

    unused: dict[str, list[str]] = field(default_factory=dict)
    replaced: list[str] = field(default_factory=list)
    exact: bool = False

    def skip(self, feature: str, where: str) -> None:
        """A feature is not used."""
        places = self.unused.setdefault(feature, [])
        if where not in places:
            places.append(where)

    def say(self, sentence: str) -> None:
        """Something is taken otherwise than the file has it."""
        if sentence not in self.replaced:
            self.replaced.append(sentence)

    def warn(self, source: str) -> None:
        """Say everything in at most two warnings: one about unused features, one about replacements."""
        if self.unused:
            listed = "; ".join(f"{feature} ({_some(places)})" for feature, places in self.unused.items())
            message = f"{source}: not used by a diffuse solver: {listed}"
            warnings.warn(message, UnusedFeatureWarning, stacklevel=3)
        if self.replaced:
            warnings.warn(f"{source}: {'; '.join(self.replaced)}", RadiosityWarning, stacklevel=3)


def _some(places: list[str], limit: int = 4) -> str:
    shown = ", ".join(places[:limit])
    return shown + (f", … {len(places)} in all" if len(places) > limit else "")
