"""A study: subjects × methods × repeats, shuffled, each run kept as soon as it is done."""

from __future__ import annotations

import random
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple

import radiosity as rad

from ..errors import ParameterError
from ..progress import Progress, quiet
from .ledger import Ledger, Record
from .machine import machine
from .measures import Errors, Light, errors
from .methods import Method, methods
from .parts import bounce_runs, solver_runs
from .reference import Effort, Reference, keep, kept, reference
from .solving import run_method
from .subject import Subject
from .yardstick import Check, checks

PARTS = ("methods", "bounces", "solvers")
LEDGER = "runs.jsonl"
WARM = 60  # patches on which every method runs once before anything is timed


@dataclass(frozen=True)
class Settings:
    """How a study is made.

    Attributes
    ----------
    repeats : int
        Times each run is made, each with its own seed where seeds matter.
    seed : int
        Of the first; also shuffles the runs.
    threads : int or None
    few : bool
        Leave out the larger budgets.
    effort : Effort
        Of the references.
    parts : tuple of str
        Of `PARTS`.
    clock : {"wall", "processor"}
        What counts as time in tables and plots: seconds that pass, or those of all processors together, which tell more
        on a machine with other work to do. Both are kept.
    """

    repeats: int = 3
    seed: int = 0
    threads: int | None = None
    few: bool = False
    effort: Effort = field(default_factory=Effort)
    parts: tuple[str, ...] = PARTS
    clock: Literal["wall", "processor"] = "wall"

    @classmethod
    def quick(cls, seed: int = 0, threads: int | None = None) -> Settings:
        """Under a minute: few budgets, two repeats, a plainer reference."""
        effort = Effort(rays=4096, replicates=2, factor=2, paths=256)
        return cls(repeats=2, seed=seed, threads=threads, few=True, effort=effort)


class Run(NamedTuple):
    """One piece of work that gives a record."""

    key: str
    work: Callable[[], Record]


@dataclass(frozen=True, eq=False)
class Study:
    """What a study found."""

    title: str
    subjects: tuple[Subject, ...]
    settings: Settings
    origin: Record
    references: tuple[Reference, ...]
    checks: tuple[Check, ...]
    ledger: Ledger

    @property
    def records(self) -> list[Record]:
        """Runs of methods."""
        return self.ledger.of("methods")


def run_study(
    title: str, subjects: Sequence[Subject], settings: Settings, folder: Path, progress: Progress = quiet
) -> Study:
    """Make a study, or go on with the one in `folder`.

    Parameters
    ----------
    title : str
    subjects : sequence of Subject
    settings : Settings
    folder : path
        Made if it is not there; holds the runs and the references.
    progress : callable, optional
        Stages "references" and "runs", beside those of the work itself.

    Raises
    ------
    ParameterError
        No subject, or one without light.
    FileFormatError
        The folder holds another study.
    """
    _check(subjects)
    folder.mkdir(parents=True, exist_ok=True)
    origin = {"title": title, "seed": settings.seed, **machine()}
    ledger = Ledger(folder / LEDGER, origin)
    progress("references", 0, len(subjects))
    references = []
    for subject in subjects:
        references.append(_reference(subject, settings, folder))
        progress("references", len(references), len(subjects))
    found = tuple(_checks(subjects[-1], references[-1], settings, ledger))
    runs = [run for run in _runs(subjects, references, settings) if run.key not in ledger]
    random.Random(settings.seed).shuffle(runs)
    if runs:
        _warm(subjects, settings)
    progress("runs", 0, max(1, len(runs)))
    for done, run in enumerate(runs, 1):
        ledger.add(run.key, run.work())
        progress("runs", done, len(runs))
    return Study(title, tuple(subjects), settings, origin, tuple(references), found, ledger)


def _check(subjects: Sequence[Subject]) -> None:
    if not subjects:
        raise ParameterError("there is nothing to study: give a scene and numbers of patches")
    for subject in subjects:
        if not subject.patches.emission.any() and not subject.patches.sky.any():
            raise ParameterError(
                f"{subject.name} has no light, so that nothing can be wrong with it: give it a sky (--sky) or a lamp "
                "(--lamp SURFACE=…)"
            )


def _reference(subject: Subject, settings: Settings, folder: Path) -> Reference:
    """The reference kept in the folder, or a new one."""
    effort = settings.effort
    path = folder / f"reference-{subject.fingerprint}-{effort.rays}-{effort.replicates}-{effort.factor}.npz"
    if path.exists():
        return kept(path)
    found = reference(subject.scene, subject.patches, effort, settings.threads)
    keep(found, path)
    return found


def _checks(subject: Subject, truth: Reference, settings: Settings, ledger: Ledger) -> Iterator[Check]:
    """What the path tracer says of the reference of the last subject."""
    key = f"checks|{subject.fingerprint}|{settings.effort}"
    if key not in ledger:
        made = checks(subject.patches, truth, settings.effort.paths, settings.threads)
        ledger.add(key, {"part": "checks", "subject": subject.name, "checks": [check._asdict() for check in made]})
    for values in ledger.records[key]["checks"]:
        yield Check(**values)


def _runs(subjects: Sequence[Subject], references: Sequence[Reference], settings: Settings) -> Iterator[Run]:
    """Everything that there is to do."""
    if "methods" in settings.parts:
        for subject, truth in zip(subjects, references, strict=True):
            for method in methods(subject.patches, few=settings.few):
                for repeat in range(settings.repeats):
                    yield _method_run(subject, truth, method, settings.seed + repeat, settings.threads)
    last = subjects[-1], references[-1]
    for part, make in (("bounces", bounce_runs), ("solvers", solver_runs)):
        if part in settings.parts:
            for name, work in make(*last, repeats=settings.repeats, seed=settings.seed, threads=settings.threads):
                yield Run(f"{part}|{last[0].fingerprint}|{name}", work)


def _method_run(subject: Subject, truth: Reference, method: Method, seed: int, threads: int | None) -> Run:
    key = f"methods|{subject.fingerprint}|{method.family}|{method.budget}|{seed}"
    about = {
        "part": "methods",
        "subject": subject.name,
        "parameter": subject.parameter,
        "value": subject.value,
        "patches": len(subject.patches),
        "family": method.family,
        "budget": method.budget,
        "work": method.work,
        "seed": seed,
    }

    def work() -> Record:
        light, cost = run_method(subject.patches, method.make(seed), threads)
        return about | cost._asdict() | judged(light, truth, subject.patches.area)

    return Run(key, work)


def judged(light: Light, truth: Reference, area: Any) -> Record:
    """Errors of a run: against these patches' own answer, and against that of the finer ones."""

    def named(prefix: str, found: Errors) -> Record:
        return {f"{prefix}_{name}": value for name, value in found._asdict().items()}

    return {
        **named("sampling", errors(light, truth.discrete, area)),
        **named("total", errors(light, truth.continuous, area)),
    }


def _warm(subjects: Sequence[Subject], settings: Settings) -> None:
    """Run every kind of method once on few patches: compilers have then run, and nothing loads while time is taken."""
    scene = subjects[-1].scene
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rad.RadiosityWarning)
        patches = rad.subdivide(scene, patch_count=WARM)
        seen = set()
        for method in methods(patches, few=True):
            if method.family not in seen:
                seen.add(method.family)
                run_method(patches, method.make(0), settings.threads)
