"""Commands as people run them: files in, files out, a report, and an end when they are stopped."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import radiosity as rad
from radiosity.cli import main
from radiosity.viewer import probe

ROOT = Path(__file__).resolve().parents[2]
SMALL = ["--patches", "100", "--rays", "64"]
INSTALL = "apt-get install"


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """Each test works in a folder of its own, without a display."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    return tmp_path


def no_gl(*_args):
    """What a test picture comes to where the GL libraries are missing: VTK takes its process with it."""
    return probe.Drawn(-signal.SIGSEGV, "", "")


needs_gl = pytest.mark.skipif("not __import__('radiosity.viewer.probe', fromlist=['x']).can_draw()")


def test_solve_writes_what_the_api_computes(place, capsys):
    assert main(["solve", "cornell_box", *SMALL, "--seed", "5", "--bounces", "3", "-o", "a.npz", "-o", "a.vtp"]) == 0

    solution = rad.solve(
        rad.scenes.cornell_box(), patch_count=100, estimator=rad.MonteCarlo(rays=64, seed=5, replicates=2), bounces=3
    )
    found = rad.read_solution("a.npz")
    assert found.orders.tobytes() == solution.orders.tobytes()
    assert (place / "a.vtp").stat().st_size > 10_000
    told = capsys.readouterr()
    assert told.err.split()[-4:] == ["wrote", "a.npz", "wrote", "a.vtp"]  # after a word on compiling, the first time
    assert f"{len(found.patches):,} on 8 surfaces, open" in told.out
    assert f"{found.factors.matrix.nnz:,} (" in told.out
    assert "cut at 3 bounces, as asked" in told.out
    for k, watts in enumerate(found.power):
        row = rf"^ +{k} +" + " +".join(re.escape(f"{w:.4g}") for w in watts)
        assert re.search(row, told.out, re.MULTILINE)
    for words in ("closure defect", "reciprocity defect", "energy defect", "form factors", "seconds"):
        assert words in told.out


@pytest.mark.parametrize(
    ("words", "estimator", "settings"),
    [
        (["--method", "hemicube", "--resolution", "8"], rad.Hemicube(resolution=8), {}),
        (["--method", "analytic"], rad.Analytic(), {}),
        (
            ["--rays", "32", "--light-rays", "0", "--sampling", "random", "--replicates", "2"],
            rad.MonteCarlo(rays=32, light_rays=0, sampling="random", replicates=2),
            {},
        ),
        (["--rays", "32", "--rtol", "1e-2"], rad.MonteCarlo(rays=32, replicates=2), {"solver": rad.Neumann(rtol=1e-2)}),
        (
            ["--rays", "32", "--patch-size", "0.5"],
            rad.MonteCarlo(rays=32, replicates=2),
            {"patch_count": None, "patch_size": 0.5},
        ),
    ],
)
def test_options_are_the_parameters_of_the_api(words, estimator, settings):
    size = [] if "--patch-size" in words else ["--patches", "96"]
    assert main(["solve", "furnace", "-q", "-o", "a.npz", *size, *words]) == 0
    expected = rad.solve(rad.scenes.furnace(), **{"patch_count": 96, "estimator": estimator, **settings})
    assert rad.read_solution("a.npz").orders.tobytes() == expected.orders.tobytes()


def test_quiet_is_quiet(capsys):
    assert main(["solve", "furnace", *SMALL, "-q", "-o", "a.npz"]) == 0
    told = capsys.readouterr()
    assert (told.out, told.err) == ("", "")


