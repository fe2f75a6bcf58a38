"""Pages as the commands write them, one for each feature and for each tone."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest

from rttrr_pin.cli import main
from rttrr_pin.urdf.catalogue import bundled
from support.reports import COMMANDS, ODD, WRONG, write_motion


@pytest.fixture(scope="session")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what the commands read."""
    folder = tmp_path_factory.mktemp("desk")
    text = bundled()["rttrr"].read_text()
    limited = re.sub(r'velocity="[^"]*"', 'velocity="0.9"', re.sub(r'effort="[^"]*"', 'effort="60"', text))
    (folder / "limited.urdf").write_text(limited)
    (folder / "heavier.urdf").write_text(text.replace('value="3.75387"', 'value="3.9"'))
    odd = bundled()["trr"].read_text().replace('"joint_2"', quoteattr(ODD))
    (folder / "odd.urdf").write_text(odd)
    (folder / "wrong.py").write_text(WRONG)
    (folder / "robots").mkdir()
    for name in ("trr", "trtr"):
        (folder / "robots" / f"{name}.urdf").write_text(bundled()[name].read_text())
    write_motion(folder / "motion.csv", "rttrr")
    return folder


@pytest.fixture(scope="session")
def pages(desk: Path) -> Mapping[str, Path]:
    """Each page, with the result as JSON beside it."""
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(desk)
        patch.syspath_prepend(str(desk))
        for name, (code, words) in COMMANDS.items():
            html, data = desk / f"{name}.html", desk / f"{name}.json"
            assert main([*words, "--html", str(html), "--json", str(data), "--quiet"]) == code, name
            json.loads(data.read_text())
            found[name] = html
    return found
