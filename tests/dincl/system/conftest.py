"""What tests of interrupts need."""

import signal

import pytest


@pytest.fixture
def interruptible():
    """Ctrl-C is heard, also by a process that was started in the background: there a shell has it ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
