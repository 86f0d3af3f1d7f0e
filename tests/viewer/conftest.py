"""One small solution for all tests of the viewer, and the mark of those that draw."""

from collections.abc import Iterator
from pathlib import Path

import pytest

import radiosity as rad
from radiosity.viewer import page, probe
from radiosity.viewer.state import Series
from tests.viewer.browser import Browser


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


@pytest.fixture(scope="session")
def series(solution: rad.Solution) -> Series:
    return Series.of(solution)


@pytest.fixture(scope="session")
def file(solution: rad.Solution, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return page.write_page(solution, tmp_path_factory.mktemp("page") / "cornell.html")


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    browser = Browser(tmp_path_factory.mktemp("chromium"))
    yield browser
    browser.close()


@pytest.fixture
def shown(browser: Browser, file: Path) -> Iterator[Browser]:
    """The page, freshly opened; afterwards, it has asked for nothing and complained of nothing."""
    browser.size(1000, 640)
    browser.open(file)
    yield browser
    assert browser.requests == [file.as_uri()]
    assert browser.complaints == []
    assert browser.run("document.getElementById('trouble').hidden")
