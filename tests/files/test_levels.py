"""Solutions on two levels saved and read back; and what passes for none."""

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import FileFormatError

from .damage import put, rewritten, say, swap
from .same import assert_same_bits


@pytest.fixture(scope="module")
def box():
    return rad.solve(rad.scenes.cornell_box(), patch_count=600, estimator=rad.TwoLevel(16, 64, 16, group=3), bounces=3)


@pytest.fixture(scope="module")
def saved(box, tmp_path_factory):
    path = tmp_path_factory.mktemp("levels") / "box.npz"
    box.save(path)
    return path


def test_the_spot_check_comes_back(box, saved):
    found, expected = rad.read_solution(saved), box
    assert_same_bits(found.factors.check.patch, expected.factors.check.patch, "patch")
    assert_same_bits(found.factors.check.to_sky, expected.factors.check.to_sky, "to_sky")
    for one, other in zip(found.factors.check.rows, expected.factors.check.rows, strict=True):
        assert_same_bits(one.data, other.data, "data")
        assert_same_bits(one.indices, other.indices, "indices")
    assert found.certificate.sampling == expected.certificate.sampling


def test_without_a_spot_check_the_sampling_error_is_not_known(saved, tmp_path):
    """Files written before there was one."""
    rewritten(saved, tmp_path / "old.npz", lambda header, _: [one.pop("check") for one in header["factors"]])
    old = rad.read_solution(tmp_path / "old.npz")
    assert old.factors.check is None
    assert old.certificate.sampling is None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (say("factors", 0, "group", value=1), "group"),
        (say("factors", 0, "group", value=4), "the patches make .* groups"),
        (swap("factors/levels/smooth", lambda a: a[:-1]), "factors/levels/smooth has .* entries"),
        (swap("factors/levels/emits", lambda a: a[:-1]), "factors/levels/emits has .* entries"),
        (put("factors/levels/exchange/data", 0, -0.5), "factors/levels/exchange holds a negative share"),
        (put("factors/levels/spread/indices", 0, 1 << 20), "factors/levels/spread/indices reaches"),
        (put("factors/check/patch", 0, -1), "factors/check/patch reaches"),
        (put("factors/check/patch", -1, 1 << 20), "factors/check/patch reaches"),
        (swap("factors/check/patch", lambda a: a[:-1]), "factors/check/"),
        (swap("factors/check/to_sky", lambda a: a[:1]), "factors/check/to_sky has shape"),
        (put("factors/check/to_sky", (0, 0), -0.5), "factors/check/to_sky holds a negative share"),
        (put("factors/check/to_sky", (1, 3), 0.9), "factors/check: .*more than 1 leaves"),
        (put("factors/check/1/data", 0, np.nan), "factors/check/1/data holds values that are not finite"),
        (put("factors/check/1/data", 0, -0.5), "factors/check/1 holds a negative share"),
        (put("factors/check/0/indices", 0, -1), "factors/check/0/indices reaches"),
    ],
)
def test_a_wrong_part_is_named(saved, tmp_path, change, words):
    rewritten(saved, tmp_path / "wrong.npz", change)
    with pytest.raises(FileFormatError, match=words):
        rad.read_solution(tmp_path / "wrong.npz")
