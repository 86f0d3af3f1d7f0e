"""The arrays of form factors on two levels."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileFormatError
from ..form_factors.elements import senders_of
from ..form_factors.factors import check_shares, row_sums
from ..form_factors.groups import group_patches
from ..form_factors.levels import Levels, TwoLevelFactors
from ..form_factors.spot_check import SpotCheck
from ..form_factors.two_level import straight_to_new
from ..patches import Patches
from . import checked
from .checked import JSON
from .matrix_arrays import Reader, matrix_from_arrays, matrix_to_arrays, within


def levels_to_arrays(levels: Levels, prefix: str) -> Iterator[tuple[str, NDArray[Any]]]:
    """Name and array of what two levels are made of; the means follow from the patches and are not written."""
    yield from matrix_to_arrays(levels.exchange, f"{prefix}/exchange")
    yield from matrix_to_arrays(levels.spread, f"{prefix}/spread")
    yield f"{prefix}/to_sky", levels.to_sky
    yield f"{prefix}/to_backs", levels.to_backs
    yield f"{prefix}/emits", levels.emits
    yield f"{prefix}/smooth", levels.smooth


def check_to_arrays(check: SpotCheck, prefix: str) -> Iterator[tuple[str, NDArray[Any]]]:
    """Name and array of what a spot check is made of."""
    yield f"{prefix}/patch", check.patch
    for number, rows in enumerate(check.rows):
        yield from matrix_to_arrays(rows, f"{prefix}/{number}")
    yield f"{prefix}/to_sky", check.to_sky


def levels_from_arrays(
    reader: Reader, patches: Patches, header: JSON, estimator: object, prefix: str
) -> TwoLevelFactors:
    """Form factors on two levels of an archive, checked.

    Raises
    ------
    FileFormatError
    """
    levels = _levels(reader, patches, checked.integer(header, "group", prefix, low=2), f"{prefix}/levels")
    to_sky, to_backs = (reader.take(f"{prefix}/{name}", "<f8", "N") for name in ("to_sky", "to_backs"))
    exact = reader.take(f"{prefix}/exact_columns", "|b1", "N") if header.get("exact_columns") else None
    factors = TwoLevelFactors(
        levels,
        to_sky,
        to_backs,
        patches.area,
        patches.surface,
        patches.surface_names,
        estimator,
        checked.mapping(header, "statistics", prefix),
        exact,
        None if estimator is None else straight_to_new,
        _check(reader, patches, f"{prefix}/check") if header.get("check") else None,
    )
    try:
        check_shares(factors.gather(np.ones(len(patches))), to_sky, to_backs)
    except ValueError as error:
        raise FileFormatError(f"{prefix}: {error}") from error
    return factors


def _check(reader: Reader, patches: Patches, prefix: str) -> SpotCheck:
    patch = reader.take(f"{prefix}/patch", "<i8", "k")
    within(f"{prefix}/patch", patch, len(patches))
    first, second = (matrix_from_arrays(reader, f"{prefix}/{number}", len(patch), len(patches)) for number in range(2))
    to_sky = reader.take(f"{prefix}/to_sky", "<f8", "2k")
    for name, values in (("0", first.data), ("1", second.data), ("to_sky", to_sky)):
        if values.size and values.min() < 0.0:
            raise FileFormatError(f"{prefix}/{name} holds a negative share")
    try:
        for rows, sky in zip((first, second), to_sky, strict=True):
            check_shares(row_sums(rows), sky, np.zeros_like(sky))
    except ValueError as error:
        raise FileFormatError(f"{prefix}: {error}") from error
    return SpotCheck(patch, (first, second), to_sky)


def _levels(reader: Reader, patches: Patches, side: int, prefix: str) -> Levels:
    groups = group_patches(patches, side)
    smooth = reader.take(f"{prefix}/smooth", "|b1", "G")
    if len(smooth) != len(groups):
        raise FileFormatError(f"{prefix}/smooth has {len(smooth)} entries; the patches make {len(groups)} groups")
    senders = senders_of(groups, smooth)
    to_sky, to_backs = (reader.take(f"{prefix}/{name}", "<f8", "Q") for name in ("to_sky", "to_backs"))
    emits = reader.take(f"{prefix}/emits", "|b1", "X")
    if len(emits) != len(senders):
        raise FileFormatError(f"{prefix}/emits has {len(emits)} entries; there are {len(senders)} senders")
    exchange = matrix_from_arrays(reader, f"{prefix}/exchange", len(to_sky), len(emits))
    spread = matrix_from_arrays(reader, f"{prefix}/spread", len(patches), len(to_sky) + len(emits))
    for name, values in (
        ("exchange", exchange.data),
        ("spread", spread.data),
        ("to_sky", to_sky),
        ("to_backs", to_backs),
    ):
        if values.size and values.min() < 0.0:
            raise FileFormatError(f"{prefix}/{name} holds a negative share")
    means = senders.means(patches.area, exchange.dtype.type)
    return Levels(means, exchange, spread, senders.of_patch, emits, to_sky, to_backs, smooth, side)
