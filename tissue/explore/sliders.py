"""Sliders that move in the browser at once, not when the server answers: else quick steps of the keyboard are lost."""

from __future__ import annotations

from nicegui import ui

MAKES_NO_NUMBERS = True


class QuickSlider(ui.slider):
    """With one end."""

    LOOPBACK = False


class QuickRange(ui.range):
    """With two ends."""

    LOOPBACK = False
