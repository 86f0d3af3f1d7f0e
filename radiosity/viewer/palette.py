"""Colours of the window and of figures. Blue and orange differ for every kind of colour vision."""

from __future__ import annotations

PANEL = "#15181d"
INK = "#e8eaed"
FAINT = "#9aa3ae"
HERE = "#ff7043"  # what is picked
OTHER = "#4fc3f7"  # what it is looked at with
GATHERING, SHOOTING = "#4fc3f7", "#ffb74d"
CHANNEL_COLOURS = ("#e4572e", "#5fb346", "#5b8def")
STRONG = {PANEL: "#000000", INK: "#ffffff", FAINT: "#dde3ea"}  # the same, for a projector in a light room
