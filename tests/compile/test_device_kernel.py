"""The kernel of a GPU, on a card that is played by the CPU: arrays, errors, launches; and what is said without a card."""

from __future__ import annotations

import pickle
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot, Wrench
from rttrr_pin.compile import device
from rttrr_pin.compile.cache import VARIABLE
from rttrr_pin.compile.device import DeviceKernel
from rttrr_pin.compile.emit import cuda, cuda_driver
from rttrr_pin.errors import InputError, NumberError, ShapeError, UnknownNameError
from support.cuda_on_cpu import CpuDriver, OfLibrary, OnCard
from support.serial_chains import random_chain
from support.trees import random_tree

STATES = 150


@pytest.fixture(autouse=True)
def no_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "")


@pytest.fixture(scope="module")
def card() -> CpuDriver:
    return CpuDriver()


@pytest.fixture(scope="module")
def kernel(rttrr: Robot, card: CpuDriver) -> DeviceKernel:
    return DeviceKernel(rttrr.model, "tau", driver=card)


@pytest.fixture(scope="module")
def both(rttrr: Robot, card: CpuDriver) -> DeviceKernel:
    return DeviceKernel(rttrr.model, ("tau", "f"), driver=card)


def states(*batch: int) -> list[np.ndarray]:
    return list(np.random.default_rng(0).uniform(-3, 3, (3, *batch, 5)))


def there(*arrays: np.ndarray) -> list[Any]:
    return [OnCard(x) for x in arrays]


# ---- what comes out


@pytest.mark.parametrize("batch", [(STATES,), (), (1,), (3, 50), (0,), (2, 0)], ids=str)
def test_batches_of_any_shape(kernel: DeviceKernel, rttrr: Robot, batch: tuple[int, ...]) -> None:
    arrays = states(*batch)
    found = kernel(*there(*arrays))
    np.testing.assert_array_equal(found.array, rttrr.compile()(*arrays))
    assert found.array.shape == (*batch, 5)


def test_a_copy_is_a_kernel_of_the_current_card(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cuda, "CudaCore", CpuDriver)
    kernel = rttrr.compile(("tau",), emitter="cuda", dtype="float32")
    assert rttrr.compile(("tau",), emitter="cuda", dtype="float32") is kernel
    again = pickle.loads(pickle.dumps(kernel))
    arrays = there(*(x.astype(np.float32) for x in states(STATES)))
    np.testing.assert_array_equal(again(*arrays)["tau"].array, kernel(*arrays)["tau"].array)


def test_float32(rttrr: Robot, card: CpuDriver) -> None:
    arrays = [x.astype(np.float32) for x in states(STATES)]
    kernel = DeviceKernel(rttrr.model, ("tau", "tau_bound"), "float32", card)
    found, load = kernel(*there(*arrays), payload=Wrench((1.0, 2.0, 3.0))), Wrench((1.0, 2.0, 3.0))
    wanted = rttrr.compile(("tau", "tau_bound"), dtype="float32")(*arrays, payload=load)
    for name, x in found.items():
        assert x.array.dtype == np.float32
        np.testing.assert_array_equal(x.array, wanted[name])
    with pytest.raises(InputError, match=r"numbers of type float64, expected float32"):
        kernel(*there(*states(STATES)))


def test_several_outputs_are_a_dict(both: DeviceKernel, rttrr: Robot) -> None:
    arrays = states(STATES)
    found, wanted = both(*there(*arrays)), rttrr.compile(("tau", "f"))(*arrays)
    assert list(found) == ["tau", "f"]
    for name, x in found.items():
        np.testing.assert_array_equal(x.array, wanted[name])


