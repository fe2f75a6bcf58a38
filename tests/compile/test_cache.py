"""Compiled programs on disk: found again, never mistaken for others, and never in the way."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rttrr_pin import Robot
from rttrr_pin.compile import cache
from rttrr_pin.compile.emit.llvm import LlvmEmitter
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.errors import CacheWarning

STATE = ([0.3], [0.4], [0.5])
DEFINITION = """
import os, sys, warnings
import numpy as np
from rttrr_pin import Robot
from rttrr_pin.compile.emit.llvm import LlvmEmitter
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import REVOLUTE
from rttrr_pin.core.model import Link, Model

def robot(mass=2.0):
    link = Link("a", mass, np.array([0.1, 0.2, 0.3]), np.diag([1.0, 2.0, 2.5]))
    joint = Joint("j", REVOLUTE, axis=np.array([0.0, 1.0, 0.0]))
    return Robot(Model("one", Link("base"), (link,), (joint,)))

STATE = ([0.3], [0.4], [0.5])
"""


def robot(mass: float = 2.0) -> Robot:
    """Of one joint, the same in every process."""
    link = Link("a", mass, np.array([0.1, 0.2, 0.3]), np.diag([1.0, 2.0, 2.5]))
    joint = Joint("j", REVOLUTE, axis=np.array([0.0, 1.0, 0.0]))
    return Robot(Model("one", Link("base"), (link,), (joint,)))


def in_another_process(code: str, **variables: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", DEFINITION + code],
        env={**os.environ, **variables},
        stdout=subprocess.PIPE,
        text=True,
        timeout=120,
        check=True,
    )
    return done.stdout


@pytest.fixture(autouse=True)
def warnings_not_yet_given() -> Iterator[None]:
    cache._warn.cache_clear()
    yield
    cache._warn.cache_clear()


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """One entry for each time that the compiler ran."""
    runs: list[int] = []
    emit = LlvmEmitter.emit
    monkeypatch.setattr(LlvmEmitter, "emit", lambda self, program: (runs.append(1), emit(self, program))[1])
    return runs


def entries(folder: Path) -> list[Path]:
    assert not list(folder.glob("*.partial"))
    return sorted(folder.glob(f"*{cache.SUFFIX}"))


def test_an_entry_is_written_once_and_read_by_other_robots_objects(folder: Path, compiled: list[int]) -> None:
    first = robot().compile("tau")(*STATE)
    (entry,) = entries(folder)
    again = robot().compile("tau")(*STATE)
    np.testing.assert_array_equal(again, first)
    assert (entries(folder), len(compiled)) == ([entry], 1)


def test_another_process_compiles_nothing_and_computes_the_same_bits(folder: Path) -> None:
    mine = robot().compile(("tau", "n"))(*STATE)
    text = in_another_process("""
def emit(self, program):
    raise AssertionError("compiled again")
LlvmEmitter.emit = emit
result = robot().compile(("tau", "n"))(*STATE)
print(result["tau"].tobytes().hex(), result["n"].tobytes().hex())
assert not {"rttrr_pin.compile.build", "rttrr_pin.compile.emit.llvm_driver"} & {*sys.modules}  # nor even loaded
""")
    assert text.split() == [mine[name].tobytes().hex() for name in ("tau", "n")]


def truncate(entry: Path) -> None:
    entry.write_bytes(entry.read_bytes()[:-1])


def flip(place: int) -> Callable[[Path], None]:
    def damage(entry: Path) -> None:
        data = bytearray(entry.read_bytes())
        data[place] ^= 1
        entry.write_bytes(data)

    return damage


def of_another_robot(entry: Path) -> None:
    """A whole and sound entry, but not this one's: a copy that went wrong, or a file system that did."""
    robot(mass=7.0).compile("tau")(*STATE)
    (other,) = (path for path in entries(entry.parent) if path != entry)
    other.replace(entry)


