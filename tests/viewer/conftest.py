"""One small solution for all tests of the viewer, and the mark of those that draw."""

import pytest

import radiosity as rad
from radiosity.viewer import probe


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that ask for `gl` need a machine that can draw."""
    drawing = [item for item in items if "gl" in getattr(item, "fixturenames", ())]
    if drawing and not probe.can_draw():
        for item in drawing:
            item.add_marker(pytest.mark.skip(reason="this machine cannot draw (see radiosity.viewer.probe)"))


@pytest.fixture
def gl() -> None:
    """Asked for by tests that draw."""


@pytest.fixture(scope="session")
def solution() -> rad.Solution:
    """The Cornell box, small."""
    return rad.solve(rad.scenes.cornell_box(), patch_count=600, estimator=rad.MonteCarlo(rays=256), bounces=6)
