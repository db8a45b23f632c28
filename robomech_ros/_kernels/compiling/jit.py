"""The decorators of all kernels."""

import contextlib
import functools
import math
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import llvmlite.binding
import llvmlite.ir
import numba
import numpy
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

from robomech_ros._kernels.compiling.cache import KernelCache, cache_directory as cache_directory
from robomech_ros._kernels.compiling.types import f8, i8

_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": False}
_NO_WRAPPERS = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_NO_COUNTS = {"_nrt": False}


def _load_arrays_without_blas() -> None:
    """Load numba's arrays without scipy's BLAS, which no kernel uses: 16 MB and 0.15 s.

    Numba looks for it when its arrays are loaded, and again when something needs it; only the
    first look is kept from finding it.
    """
    blas = "scipy.linalg.cython_blas"
    if blas in sys.modules or "numba.np.arraymath" in sys.modules:
        return
    sys.modules[blas] = None  # type: ignore[assignment]
    try:
        arrays = import_module("numba.np.arraymath")
    finally:
        del sys.modules[blas]
    # This decision of numba also sets whether other compiled code gets np.cov.
    if "_HAVE_BLAS" in vars(arrays):
        vars(arrays)["_HAVE_BLAS"] = find_spec("scipy") is not None


_load_arrays_without_blas()


