"""The commands of ``tissue``."""

from tissue.cli.app import app

MAKES_NO_NUMBERS = True

__all__ = ["app"]
