"""Form factors between whole surfaces: closed forms, closure, standard errors, tables."""

import csv
import io

import numpy as np
import pytest

import radiosity as rad
from radiosity.errors import FormFactorError, MemoryLimitError, ParameterError
from radiosity.form_factors import surfaces
from radiosity.scenes.build import sphere
from tests.truths import load

# J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-11 and C-14, unit cube
OPPOSITE, ADJACENT = 0.19982489569839, 0.2000437760754

CUBE = np.full((6, 6), ADJACENT)
for wall in range(6):  # floor, ceiling, back, front, left, right
    CUBE[wall, wall ^ 1] = OPPOSITE
    CUBE[wall, wall] = 0.0

METHODS = [
    rad.MonteCarlo(1 << 14, 1, "random"),
    rad.MonteCarlo(1 << 14, 2, "random", replicates=16),
    rad.MonteCarlo(1 << 14, 3, "sobol", replicates=16),
]


def concentric_spheres(inner=0.5, subdivisions=2):
    """A ball in a hollow sphere of radius 1 m."""
    white = rad.Material(0.5)
    ball = rad.Surface("ball", *sphere((0, 0, 0), inner, subdivisions, +1), white)
    shell = rad.Surface("shell", *sphere((0, 0, 0), 1.0, subdivisions, -1), white)
    return rad.Scene([ball, shell], closed=True)


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_walls_of_a_cube_within_their_standard_errors(method):
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=54)
    table = rad.form_factors(patches, method, dtype=np.float64).between_surfaces()
    assert table.names == ("floor", "ceiling", "back_wall", "front_wall", "left_wall", "right_wall")
    seen = CUBE > 0
    z = (table.matrix - CUBE)[seen] / table.standard_error[seen]
    assert np.abs(z).max() < 4.5
    assert 0.5 < np.sqrt(np.mean(z**2)) < 1.6, "neither too small an error, nor one that explains anything"
    assert (table.matrix[~seen] == 0).all() and (table.standard_error[~seen] == 0).all()
    assert table.row_sums == pytest.approx(np.ones(6), abs=1e-14)
    assert table.standard_error[seen].max() < 3e-3


def test_hemicube_between_the_walls_of_a_cube():
    patches = rad.subdivide(rad.scenes.furnace(), patch_count=600)
    table = rad.form_factors(patches, rad.Hemicube(64)).between_surfaces()
    assert table.matrix == pytest.approx(CUBE, abs=2e-3)
    assert table.standard_error is None


def test_a_ball_in_a_shell():
    """All of the ball's light arrives at the shell, and A₁ / A₂ of the shell's at the ball."""
    patches = rad.subdivide(concentric_spheres())
    table = rad.form_factors(patches, rad.MonteCarlo(1024, replicates=8), dtype=np.float64).between_surfaces()
    assert table.factor("ball", "shell") == pytest.approx(1.0, abs=1e-14)
    assert table.factor("ball", "ball") == 0.0
    back = table.area[0] / table.area[1]
    assert back == pytest.approx(0.25, abs=1e-12), "both are cut alike"
    error = table.standard_error[1, 0]
    assert 0 < error < 1e-3
    assert abs(table.factor("shell", "ball") - back) < 4.5 * error
    assert table.factor("shell", "shell") == pytest.approx(1 - table.factor("shell", "ball"), abs=1e-14)


def test_shares_to_sky_and_backs_of_facing_plates():
    scene = rad.scenes.parallel_plates()
    lower, upper = scene.surfaces
    lid = rad.Surface("lid", lower.vertices + [1.0, 1.0, 0], lower.faces, lower.material)  # beside upper, looks up
    patches = rad.subdivide(rad.Scene([lower, upper, lid]), patch_count=27)
    method = rad.MonteCarlo(1 << 13, 1, "random")
    table = rad.form_factors(patches, method, dtype=np.float64).between_surfaces()
    assert abs(table.factor("lower", "upper") - OPPOSITE) < 4.5 * table.standard_error[0, 1]
    assert table.to_sky[2] == pytest.approx(1.0, abs=1e-14) and table.to_sky_error[2] == 0.0
    assert abs(table.to_backs[0] - 0.086050489152327) < 4.5 * table.to_backs_error[0], "Howell C-13, offset by 1"
    assert 0 < table.to_backs_error[0] < 2e-3 and 0 < table.to_sky_error[0] < 2e-3
    assert table.row_sums == pytest.approx(np.ones(3), abs=1e-14)


