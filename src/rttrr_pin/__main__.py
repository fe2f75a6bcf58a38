"""The program `rttrr-pin`, and `python -m rttrr_pin`: signals first, so that none ends in a traceback."""

from __future__ import annotations

import signal
import sys

from rttrr_pin.reporting import interrupts


def run() -> int:
    """Run the command line in a process of its own; its exit code."""
    interrupts.install()
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
    return code


if __name__ == "__main__":
    sys.exit(run())
