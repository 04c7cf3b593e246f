"""The left side of the page: what to begin with, the knobs by groups, what was changed, and what is impossible."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from nicegui import ui

from tissue.explore.knob import Knob
from tissue.explore.knobs import EVENTS, groups, other_keys
from tissue.explore.session import Session
from tissue.files.keys import all_keys, general
from tissue.files.parameter_files import flat
from tissue.files.parameters import Parameters

MAKES_NO_NUMBERS = True

OPEN = (EVENTS, "Tissue")


class KnobPanel:
    """The knobs of a session; ``changed`` is called when the setting has become another one."""

    def __init__(self, session: Session, changed: Callable[[], None]) -> None:
        self._session, self._changed = session, changed
        self._knobs: dict[str, Knob] = {}
        self._whole = ui.element("div").classes("knobs")
        self.rebuild()

    def rebuild(self) -> None:
        """New knobs, as after another beginning: how far sliders go depends on it."""
        self._knobs.clear()
        self._whole.clear()
        first = flat(self._session.now.setting.first.as_dict())
        with self._whole:
            self._faults = ui.label().classes("faults").props('role="alert"')
            for group, known in groups().items():
                with ui.expansion(group, value=group in OPEN).props("dense").classes("group"):
                    for facts in known:
                        self._add(facts.name, first)
            with ui.expansion("All other parameters").props("dense").classes("group") as self._others:
                names = other_keys(first)
                self._chosen = ui.select(
                    names, label="key", with_input=True, on_change=lambda e: self._another(e.value)
                )
                self._chosen.props('dense outlined aria-label="another key"')
        self.show()

    def show(self, faults: tuple[Mapping[str, str], list[str]] = ({}, [])) -> None:
        """Set all knobs as the setting is; those that were refused keep what was typed, with the reason."""
        at, others = faults
        values, first = self._session.now.setting.values(), flat(self._session.now.setting.first.as_dict())
        for key in self._session.now.setting.changes:
            if key not in self._knobs:
                self._beside(key, first)
        for key, knob in self._knobs.items():
            knob.show(values[key], at.get(key))
        self._faults.text = "; ".join(others)
        self._faults.set_visibility(bool(others))

    def _add(self, key: str, first: Mapping[str, Any]) -> None:
        facts = all_keys(Parameters)[general(key)]
        end = self._session.now.setting.parameters.t_end
        self._knobs[key] = Knob(facts, key, first.get(key), end, self._set)

    def _beside(self, key: str, first: Mapping[str, Any]) -> None:
        with self._others:
            self._add(key, first)

    def _another(self, key: str | None) -> None:
        """Show a knob for another key."""
        if key is not None and key not in self._knobs:
            self._beside(key, flat(self._session.now.setting.first.as_dict()))
            self.show()

    def _set(self, values: Mapping[str, Any]) -> None:
        before = self._session.now
        self.show(self._session.set_values(values))
        if self._session.now is not before:
            self._changed()