def test_results_are_arrays_of_the_caller_s_library(kernel: DeviceKernel, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the array standard's namespace, or by the module of the type, as PyTorch's are."""
    q, v, a = states(STATES)
    wanted = kernel(*there(q, v, a)).array
    np.testing.assert_array_equal(kernel(OfLibrary(q), *there(v, a)), wanted)
    monkeypatch.setattr(sys.modules[OnCard.__module__], "from_dlpack", lambda x: x.array, raising=False)
    monkeypatch.setitem(sys.modules, "support", sys.modules[OnCard.__module__])
    np.testing.assert_array_equal(kernel(*there(q, v, a)), wanted)


@pytest.mark.parametrize("order", "CF")
def test_results_go_where_they_are_wanted(both: DeviceKernel, order: Any) -> None:
    arrays = there(*(np.asarray(x, order=order) for x in states(STATES)))
    wanted = both(*arrays)
    f = np.zeros((STATES, 6, 3)) if order == "C" else np.zeros((6, 3, STATES)).transpose(2, 0, 1)
    out = {"f": OnCard(f), "tau": arrays[2]}  # over the accelerations
    assert both(*arrays, out=out) is out
    for name, x in out.items():
        np.testing.assert_array_equal(x.array, wanted[name].array)


def test_one_state_serves_all(kernel: DeviceKernel) -> None:
    q, v, a = states(STATES)
    wanted = kernel(*there(np.tile(q[3], (STATES, 1)), v, a)).array
    for one in (q[3], q[3:4]):
        np.testing.assert_array_equal(kernel(*there(one, v, a)).array, wanted)


def test_payloads(rttrr: Robot, kernel: DeviceKernel) -> None:
    arrays = states(STATES)
    loads = [
        Wrench((1.0, -2.0, 3.0), (0.1, 0.2, -0.3), link="link_5"),
        Wrench(np.arange(3.0 * STATES).reshape(STATES, 3), (3.0, 2.0, 1.0), link="link_3", expressed_in="base"),
    ]
    found = kernel(*there(*arrays), payload=loads).array
    np.testing.assert_array_equal(found, rttrr.compile()(*arrays, payload=loads))


def test_a_call_that_is_bound_follows_its_arrays(kernel: DeviceKernel, card: CpuDriver) -> None:
    q, v, a = states(STATES)
    launch = kernel.bind(*there(q, v, a), out=OnCard(np.zeros((STATES, 5))))
    launched, waited = len(card.launches), card.waits
    q += 0.5
    launch()
    assert (len(card.launches), card.waits) == (launched + 1, waited)
    launch.check()
    assert card.waits == waited + 1
    np.testing.assert_array_equal(launch.out.array, kernel(*there(q, v, a)).array)


def test_most_blocks(kernel: DeviceKernel, card: CpuDriver, monkeypatch: pytest.MonkeyPatch) -> None:
    arrays = there(*states(STATES))
    wanted = kernel(*arrays).array
    assert card.launches[-1] == (2, 128)
    monkeypatch.setattr(device, "BLOCKS", 1)
    np.testing.assert_array_equal(kernel(*arrays).array, wanted)
    assert card.launches[-1] == (1, 128)


# ---- what is reported


def test_the_first_state_that_is_not_finite(kernel: DeviceKernel) -> None:
    q, v, a = states(3, 50)
    v[1, 7, 2], a[2, 0, 0] = np.nan, np.inf
    with pytest.raises(NumberError, match="tau of state 1, 7") as caught:
        kernel(*there(q, v, a))
    assert caught.value.index == (1, 7)
    kernel(*there(q[0], v[0], a[0]))  # the next call is not that one's


def test_a_bound_call_reports_at_its_check(kernel: DeviceKernel) -> None:
    q, v, a = states(STATES)
    launch = kernel.bind(*there(q, v, a))
    launch.check()
    v[4] = np.nan
    launch()
    v[4] = 0.0
    launch()
    with pytest.raises(NumberError, match="state 4"):
        launch.check()
    launch.check()


def test_arrays_of_the_host_are_refused(kernel: DeviceKernel) -> None:
    q, v, a = states(STATES)
    for x in (q, q.tolist(), {"joint_1": 0.0}, "q", object()):
        with pytest.raises(InputError, match=r"cupy.asarray"):
            kernel(x, *there(v, a))
    with pytest.raises(InputError, match="out for tau is an array of the host"):
        kernel(*there(q, v, a), out=np.zeros((STATES, 5)))
    with pytest.raises(InputError, match="arrays of the GPU"):
        cuda.CudaFunction(None).bind([q], [q])


def test_arguments_that_are_missing_or_too_many(kernel: DeviceKernel, rttrr: Robot, card: CpuDriver) -> None:
    q, v, _ = there(*states(STATES))
    with pytest.raises(InputError, match="a is missing"):
        kernel(q, v)
    with pytest.raises(InputError, match="v was passed"):
        DeviceKernel(rttrr.model, "mass_matrix", driver=card)(q, v)
    with pytest.raises(InputError, match="does not depend on it"):
        DeviceKernel(rttrr.model, "mass_matrix", driver=card)(q, payload=Wrench((1.0, 0.0, 0.0)))


def test_arrays_that_do_not_fit(kernel: DeviceKernel, both: DeviceKernel) -> None:
    q, v, a = states(STATES)
    for bad in (q[:, :4], q[:7], q[None], q[0, 0]):
        with pytest.raises(ShapeError, match="v has shape"):
            kernel(OnCard(q), OnCard(np.asarray(bad)), OnCard(a))
    with pytest.raises(InputError, match=r"numbers of type float32, expected float64"):
        kernel(*there(q.astype(np.float32), v, a))
    with pytest.raises(InputError, match="is on GPU 3, expected 0"):
        kernel(OnCard(q, device=3), *there(v, a))
    uneven = np.zeros((3, 60, 5))[:, :50]
    with pytest.raises(InputError, match="even distances"):
        kernel(*there(uneven, np.zeros((3, 50, 5)), np.zeros((3, 50, 5))))
    with pytest.raises(ShapeError, match="out for tau has shape"):
        kernel(*there(q, v, a), out=OnCard(np.zeros((STATES, 4))))
    with pytest.raises(InputError, match="cannot be written"):
        kernel(*there(q, v, a), out=OnCard(np.zeros((STATES, 5)), writable=False))
    with pytest.raises(InputError, match="a dict with an array for each of tau, f"):
        both(*there(q, v, a), out={"tau": OnCard(q)})


def test_results_over_what_is_still_read_are_refused(kernel: DeviceKernel, both: DeviceKernel) -> None:
    q, v, a = states(STATES)
    long = np.zeros((STATES + 1, 5))
    with pytest.raises(InputError, match="out for tau shares memory with a"):
        kernel(*there(q, v, long[1:]), out=OnCard(long[:-1]))
    with pytest.raises(InputError, match="out for tau shares memory with a"):
        kernel(*there(q, v, a), out=OnCard(a[::-1]))
    wide = np.zeros((STATES, 18))
    with pytest.raises(InputError, match="out for f shares memory with tau"):
        both(*there(q, v, a), out={"tau": OnCard(wide[:, :5]), "f": OnCard(wide.reshape(STATES, 6, 3))})


def test_a_robot_that_is_too_large(card: CpuDriver) -> None:
    robot = rttrr_pin.load(random_chain(0, ("revolute",) * 120))
    x = OnCard(np.zeros((1, 120)))
    with pytest.raises(InputError, match="too many operations for one thread of a GPU.*emitter='llvm'"):
        DeviceKernel(robot.model, "tau", driver=card)(x, x, x)


def test_a_program_that_is_too_long(rttrr: Robot, card: CpuDriver, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cuda, "LONGEST", 100)  # bounds and derivatives are straight lines however long they are
    with pytest.raises(InputError, match="tau_bound of this robot takes too many operations"):
        DeviceKernel(rttrr.model, "tau_bound", driver=card)(*there(*states(1)))


def test_outputs_are_checked_at_once(rttrr: Robot, card: CpuDriver) -> None:
    with pytest.raises(UnknownNameError, match="no output is called 'torque'"):
        DeviceKernel(rttrr.model, "torque", driver=card)


# ---- without a card


def test_without_cuda_core_it_is_said_what_to_install(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cuda", None)
    with pytest.raises(InputError, match=r"pip install 'rttrr-pin\[cuda\]'"):
        rttrr.compile(emitter="cuda")


class NoCard:
    """Of a module cuda.core without a driver."""

    class core:  # noqa: N801
        @staticmethod
        def Device() -> None:
            raise RuntimeError("no driver\nlibrary")


def test_without_a_card_it_is_said(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cuda", NoCard)
    monkeypatch.setitem(sys.modules, "cuda.bindings", type("bindings", (), {"nvrtc": None}))
    with pytest.raises(InputError, match=r"no NVIDIA GPU \(no driver library\).*nvidia-smi"):
        rttrr.compile("tau", "cuda")


def test_the_source_needs_neither(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cuda", None)
    text = rttrr.compile().source("cuda")
    assert "rttrr_tau(long long states, const double *q" in text
    assert "q[5] [rad or m]: joint_1, " in text[: text.index("*/")]
    assert max(map(len, text[: text.index("*/")].splitlines())) <= 120


def test_a_name_cannot_leave_the_comment() -> None:
    robot = rttrr_pin.load(random_tree(1, 2, types=("revolute",), mimics=False))
    text = cuda.emitter().source(robot.compile().program, '9 */ int x; /*\\\n"', {"q": ["??/ */"]})
    assert text.count("*/") == 1 and text.isascii()


def test_importing_the_package_imports_no_cuda() -> None:
    code = "import sys, rttrr_pin; rttrr_pin.load('rttrr').compile(); sys.exit('cuda' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.cuda
@pytest.mark.parametrize("outputs", ["tau", ("tau", "tau_bound"), "regressor"], ids=str)
def test_nvrtc_compiles_it_without_a_card(rttrr: Robot, outputs: str | tuple[str, ...]) -> None:
    """With the names and options of cuda-core that the driver uses."""
    assert cuda_driver.compiled(rttrr.compile(outputs).source("cuda"), "sm_90").startswith(b"\x7fELF")
