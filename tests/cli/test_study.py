"""`radiosity study` as people run it."""

from __future__ import annotations

import json

import pytest

from radiosity.cli import main


@pytest.mark.slow
def test_a_furnace_is_studied(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["--quick", "--patches", "24", "--repeats", "1", "--parts", "methods", "--clock", "processor"]
    assert main(["study", "furnace", *words]) == 0
    told = capsys.readouterr()
    assert "To 10 %: " in told.out
    assert "begin with study_furnace/report.html" in told.err.replace("\n", "")
    study = json.loads((tmp_path / "study_furnace" / "study.json").read_text())
    rows = study["tables"]["methods"]
    assert study["clock"] == "processor"
    assert len({row["family"] for row in rows}) >= 7, "every method, whichever was quickest"
    assert [row["seconds"] for row in rows] == [row["processor_seconds"] for row in rows]
    assert max(row["total_l2"] for row in rows if not row["family"].endswith("walks")) < 1e-5


def test_words_that_do_not_fit_are_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["study", "occlusion", "--patches", "50"]) == 2
    assert "occlusion is a family of scenes" in capsys.readouterr().err
    assert main(["study", "no_such_scene"]) == 2
    assert main(["study", "furnace", "--lamp", "nothing=1"]) == 2
    assert list(tmp_path.iterdir()) == []
