"""Named errors and warnings: what was found, where, the number, and what to do about it.

Every error that the package raises on purpose derives from `RadiosityError` and from the built-in
exception a reader would expect (`ValueError` for bad values, `OSError` for files, …), so that both
``except rad.RadiosityError`` and ``except ValueError`` work.
"""

from __future__ import annotations


class RadiosityError(Exception):
    """Base of all errors that the package raises on purpose."""


class SceneError(RadiosityError, ValueError):
    """A scene as a whole cannot be used: empty, mixed channel counts, two surfaces of one name."""


class MaterialError(SceneError):
    """A material holds a value that no surface can have."""


class GeometryError(SceneError):
    """A mesh holds coordinates or indices that are not a surface."""


class FileFormatError(RadiosityError, ValueError):
    """A file is not what its name says, is damaged, or holds what its format forbids."""


class MissingFileError(RadiosityError, FileNotFoundError):
    """A file, or the folder to write into, is not there."""


class OutputError(RadiosityError, OSError):
    """A file could not be written: no room, no permission, something in the way. What was there before still is."""


class FormFactorError(RadiosityError, ValueError):
    """Form factors are not a light exchange: NaN, negative, row sums over one, wrong shape."""


class OccludedSceneError(RadiosityError, ValueError):
    """Exact unoccluded factors were asked of a scene in which surfaces hide each other."""


class MemoryLimitError(RadiosityError, MemoryError):
    """The work would need more memory than it may use; the message says how much and the ways out."""


class WorkerLostError(RadiosityError, RuntimeError):
    """A worker process or machine was lost again and again at the same work."""


class SolverError(RadiosityError, ValueError):
    """A system cannot be solved as posed."""


class NoSteadyState(SolverError):
    """Light is put into an enclosure that absorbs none: it grows for ever."""


class MissingDependencyError(RadiosityError, ImportError):
    """An optional package is needed; the message says which to install."""


class DisplayError(RadiosityError, RuntimeError):
    """No picture can be drawn on this machine; the message says what to install."""


class RadiosityWarning(UserWarning):
    """Base of the package's warnings."""


class UnusedFeatureWarning(RadiosityWarning):
    """A file holds features that a diffuse solver does not use."""


class GeometryWarning(RadiosityWarning):
    """A mesh holds something harmless that is left out, or suspicious that is kept."""


class FormFactorWarning(RadiosityWarning):
    """Form factors were changed, or are wrong, by more than their sampling error explains."""


class UnlitSceneWarning(RadiosityWarning):
    """Nothing in a scene emits, and neither does the sky: everything will be black."""


class CheckpointWarning(RadiosityWarning):
    """What a checkpoint holds is damaged, or belongs to other work: it is computed again."""


class AccuracyWarning(RadiosityWarning):
    """An accuracy that was asked for has not been reached; the message says how far, and what to do."""


class ParameterError(RadiosityError, ValueError):
    """A parameter of a method is outside what it can work with."""
