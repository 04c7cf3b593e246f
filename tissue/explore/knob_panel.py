"""The left side of the page: what to begin with, the knobs by groups, what was changed, and what is impossible."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from nicegui import ui

from tissue.explore.knob import Knob
from tissue.explore.knobs import EVENT_GROUP, groups, other_keys
from tissue.explore.session import Session
from tissue.files.keys import all_keys, general
from tissue.files.parameter_files import flat
from tissue.files.parameters import Parameters

MAKES_NO_NUMBERS = True

OPEN = (EVENT_GROUP, "Tissue")


class KnobPanel:
    """The knobs of a session; ``changed`` is called when the setting has become another one."""

    def __init__(self, session: Session, changed: Callable[[], None]) -> None:
        self._session, self._changed = session, changed
        self._knobs: dict[str, Knob] = {}
        self._groups: dict[str, ui.expansion] = {}
        self._whole = ui.element("div").classes("knobs")
        self.rebuild()

    def rebuild(self) -> None:
        """New knobs, as after another beginning: how far sliders go depends on it. Closed groups have none yet."""
        self._knobs.clear()
        self._whole.clear()
        with self._whole:
            self._faults = ui.label().classes("faults").props('role="alert"')
            for group in groups():
                self._groups[group] = ui.expansion(group, value=group in OPEN).props("dense").classes("group")
                self._groups[group].on_value_change(lambda _, group=group: self._fill(group))
            with ui.expansion("All other parameters").props("dense").classes("group") as self._others:
                names = other_keys(flat(self._session.now.setting.first.as_dict()))
                self._chosen = ui.select(
                    names, label="key", with_input=True, on_change=lambda e: self._another(e.value)
                )
                self._chosen.props('dense outlined aria-label="another key"')
        for group in OPEN:
            self._fill(group)
        self.show()

    def show(self, faults: tuple[Mapping[str, str], list[str]] = ({}, [])) -> None:
        """Set all knobs as the setting is; those that were refused keep what was typed, with the reason."""
        at, others = faults
        values = self._session.now.setting.values()
        for key in (*self._session.now.setting.changes, *at):
            self._ensure(key)
        for key, knob in self._knobs.items():
            knob.show(values[key], at.get(key))
        self._faults.text = "; ".join(others)
        self._faults.set_visibility(bool(others))

    def _fill(self, group: str) -> None:
        """Make the knobs of a group that is opened: a page with fewer answers sooner."""
        known = groups()[group]
        if known[0].name not in self._knobs:
            for facts in known:
                self._add(facts.name, self._groups[group])

    def _ensure(self, key: str) -> None:
        """A knob for this key, in its group or among the others."""
        if key not in self._knobs:
            found = [group for group, known in groups().items() if key in (facts.name for facts in known)]
            self._fill(found[0]) if found else self._add(key, self._others)

    def _add(self, key: str, place: ui.expansion) -> None:
        setting = self._session.now.setting
        facts, first = all_keys(Parameters)[general(key)], flat(setting.first.as_dict()).get(key)
        with place:
            self._knobs[key] = Knob(facts, key, first, setting.parameters.t_end, self._set)
        self._knobs[key].show(setting.values()[key], None)

    def _another(self, key: str | None) -> None:
        """Show a knob for another key."""
        if key is not None:
            self._ensure(key)

    def _set(self, values: Mapping[str, Any]) -> None:
        before = self._session.now
        self.show(self._session.set_values(values))
        if self._session.now is not before:
            self._changed()
