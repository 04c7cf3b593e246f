"""The player of pictures: a canvas that shows a stream, with its controls, on the page of a visitor."""

from __future__ import annotations

from nicegui.element import Element

MAKES_NO_NUMBERS = True


class Player(Element, component="player.js", esm={"tissue-pictures": "js"}):
    """Plays streams of ``tissue.explore.messages``; what it shows is told by data attributes of its element."""

    def play(self, url: str) -> None:
        """Show another run, from its first frames on, at the time that is shown now."""
        self._props["url"] = url
        self.update()