def kernel(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function for one signature, at import, with the result kept on disk.

    Parameters
    ----------
    signature : numba signature
        For example ``i8(IN2, IN1, OUT2)``.

    Returns
    -------
    callable
        Decorator.  A cache that cannot be read or written costs the compile time again, never
        an error.
    """
    return functools.partial(_compiled, signature, {"no_cfunc_wrapper": True})


def part(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a part of kernels by itself, as :func:`kernel` does; only kernels can call it.

    To link it costs them nothing, while what is inline is compiled again in each of them.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        return linked(_compiled(signature, _NO_WRAPPERS, function))

    return decorate


def lean_part(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a part of kernels that makes no arrays, as :func:`lean` wants it."""

    def decorate(function: Callable[..., Any]) -> Any:
        return linked(_compiled(signature, {**_NO_WRAPPERS, **_NO_COUNTS}, function))

    return decorate


def _compiled(signature: Any, options: dict[str, bool], function: Callable[..., Any]) -> Any:
    options = {**_OPTIONS, **options}
    if numba.config.DISABLE_JIT:
        return function
    if cache_directory() is not None:
        # A damaged or full cache; a mistake in the kernel itself is raised again below.
        with contextlib.suppress(Exception):
            dispatcher = numba.njit(**options)(function)
            dispatcher._cache = KernelCache(function)
            dispatcher.compile(signature)
            dispatcher.disable_compile()
            return dispatcher
    return numba.njit(signature, **options)(function)


def inline(function: Callable[..., Any]) -> Any:
    """Compile a function that only kernels call, together with each of them.

    It has no entry from Python, which saves a sixth of the time that all kernels take.  It is
    compiled for types only: numba would make one for every number that stands in a call.
    """
    return _inlined(function, {})


def lean(function: Callable[..., Any]) -> Any:
    """Compile a function as :func:`inline` does, if it neither makes arrays nor returns any.

    It then counts no references to its arrays and their rows, which for a small one takes longer
    than what it computes.
    """
    return _inlined(function, _NO_COUNTS)


def flat(function: Callable[..., Any]) -> Any:
    """Compile a function as :func:`lean` does, as a part of each function that calls it.

    That is for frequent calls with many arrays: each array is seven words to hand over.
    """
    return _inlined(function, {**_NO_COUNTS, "forceinline": True})


def fused(function: Callable[..., Any]) -> Any:
    """Compile a function as :func:`flat` does; a product that is added may be rounded with the sum.

    In the body of its caller the compiler sees that arrays on the stack do not overlap, and makes
    vector instructions of loops over them; most processors have one for a product and a sum.
    """
    return _inlined(function, {**_NO_COUNTS, "forceinline": True, "fastmath": {"contract"}})


def _inlined(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    dispatcher = numba.njit(**{**_NO_WRAPPERS, **_OPTIONS, **options})(function)
    if hasattr(dispatcher, "get_call_template"):
        of_types = dispatcher.get_call_template

        def without_literals(args: Any, kws: Any) -> Any:
            plain = {name: types.unliteral(kind) for name, kind in kws.items()}
            return of_types(tuple(types.unliteral(kind) for kind in args), plain)

        dispatcher.get_call_template = without_literals
    return dispatcher


def linked(function: Any) -> Any:
    """Make a kernel callable in other kernels without becoming a part of them.

    Numba compiles all that a function calls anew, together with it; a kernel that calls kernels
    that call kernels would take minutes.  Instead the address is found by name when a compiled
    kernel is loaded.

    Parameters
    ----------
    function : kernel
        What :func:`kernel` has made.

    Returns
    -------
    callable
        For other kernels, not for Python.
    """
    if not hasattr(function, "overloads"):
        # Not compiled at all, as NUMBA_DISABLE_JIT wants it.
        return function
    (compiled,) = function.overloads.values()
    name = f"robomech.{function.__module__}.{function.__name__}"
    address = compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name)
    llvmlite.binding.add_symbol(name, address)
    wanted = compiled.signature

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        (given,) = signature.args
        values = [
            context.cast(builder, value, have, want)
            for value, have, want in zip(
                cgutils.unpack_tuple(builder, args[0]), given, wanted.args, strict=True
            )
        ]
        kind = context.call_conv.get_function_type(wanted.return_type, wanted.args)
        callee = cgutils.get_or_insert_function(builder.module, kind, name)
        status, result = context.call_conv.call_function(
            builder, callee, wanted.return_type, wanted.args, values
        )
        with cgutils.if_unlikely(builder, status.is_error):
            context.call_conv.return_status_propagate(builder, status)
        return result

    @intrinsic
    def call(typing_context: Any, *args: Any) -> Any:
        return wanted.return_type(types.StarArgTuple.from_types(args)), generate

    return call


def direct(function: Any) -> Any:
    """Return the entry of a kernel that Python calls without a look at the types of the arguments.

    Numba looks at each to choose among the versions compiled, of which a kernel has one; for ten
    arguments that takes as long as half the solutions of an arm.  Arrays must be of the type and
    number of axes that the signature says, and contiguous where it says so: nothing tells
    otherwise.

    Parameters
    ----------
    function : kernel
        What :func:`kernel` has made.

    Returns
    -------
    callable
        Takes positional arguments only.
    """
    if not hasattr(function, "overloads"):
        return function
    (compiled,) = function.overloads.values()
    return compiled.entry_point


def _scratch(dtype: Any, plain: Any) -> Any:
    """Make the function that gives kernels small arrays of one type on the stack."""

    def generate_array(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        kind = signature.return_type
        (given,) = signature.args
        shape = [length.literal_value for length in given]
        item = context.get_data_type(dtype)
        size = context.get_abi_sizeof(item)
        word = context.get_value_type(types.intp)
        room = cgutils.alloca_once(builder, llvmlite.ir.ArrayType(item, math.prod(shape)))
        array = make_array(kind)(context, builder)
        strides = [size * math.prod(shape[i + 1 :]) for i in range(len(shape))]
        populate_array(
            array,
            data=builder.bitcast(room, array.data.type),
            shape=cgutils.pack_array(builder, [word(length) for length in shape]),
            strides=cgutils.pack_array(builder, [word(stride) for stride in strides]),
            itemsize=word(size),
            meminfo=None,
        )
        return array._getvalue()

    @intrinsic(prefer_literal=True)
    def scratch(typing_context: Any, *shape: Any) -> Any:
        kind = types.Array(dtype, len(shape), "C")
        return kind(types.StarArgTuple.from_types(shape)), generate_array

    if numba.config.DISABLE_JIT:
        return lambda *shape: numpy.empty(shape, plain)
    return scratch


# Small arrays of constant shape, given as separate numbers or names of such: ``scratch(3, 3)``.
# They stand on the stack, which costs nothing, where np.empty takes as long as fifty
# multiplications, and are gone when the function that asked for them returns.  In a loop it is
# the same array every time.
scratch = _scratch(f8, numpy.float64)
scratch_integers = _scratch(i8, numpy.int64)


def _borrowed() -> Any:
    """Make the function that takes an array of a caller without counting references to it."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        array = make_array(signature.return_type)(context, builder, args[0])
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()

    @intrinsic
    def borrowed(typing_context: Any, array: Any) -> Any:
        return array(array), generate

    if numba.config.DISABLE_JIT:
        return lambda array: array
    return borrowed


# The same array, for the time of the call: what counts references to its rows is two locked
# instructions for each row that is looked at.
borrowed = _borrowed()
