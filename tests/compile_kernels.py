"""Compile the kernels of the tissue, and say so by making files: ``python -m tests.compile_kernels FILE``.

FILE.read is made when all is compiled that tests compile while they are read, FILE when all is. Both are made if it
fails, too: the tests then say what is wrong.
"""

import sys
from importlib import import_module
from pathlib import Path

# Simulates when it is imported.
READ = "tests.borders.tissue_things"

if __name__ == "__main__":
    file = Path(sys.argv[1])
    try:
        import_module(READ)
        file.with_suffix(".read").touch()
        import_module("verification.thesis.chapter3.sections.page").compile_kernels()
    finally:
        file.with_suffix(".read").touch()
        file.touch()