def test_exact_factors_stay_exact():
    """The truth's 600 patches by wall: rows close and exchange is symmetric to rounding, as for the patches."""
    _, patches, data = load("empty_box")
    names, wall = np.unique(data["group"], return_inverse=True)
    factors = rad.FormFactors.from_matrix(data["F"], patches.area, to_sky=np.zeros(len(patches)))
    table = factors.between_surfaces(wall, tuple(map(str, names)))
    assert table.row_sums == pytest.approx(np.ones(len(names)), abs=1e-13)
    assert table.reciprocity_defect < 1e-13
    assert table.area.sum() == pytest.approx(patches.area.sum(), rel=1e-14)
    assert table.standard_error is None


def readable(factors, group, count):
    """The twin of the kernel: Σ A_i Σ F_ij / Σ A_i."""
    members = np.eye(count)[group]
    power = members.T @ (factors.area[:, None] * factors.matrix.toarray().astype(float)) @ members
    return power / (members.T @ factors.area)[:, None]


def test_patches_of_unequal_area_count_by_their_area():
    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=300)
    factors = rad.form_factors(patches, rad.MonteCarlo(64))
    table = factors.between_surfaces()
    assert table.matrix == pytest.approx(readable(factors, patches.surface, 8), abs=1e-13)
    members = np.eye(8)[patches.surface]
    unweighted = members.T @ factors.matrix.toarray() @ members / members.sum(axis=0)[:, None]
    assert np.abs(table.matrix - unweighted).max() > 1e-3, "negative control: equal weights are wrong"


def test_another_grouping():
    F = rad.FormFactors.from_matrix([[0.0, 0.5, 0.2], [0.5, 0.0, 0.1], [0.1, 0.05, 0.0]], area=[1.0, 1.0, 2.0])
    table = F.between_surfaces([1, 1, 0], ("alone", "together"))
    assert table.names == ("alone", "together")
    assert table.matrix == pytest.approx(np.array([[0.0, 0.15], [0.15, 0.5]]))
    assert table.area == pytest.approx([2.0, 2.0])
    assert F.between_surfaces([5, 5, 2]).names == ("2", "5"), "groups without a patch are left out"


def test_the_table_is_read_by_people_and_programs():
    patches = rad.subdivide(concentric_spheres(subdivisions=1))
    table = rad.form_factors(patches, rad.MonteCarlo(256, replicates=2), dtype=np.float64).between_surfaces()
    text = str(table)
    assert "1 ball" in text and "2 shell" in text and "standard errors up to" in text
    assert text.splitlines()[1].split() == ["1", "2", "sky", "backs", "sum"]
    rows = list(csv.reader(io.StringIO(table.to_csv())))
    assert rows[0] == ["surface", "area_m2", "ball", "shell", "(sky)", "(backs)"]
    assert np.array(rows[1][2:], dtype=float) == pytest.approx([0, 1, 0, 0], abs=1e-14)
    assert float(rows[2][2]) == table.factor("shell", "ball"), "all digits"
    records = table.records()
    assert len(records) == 2 * 4
    assert records[4]["from"] == "shell" and records[4]["to"] == "ball"
    assert records[4]["factor"] == table.factor("shell", "ball")
    assert records[4]["standard_error"] == table.standard_error[1, 0]


def test_a_long_table_is_cut_and_says_so():
    count = 30
    F = rad.FormFactors.from_matrix(np.full((count, count), 1 / count), np.ones(count))
    text = str(F.between_surfaces(np.arange(count)))
    assert "and 10 surfaces more" in text
    assert len(text.splitlines()) == 2 + surfaces.SHOWN + 1


def test_what_cannot_be_grouped(monkeypatch):
    F = rad.FormFactors.from_matrix([[0.0, 0.5], [0.5, 0.0]], area=[1.0, 1.0])
    with pytest.raises(FormFactorError, match="know no surfaces"):
        F.between_surfaces()
    with pytest.raises(FormFactorError, match=r"shape \(3,\)"):
        F.between_surfaces([0, 1, 1])
    with pytest.raises(FormFactorError, match="integers from 0"):
        F.between_surfaces([0.0, 1.0])
    with pytest.raises(FormFactorError, match="numbered up to 1 and there are 1 names"):
        F.between_surfaces([0, 1], ("one",))
    with pytest.raises(FormFactorError, match="1 of them different"):
        F.between_surfaces([0, 1], ("one", "one"))
    with pytest.raises(ParameterError, match="no surface is named 'x'; there are '0', '1'"):
        F.between_surfaces([0, 1]).factor("x", "0")
    monkeypatch.setattr(surfaces, "MAX_BYTES", 8)
    with pytest.raises(MemoryLimitError, match="2 × 2 surfaces"):
        F.between_surfaces([0, 1])
