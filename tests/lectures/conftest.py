"""The same small solution and the same mark as the viewer's tests."""

from tests.viewer.conftest import gl, pytest_collection_modifyitems, solution

__all__ = ["gl", "pytest_collection_modifyitems", "solution"]
