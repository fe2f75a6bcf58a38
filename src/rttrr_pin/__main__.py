"""`python -m rttrr_pin`."""

from __future__ import annotations

import sys

from rttrr_pin.cli import main

sys.exit(main())