def test_a_dark_scene_is_solved_after_saying_so(capsys):
    assert main(["solve", "cornell_box", *SMALL, "--lamp", "lamp=0"]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("warning: scene 'cornell_box' has no light")
    assert "--sky" in line
    assert "--lamp SURFACE=" in line
    assert ".py" not in line


def test_a_solution_is_relit_and_written_in_other_forms(capsys):
    assert main(["solve", "red_rug", *SMALL, "-q", "-o", "a.npz"]) == 0
    assert main(["solve", "a.npz", "--lamp", "lamp=0", "--lamp", "rug=1,1,1", "-o", "b.npz", "-o", "b.vtp"]) == 0
    expected = rad.read_solution("a.npz").relight(emission={"lamp": 0.0, "rug": [1.0, 1.0, 1.0]})
    assert rad.read_solution("b.npz").radiosity.tobytes() == expected.radiosity.tobytes()
    assert "wrote b.vtp" in capsys.readouterr().err


def test_spectra_and_single_channels_have_a_report(capsys):
    assert main(["solve", "cornell_box_spectral", *SMALL, "--bounces", "2"]) == 0
    assert "power, W" in capsys.readouterr().out
    assert main(["solve", "furnace", *SMALL]) == 0
    out = capsys.readouterr().out
    assert re.search(r"^ +… +… +… *$", out, re.MULTILINE)  # twenty bounces: the first ten and the last
    assert re.search(r"^ +0 +6 +100 % *$", out, re.MULTILINE)


def test_scenes_are_listed_and_written(place, capsys):
    assert main(["scenes"]) == 0
    listed = capsys.readouterr().out
    for name in rad.scenes.BUILT_IN:
        assert re.search(rf"^ +{name} ", listed, re.MULTILINE)
    assert main(["scenes", "--write", "new/folder"]) == 0
    assert {path.stem for path in (place / "new/folder").glob("*.glb")} == set(rad.scenes.BUILT_IN)


def test_lectures_are_listed(capsys):
    assert main(["lecture"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 10
    assert lines[0].startswith("equation ")


def test_a_teacher_copies_a_lecture_adds_a_step_and_hands_it_out(place, capsys):
    assert main(["lecture", "dome", "--copy", "mine.py"]) == 0
    assert main(["lecture", "dome", "--copy", "mine.py"]) == 2
    assert "is there already, and is left as it is" in capsys.readouterr().err
    mine = place / "mine.py"
    step = 'steps=(\n        Step(title="Mine", text="Of {patches} patches.", show={"scene": "white"}, minutes=9),'
    mine.write_text(mine.read_text(encoding="utf-8").replace("steps=(", step, 1), encoding="utf-8")
    assert main(["lecture", "mine.py", "--patches", "200", "-o", "mine.html"]) == 0
    page = (place / "mine.html").read_text(encoding="utf-8")
    assert "<h2>Mine</h2><p>Of 320 patches.</p>" in page
    assert "wrote mine.html" in capsys.readouterr().err


# What is looked at


def test_export_writes_what_is_looked_at(place, capsys):
    words = ["export", "furnace", "--patches", "24", "--bounces", "2", "-o", "box.html", "-o", "box.glb"]
    assert main([*words, "--order", "2", "--exposure", "1", "--title", "An oven", "--caption", "It glows."]) == 0
    page = (place / "box.html").read_text(encoding="utf-8")
    assert "<h1>An oven</h1>" in page
    assert '<p id="caption">It glows.</p>' in page
    assert '"begin":{"k":2,"ev":1.0' in page
    assert (place / "box.glb").read_bytes()[:4] == b"glTF"
    said = [line for line in capsys.readouterr().err.splitlines() if "kernels" not in line]  # of a first run
    assert [line.split(" (")[0] for line in said] == ["wrote box.html", "wrote box.glb"]


@needs_gl
def test_export_writes_contact_sheet_and_film(place):
    words = ["export", "furnace", "--patches", "24", "-q", "--bounces"]
    for bounces in ("2", "5"):
        assert main([*words, bounces, "-o", f"sheet_{bounces}.png", "--sheet"]) == 0
    assert main([*words, "2", "-o", "box.png", "-o", "box.gif", "--normalised"]) == 0
    with Image.open(place / "sheet_2.png") as three, Image.open(place / "sheet_5.png") as six:
        assert three.height == six.height
        assert 1.5 * three.width < six.width < 2 * three.width, "a column for each bounce, and one margin"
    with Image.open(place / "box.gif") as film:
        assert film.n_frames == 3


# Pictures


@needs_gl
@pytest.mark.parametrize(("words", "code"), [([], 3), (["--or-pictures"], 0)])
def test_view_without_a_display_writes_pictures_and_says_where(place, capsys, words, code):
    """A window was asked for: that is no success, unless pictures are declared as good (as `viewer.py` does)."""
    assert main(["view", "cornell_box", *SMALL, "--bounces", "2", *words]) == code
    told = capsys.readouterr().err
    folder = place / "cornell_box_pictures"
    assert "no window: there is no display" in told
    assert ("warning: no window" in told) == (code == 3)
    assert "--screenshot FILE" in told
    assert "Writing pictures instead" in told
    assert str(folder) in told
    written = {path.name for path in folder.iterdir()}
    assert {"orders.png", "sum.png", "power.png"} <= written
    assert all(name in told for name in written)


@pytest.mark.parametrize("screen", [None, ":987"])
def test_a_lecture_without_a_display_becomes_a_page_and_no_success(place, monkeypatch, capsys, screen):
    if screen:
        monkeypatch.setenv("DISPLAY", screen)
    assert main(["lecture", "dome", "--patches", "100"]) == 3
    told = capsys.readouterr().err
    assert "warning: no window: " in told
    assert "lecture NAME -o FILE.html" in told
    assert "wrote dome_lecture.html" in told
    assert "Traceback" not in told
    assert "</html>" in (place / "dome_lecture.html").read_text()


def test_without_gl_every_command_that_draws_says_what_to_install(place, monkeypatch, capsys):
    """Before or after the light is computed, but never by a crash, and never with a half-written file."""
    assert main(["solve", "furnace", *SMALL, "-q", "-o", "a.npz"]) == 0
    monkeypatch.setattr(probe, "_drawn", no_gl)
    for words in (
        ["view", "a.npz", "--screenshot", "b.png"],
        ["view", "a.npz", "--pictures", "pictures"],
        ["export", "a.npz", "-o", "b.png"],
        ["export", "a.npz", "-o", "b.gif"],
        ["lecture", "dome", "-o", "slides"],
        ["scenes", "--check", "furnace", "-o", "b.png"],
    ):
        assert main(words) == 2, words
        told = capsys.readouterr().err
        assert INSTALL in told.replace("\n", " "), words
        assert "Traceback" not in told
    assert not {"b.png", "b.gif"} & {path.name for path in place.iterdir()}


@needs_gl
def test_screenshot_and_picture_are_pictures(place):
    from PIL import Image

    assert main(["solve", "cornell_box", *SMALL, "-q", "-o", "a.npz", "-o", "a.png"]) == 0
    assert main(["view", "a.npz", "--screenshot", "b.png", "--order", "2"]) == 0
    for name in ("a.png", "b.png"):
        with Image.open(place / name) as image:
            colours = np.asarray(image.convert("RGB")).reshape(-1, 3)
        assert len(np.unique(colours, axis=0)) > 50
    assert {path.name for path in place.iterdir()} == {"a.npz", "a.png", "b.png"}


def test_without_gl_the_solution_is_kept_and_the_remedy_named(monkeypatch, capsys):
    monkeypatch.setattr(probe, "_drawn", no_gl)
    assert main(["view", "furnace", *SMALL]) == 2
    (line,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error: ")]
    assert INSTALL in line
    kept = re.search(r"run `radiosity view (\S+)`", line).group(1)
    assert len(rad.read_solution(kept).patches) == 96


def test_without_gl_data_are_written_whatever_the_order_of_outputs(place, monkeypatch, capsys):
    monkeypatch.setattr(probe, "_drawn", no_gl)
    assert main(["solve", "furnace", *SMALL, "-o", "a.png", "-o", "a.npz"]) == 2
    assert INSTALL in capsys.readouterr().err
    assert [path.name for path in place.iterdir()] == ["a.npz"]


@needs_gl
def test_a_display_that_is_dead_is_said_and_pictures_are_written(place, monkeypatch, capsys):
    monkeypatch.setenv("DISPLAY", ":987")
    assert main(["view", "furnace", *SMALL, "--bounces", "1"]) == 3
    told = capsys.readouterr().err
    assert "warning: no window: " in told
    assert ":987" in told
    assert (place / "furnace_pictures" / "sum.png").exists()


# Processes


def start(*words, **environment):
    return subprocess.Popen(
        [sys.executable, *words],
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture
def display(tmp_path):
    """A screen in memory."""
    number = tmp_path / "display"
    with number.open("w+") as file:
        command = ["Xvfb", "-displayfd", str(file.fileno()), "-screen", "0", "1300x800x24", "-nolisten", "tcp"]
        server = subprocess.Popen(command, pass_fds=[file.fileno()], stderr=subprocess.DEVNULL)
    while server.poll() is None and not number.read_text().strip():
        time.sleep(0.05)
    yield ":" + number.read_text().strip()
    server.terminate()
    server.wait()


@pytest.mark.slow
def test_viewer_py_is_view():
    run = start(str(ROOT / "viewer.py"), "--bounces", "1", *SMALL, "--screenshot", "a.docx")
    told = run.communicate(timeout=60)[1]
    assert run.returncode == 2
    assert "a.docx: '.docx' is not written here" in told


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="Windows sends Ctrl-C otherwise")
@pytest.mark.parametrize("seconds", [1.0, 4.0])
def test_ctrl_c_ends_within_two_seconds_and_keeps_the_old_file(place, seconds):
    (place / "a.npz").write_text("old")
    run = start("-m", "radiosity", "solve", "cornell_box", "--patches", "100000", "--rays", "4096", "-o", "a.npz")
    time.sleep(seconds)
    run.send_signal(signal.SIGINT)
    began = time.perf_counter()
    told = run.communicate(timeout=20)[1]
    assert time.perf_counter() - began < 2.0
    assert run.returncode == 130
    assert told.splitlines()[-1].startswith("error: interrupted")
    assert [path.name for path in place.iterdir()] == ["a.npz"]
    assert (place / "a.npz").read_text() == "old"


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="Xvfb is not installed")
@needs_gl
def test_ctrl_c_closes_the_window(display):
    assert main(["solve", "furnace", *SMALL, "-q", "-o", "a.npz"]) == 0
    code = (
        "import os, signal, sys, threading\n"
        "from radiosity.viewer import window\n"
        "tick, window.Window._tick = window.Window._tick, lambda self, *_: (interrupt(), tick(self))\n"
        "begun = []\n"
        "def interrupt():\n"
        "    if not begun: os.kill(os.getpid(), signal.SIGINT)\n"
        "    begun.append(1)\n"
        "from radiosity.cli import main\n"
        "sys.exit(main(['view', 'a.npz']))\n"
    )
    run = start("-c", code, DISPLAY=display)
    told = run.communicate(timeout=120)[1]
    assert run.returncode == 130, told
    assert told.splitlines()[-1] == "error: interrupted"
    assert "Traceback" not in told


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="limits of a process are POSIX")
@pytest.mark.parametrize("name", ["a.npz", "a.vtp"])
def test_a_full_disk_keeps_the_old_file(place, name):
    """A limit on the size of files stands in for the disk."""
    (place / name).write_text("old")
    code = (
        "import resource, signal, sys\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "from radiosity.cli import main\n"
        "import radiosity as rad; solution = rad.solve(rad.scenes.furnace(), patch_count=600)\n"
        "solution.save('source.npz')\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))\n"
        f"sys.exit(main(['solve', 'source.npz', '-o', '{name}']))\n"
    )
    run = start("-c", code)
    told = run.communicate(timeout=120)[1]
    assert run.returncode == 2
    assert [line for line in told.splitlines() if line.startswith("error: ")]
    assert (place / name).read_text() == "old"
    assert sorted(path.name for path in place.iterdir()) == sorted([name, "source.npz"])


@pytest.mark.slow
def test_the_very_first_run_says_that_kernels_are_compiled(place):
    """And only that one."""
    command = ("-m", "radiosity", "solve", "furnace", "--patches", "24", "--rays", "8", "--bounces", "1")
    first, second = (start(*command, NUMBA_CACHE_DIR=str(place / "kernels")).communicate(timeout=300) for _ in range(2))
    assert first[1].count("first run of its kind here: compiling kernels") == 1
    assert re.search(r"compiled \d+ kernels in \d+\.\d s; the next run finds them ready", first[1])
    assert second[1] == ""
    assert "power by bounce" in second[0]


@pytest.mark.slow
def test_a_reader_that_has_read_enough_is_no_error():
    shell = f"{sys.executable} -m radiosity scenes | head -1; exit ${{PIPESTATUS[0]}}"
    run = subprocess.run(["bash", "-c", shell], capture_output=True, text=True, timeout=60)
    assert "Traceback" not in run.stderr
    assert "Exception ignored" not in run.stderr
