"""Progress of a long command: a bar on a terminal."""

from rich.console import Console

from dincl.study import progress


def test_progress_is_a_bar_on_a_terminal(capsys):
    console = Console(force_terminal=True, width=80)
    with progress("growing", 48.0, "h", console) as done:
        done(12.0)
    shown = capsys.readouterr().out
    assert "12 of 48 h" in shown
    assert "growing" in shown
