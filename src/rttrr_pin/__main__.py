"""The program `rttrr-pin`, and `python -m rttrr_pin`: signals first, so that none ends in a traceback."""

from __future__ import annotations

import gc
import signal
import sys

from rttrr_pin.reporting import interrupts

MANY_OBJECTS = 200_000
"""Made between two collections of garbage; with 700, as Python has it, a seventh of a short run looks for some."""


def run() -> int:
    """Run the command line in a process of its own; its exit code."""
    interrupts.install()
    gc.set_threshold(MANY_OBJECTS)
    try:
        from rttrr_pin.cli import main

        code = main()
        interrupts.ignore()
    except KeyboardInterrupt:  # before `main` could take it
        code, sentence = interrupts.ending(signal.SIGINT)
        print(sentence, file=sys.stderr)
        interrupts.ignore()
    except Exception:  # Python would end with 1, which is a verdict
        sys.excepthook(*sys.exc_info())
        print("error: this is a fault of rttrr-pin: please report it, with the lines above", file=sys.stderr)
        code = 2
    gc.freeze()  # what Python would look through once more, to free what the end of the process frees
    return code


if __name__ == "__main__":
    sys.exit(run())
