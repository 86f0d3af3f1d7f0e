"""All solvers on all built-in scenes, with sampled form factors: one answer, and one set of orders."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import radiosity as rad
from radiosity.errors import FormFactorWarning
from radiosity.scenes import BUILT_IN
from radiosity.solvers.rooms import find_rooms
from tests.solvers.table import RAW, SOLVERS


def factors_of(scene, patch_count, **parameters):
    """Patches and raw factors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rad.errors.GeometryWarning)  # more faces than patches asked for
        patches = rad.subdivide(scene, patch_count=patch_count)
    return patches, rad.form_factors(patches, rad.MonteCarlo(rays=64, **parameters))


def conserved(factors):
    """Few rays and coarse patches: corrections that are to be expected here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormFactorWarning)
        return factors.conserved()


SMALLER = {"lit_sphere": lambda: rad.scenes.lit_sphere(subdivisions=2)}  # 320 facets, for the elimination


def three_channels(patches):
    """The same patches with three of their channels, where there are more."""
    pick = np.linspace(0, patches.channels - 1, 3).astype(int) if patches.channels > 3 else slice(None)
    fields = ("reflectance", "absorptance", "emission")
    return replace(patches, sky=patches.sky[pick], **{name: getattr(patches, name)[:, pick] for name in fields})


@pytest.mark.parametrize("name", list(BUILT_IN))
def test_totals_and_orders_agree(name):
    patches, raw = factors_of(SMALLER.get(name, BUILT_IN[name])(), 200)
    patches = three_channels(patches)
    for factors, solvers in ((raw, RAW), (conserved(raw), SOLVERS)):
        T = rad.TransportOperator(factors, patches)
        found = {
            key: solver(rtol=1e-9, maxiter=20_000).solve(T, patches.emission, patches.sky)
            for key, solver in solvers.items()
        }
        reference = found["direct"].radiosity
        for result in found.values():
            assert result.converged
            assert_allclose(result.radiosity, reference, rtol=1e-6, atol=1e-7 * reference.max())
        orders = found["neumann"].orders
        assert_array_equal(orders[:9], T.orders(patches.emission, patches.sky, count=8)[: len(orders)])
        assert_allclose(orders.sum(axis=0), reference, rtol=1e-6, atol=1e-7 * reference.max())


@pytest.mark.parametrize("absorptance", [1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize("door", [1.0, 0.1, 0.01])
def test_two_rooms_by_their_door(absorptance, door):
    """Real geometry down to a pinhole: energy to the last digits, as elimination has it, in few products."""
    scene = rad.scenes.two_rooms(door=door, absorptance=absorptance)
    patches, raw = factors_of(scene, 400)
    T = rad.TransportOperator(conserved(raw), patches)
    result = rad.ConjugateGradient(rtol=1e-11).solve(T, patches.emission)
    assert_allclose(result.radiosity, rad.Direct().solve(T, patches.emission).radiosity, rtol=1e-9)
    certificate = rad.certify(T, patches.emission, result.radiosity)
    assert abs(certificate.energy_defect) < 1e-12 and certificate.algebraic < 1e-9
    assert result.statistics["solver/products"] <= 60


def test_rooms_of_a_scene_are_found():
    """A door of a tenth of the wall: the patches of a room are told from those of the other by where they are."""
    patches, raw = factors_of(rad.scenes.two_rooms(door=0.1), 600)
    rooms = find_rooms(conserved(raw))
    middle = (patches.centroid[:, 0].min() + patches.centroid[:, 0].max()) / 2.0
    apart = np.abs(patches.centroid[:, 0] - middle) > 0.05  # not the partition itself
    left = patches.centroid[:, 0] < middle
    assert rooms.count == 2
    assert len(np.unique(rooms.label[apart & left])) == 1
    assert len(np.unique(rooms.label[apart & ~left])) == 1
    assert rooms.label[apart & left][0] != rooms.label[apart & ~left][0]
