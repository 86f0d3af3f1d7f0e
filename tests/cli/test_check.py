"""`radiosity scenes --check`: a list in words a modeller understands, a picture, and an exit code."""

from __future__ import annotations

import numpy as np
import pytest

from radiosity.cli import main

ROOM = """\
v 0 0 0
v 4 0 0
v 4 0 3
v 0 0 3
v 0 2 0
v 4 2 0
v 4 2 3
v 0 2 3
o floor
f 1 4 3 2
o walls
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 8 5 1
o ceiling
f 5 6 7 8
o rug
v 1 0 1
v 2 0 1
v 2 0 2
v 1 0 2
f 9 12 11 10
"""


usual = pytest.mark.usefixtures("room")


@pytest.fixture
def room(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "room.obj").write_text(ROOM)
    return tmp_path / "room.obj"


@usual
def test_all_that_is_doubtful_in_one_list(capsys):
    assert main(["scenes", "--check", "room.obj"]) == 0
    told = capsys.readouterr()
    lines = told.out.splitlines()
    assert [line.split(":")[0].split()[1] for line in lines] == ["warning"] * 3 + ["note"]
    assert lines[0].startswith("  1 warning: 'floor' and 'rug' lie in one place and face the same way, over 1 m² at (")
    assert "'walls' has 1 face against their neighbours" in lines[1]
    assert "no surface emits" in lines[2]
    assert "Traceback" not in told.err


@usual
def test_what_is_mended_is_not_reported_again(capsys):
    assert main(["scenes", "--check", "room.obj", "--fix-normals", "--lamp", "ceiling=5"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert len(told) == 2
    assert "'floor' and 'rug'" in told[0]
    assert main(["scenes", "--check", "furnace"]) == 0
    assert capsys.readouterr().out == "furnace: nothing to remark\n"


def test_errors_are_an_exit_code_too(room, capsys):
    room.write_text(ROOM.replace("f 9 12 11 10", "f 9 11 12 10"))
    assert main(["scenes", "--check", "room.obj"]) == 2
    told = capsys.readouterr()
    assert "error: 'rug' has 1 quad whose edges cross over (face 0)" in told.out
    assert "error: 'room' has 1 error; mend the scene first" in told.err


@usual
@pytest.mark.skipif("not __import__('radiosity.viewer.probe', fromlist=['x']).can_draw()")
def test_the_picture_marks_the_places(capsys):
    from PIL import Image

    assert main(["scenes", "--check", "room.obj", "-o", "room.png"]) == 0
    assert "wrote room.png" in capsys.readouterr().err
    with Image.open("room.png") as picture:
        colours = np.asarray(picture.convert("RGB")).reshape(-1, 3).astype(int)
    red, _, blue = colours.T
    assert 200 < (red > blue + 100).sum() < 2000, "orange dots and numbers of three places of warnings"
    assert 300 < (blue > red + 80).sum() < 3000, "blue ones of four open edges"


@usual
def test_words_that_would_do_nothing(capsys):
    assert main(["scenes", "--unit", "mm"]) == 2
    assert "--unit is for --check SCENE" in capsys.readouterr().err
    assert main(["scenes", "--check", "room.obj", "-o", "room.jpg"]) == 2
    assert "'.jpg' is not written here; choose from .png" in capsys.readouterr().err


@usual
def test_a_plan_begins_with_what_is_doubtful(capsys):
    words = ["room.obj", "--lamp", "ceiling=5", "--patches", "60", "--rays", "16"]
    assert main(["plan", *words]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("about the scene")
    assert lines[1].startswith("  1 warning: 'walls' has 1 face against their neighbours")
    assert main(["plan", *words, "--fix-normals"]) == 0
    assert "against their neighbours" not in capsys.readouterr().out
