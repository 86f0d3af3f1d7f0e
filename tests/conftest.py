"""What all tests share: inputs that hypothesis draws are the same in every run, and figures need no display."""

import os

from hypothesis import settings

os.environ.setdefault("MPLBACKEND", "Agg")  # read when matplotlib is first imported, also by subprocesses

settings.register_profile("reproducible", derandomize=True, deadline=None)
settings.load_profile("reproducible")
