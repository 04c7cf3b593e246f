"""The commands of ``tissue``."""

from dincl.extras import command

__all__ = ["main"]


def main() -> None:
    """Run the command that was called; where a library of it is missing, say so."""
    with command("tissue", "tissue"):
        from tissue.cli.app import app

        app()
