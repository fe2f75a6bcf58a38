"""What is compiled of a robot: inverse dynamics, and the functions that they are made of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, cast, overload

from numpy.typing import DTypeLike, NDArray

from rttrr_pin.core.arguments import names_of
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.inputs import Coordinates, coordinates, copied
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Payloads, loads_of
from rttrr_pin.core.wrench import RESULTS, LinkWrenches
from rttrr_pin.errors import InputError

if TYPE_CHECKING:  # what few robots are asked for is loaded when one is
    from rttrr_pin.compile import Kernel
    from rttrr_pin.compile.device import DeviceKernel
    from rttrr_pin.exact.enclosures import Enclosures
    from rttrr_pin.exact.parameters import Parameters

OnHost = Literal["llvm", "numpy", "c"]
"""Emitters whose kernels take arrays of the host."""

Outputs = str | tuple[str, ...] | list[str]


class Dynamics:
    """The dynamics of a model; `Robot` says what its arguments are."""

    def __init__(self, model: Model) -> None:
        if not isinstance(model, Model):
            raise InputError(f"model is a {type(model).__name__}: pass a Model; load(...) makes robots of files")
        self._model = model
        self._kernels: dict[object, Kernel[Any]] = {}
        self._device_kernels: dict[object, DeviceKernel] = {}

    @property
    def model(self) -> Model:
        """Its links and joints as data; another model is another robot, `Robot(model)`."""
        return self._model

    def __reduce__(self) -> tuple[object, ...]:
        """The data alone: a copy, or another process, compiles or reads its own kernels."""
        return type(self), (self.model,)

    @property
    def name(self) -> str:
        """The robot's name in its file."""
        return self.model.name

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The moving joints: the last axis of q, v, a and tau."""
        return self.model.joint_names

    @property
    def link_names(self) -> tuple[str, ...]:
        """The links axis of F, N, f, n: every link but the root, which no joint carries."""
        return self.model.link_names

    def inverse_dynamics(
        self, q: Coordinates, v: Coordinates, a: Coordinates, payload: Payloads = None
    ) -> LinkWrenches:
        """Driving forces and all joint loads for given motion, by the Newton-Euler recursion.

            F_i = M_i v_dot_Ci                              (paper, equations 16-22)
            N_i = I_i w_dot_i + w_i x I_i w_i               (23-30)
            f_i = F_i + sum over children c of R_ic f_c     (31-43)
            n_i = N_i + r_Ci x F_i + sum over c of (R_ic n_c + p_ic x R_ic f_c)
            tau_i = n_i (revolute) or f_i (prismatic) along the axis, plus tau_joint (see `JointEffects`)

        A joint that follows another (<mimic>) has no coordinate of its own; what drives it is part of the other's tau,
        times the multiplier.

        It is always compiled code that answers (`compile`), and a state has the same bits alone, in every batch and in
        every layout. The first call compiles, or reads what another process has compiled before.

        Returns:
            tau (..., nv) and F, N, f, n (..., links, 3), the latter in {i}, the frame of each link; `in_convention` of
            the result says f and n as another program does.
        """
        parts = self._kernel(RESULTS)(q, v, a, payload)
        return LinkWrenches.of(parts, self.link_names, self.model.v_names, self.model, copied(q))

    def enclose(
        self,
        q: Coordinates,
        v: Coordinates,
        a: Coordinates,
        payload: Payloads = None,
        parameters: Parameters = "doubles",
    ) -> Enclosures:
        """Enclose the true tau, F, N, f, n between two doubles each, by interval arithmetic at rising precision.

        Every enclosure is proven, and as narrow as doubles allow: one double or two neighbours, except near zero (see
        `rttrr_pin.exact.enclose`). The coordinates are exact doubles. A floating joint's quaternion rotates by the
        matrix that the formula yields, also where its length is 1 only to rounding.

        What is true depends on whose numbers are meant, and the three lie apart: on Panda `"doubles"` and `"read"` do
        in 4 percent of the values, `"read"` and `"text"` in 15 percent. `parameters` names the choice, and the result
        repeats it:

        - `"doubles"`, the default: the numbers that `inverse_dynamics` computes with, rounded rotations and axes
          included. Right for what rounding in the recursion alone does.
        - `"read"`: the doubles nearest to the file's decimals, and everything computed from them exactly. Right where
          programs are judged that read the file themselves; `validate` does it so.
        - `"text"`: the same from the decimals themselves. Right for the robot that the file describes.

        Returns:
            `.tau` (..., nv) and `.F`, `.N`, `.f`, `.n` (..., links, 3), each with `.lower` and `.upper`, in the frames
            and units of `inverse_dynamics`.

        Raises:
            InputError: there are no such parameters: the robot has no file, or was altered since it was read.
        """
        from rttrr_pin.exact.enclosures import enclose

        q, v, a = (coordinates(name, x, self.model.moving) for name, x in (("q", q), ("v", v), ("a", a)))
        return enclose(self.model, q, v, a, loads_of(self.model, payload), parameters)

    @overload
    def compile(self, outputs: Outputs, emitter: Literal["cuda"], *, dtype: DTypeLike = "float64") -> DeviceKernel: ...

    @overload
    def compile(
        self, outputs: Outputs = "tau", *, emitter: Literal["cuda"], dtype: DTypeLike = "float64"
    ) -> DeviceKernel: ...

    @overload
    def compile(self, outputs: str = "tau", emitter: OnHost | None = None) -> Kernel[Array]: ...

    @overload
    def compile(
        self, outputs: tuple[str, ...] | list[str], emitter: OnHost | None = None
    ) -> Kernel[dict[str, Array]]: ...

    @overload
    def compile(
        self, outputs: str = "tau", emitter: OnHost | None = None, *, dtype: DTypeLike
    ) -> Kernel[NDArray[Any]]: ...

    @overload
    def compile(
        self, outputs: tuple[str, ...] | list[str], emitter: OnHost | None = None, *, dtype: DTypeLike
    ) -> Kernel[dict[str, NDArray[Any]]]: ...

    @overload
    def compile(
        self, outputs: Outputs, emitter: str | None, *, dtype: DTypeLike = "float64"
    ) -> Kernel[Any] | DeviceKernel: ...

    def compile(
        self, outputs: str | Sequence[str] = "tau", emitter: str | None = None, *, dtype: DTypeLike = "float64"
    ) -> Kernel[Any] | DeviceKernel:
        """Compile the robot's dynamics for this processor, or for a GPU.

        Args:
            outputs: what to compute, one name or several: `"tau"`, `"F"`, `"N"`, `"f"`, `"n"`, `"tau_joint"`,
                `"mass_matrix"`, `"nonlinear_effects"`, `"gravity_torque"`, `"regressor"`, `"joint_regressor"` (of
                armature and friction), `"link_jacobians"` and `"link_placements"` (of every link: velocity of the
                origin over angular velocity, in {i}; R_0_i and p_0_i), `"dtau_dq"`, `"dtau_dv"`, `"dtau_da"`; and each
                of them with `"_bound"` behind, a bound on its rounding. The fewer, the faster.
            emitter: `"llvm"` (machine code), `"numpy"` (wherever NumPy runs) or `"c"` (by the C compiler);
                None for what is there. `"cuda"` for an NVIDIA GPU, whose kernel takes arrays that lie there.
            dtype: `"float64"`, or `"float32"` for a program that computes in float32 from end to end, with twice the
                lanes, and returns float32. Numbers of the robot are rounded to it once. Its bounds hold for the states
                that it reads: rounding float64 arrays to float32 on the way in is not counted.

        Returns:
            A kernel, `kernel(q, v, a, payload=None, out=None, threads=None)`; on a GPU a `DeviceKernel`, with `stream`
            instead of `threads`.

        Raises:
            UnknownNameError: there is no such output, or no such emitter.
            InputError: no output, or one twice; the emitter cannot be imported, or there is no GPU, or no such type.
        """
        names = names_of("outputs", outputs)
        if emitter is not None and not isinstance(emitter, str):
            raise InputError(f"emitter is {emitter!r}: pass its name, such as 'llvm', or None")
        from rttrr_pin.compile.float_type import float_type

        wanted, own = outputs if isinstance(outputs, str) else names, float_type(dtype).name
        return self._device_kernel(wanted, own) if emitter == "cuda" else self._kernel(wanted, emitter, own)

    def _device_kernel(self, outputs: str | tuple[str, ...], dtype: str) -> DeviceKernel:
        kernel = self._device_kernels.get((outputs, dtype))
        if kernel is None:
            from rttrr_pin.compile.device import DeviceKernel

            kernel = self._device_kernels[outputs, dtype] = DeviceKernel(self.model, outputs, dtype=dtype)
        return kernel

    def _kernel(
        self, outputs: str | tuple[str, ...], emitter: str | None = None, dtype: str = "float64"
    ) -> Kernel[Any]:
        kernel = self._kernels.get((outputs, emitter, dtype))
        if kernel is None:
            from rttrr_pin.compile import Kernel

            kernel = self._kernels[outputs, emitter, dtype] = Kernel(self.model, outputs, emitter, dtype=dtype)
        return kernel

    def mass_matrix(self, q: Coordinates) -> Array:
        """The mass matrix M(q), armature included, (..., nv, nv) [kg m^2, kg m or kg]; symmetric to the last bit.

        tau = M a + nonlinear effects.
        """
        return cast("Array", self._kernel("mass_matrix")(q))

    def nonlinear_effects(self, q: Coordinates, v: Coordinates) -> Array:
        """The driving forces without acceleration, (..., nv) [N m or N]: Coriolis, centrifugal, gravity, friction."""
        return cast("Array", self._kernel("nonlinear_effects")(q, v))

    def gravity_torque(self, q: Coordinates) -> Array:
        """The driving forces that hold the robot still, (..., nv) [N m or N]."""
        return cast("Array", self._kernel("gravity_torque")(q))

    def derivatives(
        self, q: Coordinates, v: Coordinates, a: Coordinates, payload: Payloads = None
    ) -> tuple[Array, Array, Array]:
        """The exact derivatives of the driving forces, by dual numbers.

        Coordinates of planar and floating joints move as their rates say (the tangent, as Pinocchio has it); the
        payload stays as it is in the axes in which it was given; the jump of Coulomb friction at rest is left out.

        Returns:
            d tau / dq, d tau / dv, d tau / da, each (..., nv, nv), row i of tau_i.
        """
        parts = self._kernel(("dtau_dq", "dtau_dv", "dtau_da"))(q, v, a, payload)
        return parts["dtau_dq"], parts["dtau_dv"], parts["dtau_da"]