DAMAGE: dict[str, Callable[[Path], Any]] = {
    "truncated": truncate,
    "half": lambda entry: entry.write_bytes(entry.read_bytes()[: entry.stat().st_size // 2]),
    "digest-alone": lambda entry: entry.write_bytes(entry.read_bytes()[: cache.DIGEST]),
    "empty": lambda entry: entry.write_bytes(b""),
    "longer": lambda entry: entry.write_bytes(entry.read_bytes() + b"\0"),
    "first-bit": flip(0),
    "a-bit-of-the-code": flip(cache.DIGEST + 100),
    "last-bit": flip(-1),
    "foreign": lambda entry: entry.write_text("not machine code at all" * 100),
    "zeros": lambda entry: entry.write_bytes(bytes(entry.stat().st_size)),
    "of-another-robot": of_another_robot,
    "endless": lambda entry: os.truncate(entry, 2**40),
}


@pytest.mark.one_in(6)
@pytest.mark.parametrize("case", DAMAGE)
def test_a_damaged_entry_is_made_anew(folder: Path, compiled: list[int], case: str) -> None:
    expected = robot().compile("tau")(*STATE)
    (entry,) = entries(folder)
    DAMAGE[case](entry)
    compiled.clear()
    np.testing.assert_array_equal(robot().compile("tau")(*STATE), expected)
    assert len(compiled) == 1
    compiled.clear()
    np.testing.assert_array_equal(robot().compile("tau")(*STATE), expected)
    assert not compiled


def test_a_damaged_entry_is_gone_even_if_nothing_is_compiled(folder: Path) -> None:
    cache.write("name", b"code")
    truncate(folder / f"name{cache.SUFFIX}")
    assert cache.read("name") is None
    assert not entries(folder)


@pytest.mark.parametrize("data", [b"", b"x", bytes(1000), os.urandom(5000)], ids=len)
def test_what_is_written_is_read(folder: Path, data: bytes) -> None:
    cache.write("name", data)
    assert cache.read("name") == data
    assert cache.read("other") is None


def test_a_directory_in_an_entrys_place_costs_a_warning(folder: Path) -> None:
    expected = robot().compile("tau")(*STATE)
    (entry,) = entries(folder)
    entry.unlink()
    entry.mkdir()
    with pytest.warns(CacheWarning, match="cannot be kept"):
        np.testing.assert_array_equal(robot().compile("tau")(*STATE), expected)
    assert not list(folder.glob("*.partial"))


def test_an_empty_variable_means_no_folder(
    tmp_path: Path, compiled: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(cache.VARIABLE, "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path)
    for _ in range(2):
        robot().compile("tau")(*STATE)
    assert len(compiled) == 2
    assert not list(tmp_path.iterdir())


def test_without_the_variable_it_is_the_users_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(cache.VARIABLE)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache.folder() == tmp_path / "rttrr-pin" / "kernels"


# Folders that cannot be written


def warned(call: Callable[[], Any]) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call()
    assert {each.category for each in caught} <= {CacheWarning}
    return [str(each.message) for each in caught]


def compile_two() -> None:
    """Two programs of two robots."""
    for mass, name in ((2.0, "tau"), (3.0, "mass_matrix")):
        made = robot(mass).compile(name)
        assert np.isfinite(made(*STATE[: 3 if name == "tau" else 1])).all()


@pytest.mark.parametrize("below", [False, True], ids=["the-folder", "above-the-folder"])
def test_a_file_in_place_of_the_folder_is_one_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, below: bool
) -> None:
    file = tmp_path / "file"
    file.write_text("mine")
    monkeypatch.setenv(cache.VARIABLE, str(file / "kernels" if below else file))
    messages = warned(compile_two)
    assert len(messages) == 1
    assert f"cannot be kept in {file}" in messages[0] and cache.VARIABLE in messages[0]
    assert file.read_text() == "mine"


READ_ONLY = """
folder = os.environ["RTTRR_PIN_CACHE"]
os.environ["RTTRR_PIN_CACHE"] = ""
expected = robot().compile("tau")(*STATE)  # loads all that is needed, while it may be read
os.environ["RTTRR_PIN_CACHE"] = folder
os.mkdir(folder)
os.chmod(folder, 0o555)
if os.geteuid() == 0:  # whom no mode binds
    os.setuid(65534)
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    assert np.array_equal(robot().compile("tau")(*STATE), expected)
    robot().compile("mass_matrix")(STATE[0])
    robot(3.0).compile("tau")(*STATE)
print([each.category.__name__ for each in caught])
"""


def test_a_read_only_folder_is_one_warning() -> None:
    with tempfile.TemporaryDirectory() as open_to_all:  # pytest's own folders are not
        Path(open_to_all).chmod(0o755)
        text = in_another_process(READ_ONLY, RTTRR_PIN_CACHE=f"{open_to_all}/sealed")
    assert text.strip() == "['CacheWarning']"


FULL = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    robot().compile("tau")(*STATE)
    robot().compile("mass_matrix")(STATE[0])
print([each.category.__name__ for each in caught], os.listdir(os.environ["RTTRR_PIN_CACHE"]))
"""


def test_a_full_disk_is_one_warning_and_leaves_no_remains(tmp_path: Path) -> None:
    text = in_another_process(FULL, RTTRR_PIN_CACHE=str(tmp_path / "full"))
    assert text.strip() == "['CacheWarning'] []"


def test_a_read_only_folder_with_the_entry_in_it_is_no_warning(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was compiled for all users of a machine is read, and nothing said."""
    robot().compile("tau")(*STATE)

    def refuse(*arguments: object, **names: object) -> None:
        raise PermissionError(13, "Permission denied")

    for name in ("utime", "mkdir", "unlink", "replace"):
        monkeypatch.setattr(os, name, refuse)
    assert not warned(lambda: robot().compile("tau")(*STATE))


# Many processes


TOGETHER = """
os.mkdir(os.environ["RTTRR_PIN_CACHE"])
ready, go = os.pipe()
children = []
for k in range(5):
    child = os.fork()
    if child == 0:
        os.close(go)
        os.read(ready, 1)  # until the parent closes its end
        result = robot().compile("tau")(*STATE)
        with open(f"{os.environ['RESULTS']}/{k}", "wb") as file:
            file.write(result.tobytes())
        os._exit(0)
    children.append(child)
os.close(go)
assert all(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0 for child in children)
print(*os.listdir(os.environ["RTTRR_PIN_CACHE"]))
"""


def test_processes_that_start_at_the_same_time(tmp_path: Path) -> None:
    results = tmp_path / "results"
    results.mkdir()
    names = in_another_process(TOGETHER, RTTRR_PIN_CACHE=str(tmp_path / "shared"), RESULTS=str(results)).split()
    assert len(names) == 1 and names[0].endswith(cache.SUFFIX)
    assert len({path.read_bytes() for path in results.iterdir()}) == 1
    assert len(list(results.iterdir())) == 5


# The limit


def old(folder: Path, name: str, hours: float) -> Path:
    path = folder / name
    stamp = path.stat().st_mtime - 3600 * hours
    os.utime(path, (stamp, stamp))
    return path


NAMES = {letter: cache.key(letter) for letter in "abcdef"}
"""Names as entries have them, by a letter each."""


def letters(folder: Path) -> set[str]:
    """Of the entries in the folder."""
    kept = {path.stem for path in entries(folder)}
    return {letter for letter, name in NAMES.items() if name in kept}


def test_entries_not_used_for_longest_are_dropped(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "MOST_BYTES", 5000)
    for hours, letter in enumerate("edcba"):
        cache.write(NAMES[letter], bytes(1200))
        old(folder, NAMES[letter] + cache.SUFFIX, 5 - hours)
    assert letters(folder) == set("dcba")  # four of them are 4928 bytes
    assert cache.read(NAMES["d"]) is not None  # the oldest, used again
    cache.write(NAMES["f"], bytes(1200))
    assert letters(folder) == set("dbaf")


def test_the_newest_entry_stays_whatever_its_age_says(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "MOST_BYTES", 3000)
    for name in NAMES.values():
        cache.write(name, bytes(1000))
        assert cache.read(name) is not None


def test_remains_of_killed_processes_are_dropped_and_those_at_work_left(folder: Path) -> None:
    cache.write(NAMES["a"], b"code")
    dead, alive = (f"{NAMES['c']}{end}.partial" for end in ("abcd_123", "0123abc_"))
    for name in (dead, alive):
        (folder / name).write_bytes(b"half")
    old(folder, dead, 2)
    cache.write(NAMES["b"], b"code")
    assert {path.name for path in folder.iterdir()} == {alive, *(NAMES[x] + cache.SUFFIX for x in "ab")}


FOREIGN = (
    "thesis.tex",
    "corn.kernel",
    "download.partial",
    f"{'g' * 40}.kernel",
    f"{'a' * 39}.kernel",
    "vmlinuz.kernel",
)


def test_files_of_others_are_left_alone(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever they are called. They do not count either: a folder that holds much else still keeps programs."""
    folder.mkdir(parents=True, mode=0o700)
    for name in FOREIGN:
        (folder / name).write_bytes(bytes(9000))
        old(folder, name, 100)
    (folder / f"{'b' * 40}.kernel").mkdir()
    monkeypatch.setattr(cache, "MOST_BYTES", 3000)
    cache.write(NAMES["a"], bytes(500))
    old(folder, NAMES["a"] + cache.SUFFIX, 1)
    cache.write(NAMES["b"], bytes(500))
    own = {NAMES[letter] + cache.SUFFIX for letter in "ab"}
    assert {path.name for path in folder.iterdir()} == {*own, *FOREIGN, f"{'b' * 40}.kernel"}


# Whose it is


def planted(folder: Path) -> Path:
    """A whole and sound entry, in the place of the one of `robot()`, with the code of another robot."""
    robot().compile("tau")(*STATE)
    (entry,) = entries(folder)
    robot(mass=7.0).compile("tau")(*STATE)
    (other,) = (path for path in entries(folder) if path != entry)
    code = other.read_bytes()[cache.DIGEST :]
    entry.write_bytes(cache._digest(entry.stem, code) + code)
    return entry


SOMEBODY = 54321


def of_somebody(path: Path) -> Callable[[os.stat_result], os.stat_result]:
    """As if another user owned a path; to change owners takes root."""
    number = path.stat().st_ino

    def seen(status: os.stat_result) -> os.stat_result:
        if status.st_ino != number:
            return status
        return os.stat_result([*status[:4], SOMEBODY, *status[5:10]])

    return seen


@pytest.fixture
def disowned(monkeypatch: pytest.MonkeyPatch) -> Callable[[Path], None]:
    def disown(path: Path) -> None:
        seen, stat, fstat = of_somebody(path), os.stat, os.fstat
        monkeypatch.setattr(os, "stat", lambda *given, **named: seen(stat(*given, **named)))
        monkeypatch.setattr(os, "fstat", lambda handle: seen(fstat(handle)))

    return disown


@pytest.mark.one_in(3)
@pytest.mark.parametrize("what", ["folder", "entry"])
@pytest.mark.parametrize("fault", ["another user", "group writes", "all write"])
def test_what_another_user_may_have_written_is_not_run(
    folder: Path, compiled: list[int], disowned: Callable[[Path], None], what: str, fault: str
) -> None:
    expected = robot().compile("tau")(*STATE)
    entry = planted(folder)
    np.testing.assert_array_equal(robot().compile("tau")(*STATE), robot(mass=7.0).compile("tau")(*STATE))  # it runs
    place = folder if what == "folder" else entry
    if fault == "another user":
        disowned(place)
    else:
        place.chmod(0o770 if fault == "group writes" else 0o707)
    compiled.clear()
    messages = warned(lambda: np.testing.assert_array_equal(robot().compile("tau")(*STATE), expected))
    assert len(messages) == len(compiled) == 1
    assert ("belongs to another user" if fault == "another user" else "other users may write it") in messages[0]
    assert not warned(lambda: robot(mass=9.0).compile("tau")(*STATE))  # once is enough


def test_a_folder_in_doubt_is_not_written_either(folder: Path) -> None:
    folder.mkdir(parents=True)
    folder.chmod(0o777)
    assert len(warned(compile_two)) == 1
    assert not list(folder.iterdir())


@pytest.mark.parametrize(("mode", "refused"), [(0o707, True), (0o770, True), (0o1777, False), (0o755, False)])
def test_a_folder_that_others_may_exchange_is_refused(folder: Path, mode: int, refused: bool) -> None:
    folder.mkdir(parents=True)
    folder.parent.chmod(mode)
    messages = warned(compile_two)
    assert bool(messages) is refused and all(f"other users may write {folder.parent}" in each for each in messages)
    assert bool(list(folder.iterdir())) is not refused


def test_folder_and_entries_are_for_the_user_alone(folder: Path) -> None:
    before = os.umask(0)
    try:
        robot().compile("tau")(*STATE)
    finally:
        os.umask(before)
    (entry,) = entries(folder)
    assert [stat.S_IMODE(path.stat().st_mode) for path in (folder, entry)] == [0o700, 0o600]


@pytest.mark.parametrize("kind", ["pipe", "link", "pipe for a folder"])
def test_what_is_no_file_is_neither_waited_for_nor_followed(folder: Path, kind: str) -> None:
    expected = robot().compile("tau")(*STATE)
    (entry,) = entries(folder)
    if kind == "pipe for a folder":
        for path in (entry, folder):
            path.unlink() if path == entry else path.rmdir()
        os.mkfifo(folder)
        assert len(warned(lambda: np.testing.assert_array_equal(robot().compile("tau")(*STATE), expected))) == 1
        return
    elsewhere = folder.parent / "elsewhere"
    entry.replace(elsewhere)
    os.mkfifo(entry) if kind == "pipe" else entry.symlink_to(elsewhere)
    np.testing.assert_array_equal(robot().compile("tau")(*STATE), expected)
    assert entry.is_file() and not entry.is_symlink() and elsewhere.exists()


def test_a_home_and_a_relative_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path)
    cache._place.cache_clear()
    for named, place in (("~/kernels", tmp_path / "home/kernels"), ("beside", tmp_path / "beside")):
        monkeypatch.setenv(cache.VARIABLE, named)
        robot().compile("tau")(*STATE)
        assert len(entries(place)) == 1
    (tmp_path / "home").mkdir(exist_ok=True)
    monkeypatch.chdir(tmp_path / "home")  # the folder does not move with the process
    assert cache.folder() == tmp_path / "beside"
    cache._place.cache_clear()
    monkeypatch.setenv(cache.VARIABLE, "~nobody_of_that_name/kernels")
    assert len(warned(compile_two)) == 1
    assert {path.name for path in tmp_path.iterdir()} == {"home", "beside"}
