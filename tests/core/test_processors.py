"""A process uses what the system grants it, or less where it was told."""

from __future__ import annotations

import pytest

from rttrr_pin.core import processors


def test_one_of_several_processes_takes_its_share(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processors, "_most", None)
    granted = processors.processors()
    assert granted >= 1
    processors.use_at_most(1)
    assert processors.processors() == 1
    processors.use_at_most(granted + 5)
    assert processors.processors() == granted
