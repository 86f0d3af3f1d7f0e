"""The words of the command line: help, examples, what is refused before any work is done."""

import argparse
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import radiosity as rad
from radiosity.cli import arguments, main, source
from radiosity.cli.main import COMMANDS, parser

ROOT = Path(__file__).resolve().parents[2]
NAMES = [command.__name__.rpartition(".")[2] for command in COMMANDS]


def examples(text):
    """Command lines that a text shows."""
    return [line.strip() for line in text.splitlines() if re.match(r" *radiosity [a-z]", line)]


@pytest.mark.parametrize("name", NAMES)
def test_each_command_explains_itself(name, capsys):
    assert main([name, "--help"]) == 0
    said = capsys.readouterr().out
    assert f"usage: radiosity {name}" in said
    assert examples(said)


SHOWN = [line for command in COMMANDS for line in examples(command.EXAMPLES)]
SHOWN += examples((ROOT / "README.md").read_text(encoding="utf-8"))


@pytest.mark.parametrize("line", SHOWN)
def test_every_example_that_is_shown_is_understood(line):
    words = shlex.split(re.split(r"   +", line)[0])
    assert callable(parser().parse_args(words[1:]).run)


def test_help_comes_at_once_and_loads_nothing_heavy():
    code = (
        "import sys\n"
        "from radiosity.cli import main\n"
        "assert main(['solve', '--help']) == 0\n"
        "heavy = {'numpy', 'scipy', 'numba', 'rich', 'pyvista', 'vtkmodules', 'matplotlib', 'trimesh'}\n"
        "print(sorted(heavy & set(sys.modules)), file=sys.stderr)\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert run.stderr.strip() == "[]"
    assert "usage: radiosity solve" in run.stdout


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.strip() == f"radiosity {rad.__version__}"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "required: COMMAND"),
        (["dance"], "invalid choice: 'dance'"),
        (["solve"], "required: SCENE"),
        (["solve", "furnace", "--patches", "many"], "--patches: 'many' is not a whole number"),
        (["solve", "furnace", "--patches", "0"], "--patches: 0 is too few; give at least 1"),
        (["solve", "furnace", "--bounces", "-1"], "--bounces"),
        (["solve", "furnace", "--threads", "0"], "--threads: 0 is too few"),
        (["solve", "furnace", "--rtol", "0"], "--rtol: '0' is not a positive number"),
        (["solve", "furnace", "--patch-size", "inf"], "--patch-size: 'inf' is not a positive number"),
        (["solve", "furnace", "--patches", "5", "--patch-size", "1"], "not allowed with"),
        (["solve", "furnace", "--method", "guess"], "--method: invalid choice"),
        (["solve", "furnace", "--lamp", "ceiling"], "'ceiling' is not SURFACE=E, as in Ceiling=30,28,25"),
        (["solve", "furnace", "--lamp", "ceiling=bright"], "--lamp: 'bright' is not a number"),
        (["solve", "furnace", "--sky", "1,-1,1"], "--sky: '1,-1,1' holds a number that is negative"),
        (["solve", "furnace", "--sky", "nan"], "--sky"),
    ],
)
def test_words_that_make_no_sense(words, said, capsys):
    assert main(words) == 2
    told = capsys.readouterr().err
    assert said in told
    assert "Traceback" not in told


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["solve", "no_such_scene"], "'no_such_scene' is neither a file nor a built-in scene; there are cornell_box,"),
        (["solve", "nothing.glb"], "there is no file nothing.glb"),
        (["solve", "nothing.npz"], "nothing.npz: there is no file"),
        (["solve", "page.glb"], "page.glb is a web page (HTML)"),
        (["solve", "damaged.npz"], "damaged.npz: it is no numpy archive, or it was cut short"),
        (["solve", "scene.blend"], "scene.blend"),
        (["solve", "."], "is a folder"),
        (
            ["solve", "furnace", "-o", "furnace.docx"],
            "'.docx' is not written here; choose from .npz, .vtp, .html",
        ),
        (["solve", "furnace", "-o", "none/furnace.npz"], "there is no folder none; make it first"),
        (["solve", "furnace", "-o", "folder.npz"], "it is a folder"),
        (["solve", "furnace", "--unit", "mm"], "--unit is for files"),
        (["solve", "furnace", "--resolution", "32"], "--resolution is for --method hemicube, not for monte-carlo"),
        (
            ["solve", "furnace", "--method", "two-levels", "--replicates", "2"],
            "--replicates is for --method monte-carlo",
        ),
        (["solve", "furnace", "--method", "hemicube", "--seed", "1"], "--seed is for --method monte-carlo"),
        (["solve", "furnace", "--method", "hemicube", "--resolution", "3"], "resolution is 3; give an even number"),
        (["solve", "furnace", "--lamp", "sun=3"], "no surface or material is named 'sun'; there are 'floor'"),
        (["view", "furnace", "--screenshot", "a.jpg"], "'.jpg' is not written here; choose from .png"),
        (["lecture", "sleep"], "there is no lecture 'sleep'; there are equation, dome, cornell"),
        (["lecture", "cornell", "-o", "talk.pdf"], "a lecture is written as .html, as .png"),
        (["lecture", "cornell", "-o", "none/talk.html"], "there is no folder none; make it first"),
        (["lecture", "cornell", "--copy", "talk.txt"], "a lecture is a Python file; give it the suffix .py"),
        (
            ["export", "furnace", "-o", "box.npz"],
            "'.npz' is not written here; choose from .png, .gif",
        ),
        (["export", "furnace", "-o", "box.glb", "--sheet"], "--sheet is for .png"),
        (["export", "furnace", "-o", "box.glb", "--title", "A box"], "--title is for .html"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_exit_code_2(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "page.glb").write_text("<!DOCTYPE html><html><body>404</body></html>")
    (tmp_path / "damaged.npz").write_bytes(b"PK\x03\x04 and then nothing")
    (tmp_path / "scene.blend").write_bytes(b"BLENDER")
    (tmp_path / "folder.npz").mkdir()
    assert main(words) == 2
    told = capsys.readouterr()
    assert told.out == ""
    (line,) = told.err.splitlines()
    assert line.startswith("error: ")
    assert said in line


def test_options_that_nothing_would_use_are_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for option, value in (("--patches", "5"), ("--method", "hemicube"), ("--rtol", "1e-3"), ("--unit", "mm")):
        assert main(["solve", "room.npz", option, value]) == 2
        assert f"{option} would not be used: room.npz is solved already" in capsys.readouterr().err
    known = {action.dest for action in solve_actions() if action.option_strings}
    elsewhere = {"help", "output", "lamp", "sky", "quiet"}
    assert known - elsewhere == set(arguments.SOLVE_OPTIONS)


def solve_actions():
    top = parser()
    (commands,) = [action for action in top._actions if isinstance(action, argparse._SubParsersAction)]
    return commands.choices["solve"]._actions


def test_without_a_scene_it_is_the_cornell_box_of_the_checkout(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert Path(source.default()) == ROOT / "meshes" / "cornell_box.glb"
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "cornell_box.glb").touch()
    assert source.default() == "meshes/cornell_box.glb"
    monkeypatch.setattr(source, "MESH", Path("meshes/none.glb"))  # as installed: no meshes beside the package
    assert source.default() == "cornell_box"


def test_a_file_comes_before_a_built_in_scene(tmp_path, monkeypatch):
    args = parser().parse_args(["solve", "furnace"])
    monkeypatch.chdir(tmp_path)
    (tmp_path / "furnace").mkdir()
    assert source.scene("furnace", args).name == "furnace"
    (tmp_path / "furnace").rmdir()
    (tmp_path / "furnace").touch()
    with pytest.raises(rad.errors.FileFormatError, match="suffix"):
        source.scene("furnace", args)


def test_lamps_and_sky_reach_files_and_built_in_scenes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["--lamp", "ceiling=4,5,6", "--lamp", "white=0.5", "--sky", "1,2,3"]
    rad.write_scene(rad.scenes.red_rug(), tmp_path / "rug.glb")
    found = [source.scene(word, parser().parse_args(["solve", word, *words])) for word in ("red_rug", "rug.glb")]
    for scene in found:
        light = {surface.name: surface.material.emission.tolist() for surface in scene.surfaces}
        assert light["ceiling"] == [4.0, 5.0, 6.0]
        assert light["back_wall"] == [0.5, 0.5, 0.5]  # by its material
        assert light["rug"] == [0.0, 0.0, 0.0]
        assert scene.sky.tolist() == [1.0, 2.0, 3.0]
