"""The left side of the page: a knob for each parameter, in groups; a slider, a choice, a text."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from nicegui import ui

from tissue.files.keys import KeyFacts, all_keys
from tissue.files.parameter_files import flat, general
from tissue.files.parameters import Parameters
from tissue.files.quantities import NEVER, Timing, timing
from verification.explore.knobs import EVENT_GROUP, groups, is_timing, number_of, other_keys, scale_of
from verification.explore.session import Session
from verification.explore.setting import text_of, value_of

Changed = Callable[[Mapping[str, Any]], None]
SPAN = 1 / 8, 1 / 2  # of the run, between which an event begins that is switched on: 6 h to 24 h of 48 h


class QuickSlider(ui.slider):
    """With one end."""

    LOOPBACK = False


class QuickRange(ui.range):
    """With two ends."""

    LOOPBACK = False


class Knob:
    """The controls of a key; ``changed`` is told each new value, ``show`` sets all of them."""

    def __init__(self, facts: KeyFacts, key: str, first: Any, end: float, changed: Changed) -> None:
        self.key, self._facts, self._first, self._changed = key, facts, first, changed
        self._value, self._showing = first, False
        with ui.element("div").classes("knob").props(f'data-key="{key}"') as self._whole:
            self._head()
            with ui.element("div").classes("controls"):
                self._moved = self._controls(end)

    def show(self, value: Any, fault: str | None) -> None:
        """Set the controls to a value; where there is a fault, what was typed stays, with what is wrong beside it."""
        self._value, self._showing = value, True
        self._text.error = fault
        if fault is None:
            self._text.value = text_of(value)
        self._whole.classes(add="changed") if value != self._first else self._whole.classes(remove="changed")
        self._back.set_visibility(value != self._first or fault is not None)
        self._moved(value)
        self._showing = False

    def _head(self) -> None:
        facts = self._facts
        with ui.element("div").classes("head"):
            name = ui.label(facts.meaning).classes("meaning")
            symbol = f"{facts.symbol}, " if facts.symbol else ""
            name.tooltip(f"{self.key}: {symbol}{facts.allowed}. {facts.source}")
            undo = ui.button(icon="undo", on_click=lambda: self._changed({self.key: self._first}))
            self._back = undo.props(f'flat dense size=xs aria-label="{self.key} as it was"')

    def _field(self) -> None:
        """Add a text field: what is typed counts once it is entered, or left."""
        self._text = ui.input(value=text_of(self._value)).props(f'dense outlined aria-label="{self.key}"')
        self._text.on("change", lambda: self._tell(self._typed(self._text.value or "")))

    def _typed(self, text: str) -> Any:
        """Return what was typed; a number alone stays text where the key wants a text, which has a unit."""
        value = value_of(text)
        return text if isinstance(self._first, str) and not isinstance(value, str) else value

    def _tell(self, value: Any) -> None:
        if not self._showing and (value != self._value or self._text.error):
            self._changed({self.key: value})

    def _controls(self, end: float) -> Callable[[Any], object]:
        """Add the controls; return the function that sets them."""
        self._field()
        if self._facts.is_choice:
            self._text.set_visibility(False)
            return self._choice()
        if is_timing(self._facts):
            return self._event(end)
        return self._slider()

    def _choice(self) -> Callable[[Any], object]:
        options = list(self._facts.options)
        if set(options) == {True, False}:
            switch = ui.switch(value=bool(self._value), on_change=lambda e: self._tell(e.value))
            return lambda value: switch.props(f'aria-label="{self.key}"').set_value(bool(value))
        chosen = ui.select(options, value=self._value, on_change=lambda e: self._tell(e.value))
        return chosen.props(f'dense outlined aria-label="choose {self.key}"').set_value

    def _slider(self) -> Callable[[Any], object]:
        scale = scale_of(self._facts, self._first)
        if scale is None:
            return lambda _: None

        def place(value: Any) -> int | None:
            number, unit = number_of(value)
            return scale.place_of(number) if number is not None and unit == scale.unit else None

        def moved(to: float) -> None:
            if int(to) != place(self._value):
                self._tell(scale.value_at(int(to)))

        slider = QuickSlider(
            min=0, max=len(scale.values) - 1, value=place(self._first), on_change=lambda e: moved(e.value)
        )
        slider.props(f'dense aria-label="slide {self.key}"')
        return lambda value: None if (to := place(value)) is None else slider.set_value(to)

    def _event(self, end: float) -> Callable[[Any], None]:
        """Add controls: whether it begins, between which times, with which probability."""

        def tell(_: Any = None) -> None:
            low, high = (float(span.value[side]) for side in ("min", "max"))
            self._tell(str(Timing(low, high, float(share.value))) if on.value else NEVER)

        on = ui.switch(on_change=tell).props(f'dense aria-label="whether {self.key}"')
        with ui.element("div").classes("timing") as more:
            span = QuickRange(min=0, max=end, step=0.5, on_change=tell)
            span.props(f'dense label aria-label="slide {self.key}"')
            share = QuickSlider(min=0, max=100, value=100, on_change=tell)
            share.props(f'dense label aria-label="share {self.key}"')

        def show(value: Any) -> None:
            found = timing(value)
            ends = [
                part * end if time == math.inf else time
                for part, time in zip(SPAN, (found.low, found.high), strict=True)
            ]
            span.value = {"min": min(ends[0], end), "max": min(ends[1], end)}
            share.value, on.value = found.percent, found.low < math.inf
            more.set_visibility(on.value)

        return show


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
        """Make new knobs, as after another beginning: how far sliders go depends on it. Closed groups have none yet."""
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
        """Make a knob for this key, in its group or among the others, unless there is one."""
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
