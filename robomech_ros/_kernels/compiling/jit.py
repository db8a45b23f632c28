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
    """Load numba's arrays without scipy's BLAS, which takes 16 MB and 0.15 s; no kernel uses it.

    Numba imports BLAS when its arrays are loaded, and again when a function needs it; only the
    first import is blocked.
    """
    blas = "scipy.linalg.cython_blas"
    if blas in sys.modules or "numba.np.arraymath" in sys.modules:
        return
    sys.modules[blas] = None  # type: ignore[assignment]
    try:
        arrays = import_module("numba.np.arraymath")
    finally:
        del sys.modules[blas]
    # The same flag tells numba whether other compiled code can use np.cov.
    if "_HAVE_BLAS" in vars(arrays):
        vars(arrays)["_HAVE_BLAS"] = find_spec("scipy") is not None


_load_arrays_without_blas()


def kernel(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function for one signature at import, and cache the result on disk.

    Parameters
    ----------
    signature : numba signature
        For example ``i8(IN2, IN1, OUT2)``.

    Returns
    -------
    callable
        Decorator.  If the cache cannot be read or written, the kernel is compiled again, without
        an error.
    """
    return functools.partial(_compiled, signature, {"no_cfunc_wrapper": True})


def part(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function once, as :func:`kernel` does, and link it to the kernels that call it.

    An inline function, in contrast, is compiled again for each kernel.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        return linked(_compiled(signature, _NO_WRAPPERS, function))

    return decorate


def lean_part(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a function as :func:`part` does, if it fulfils the conditions of :func:`lean`."""

    def decorate(function: Callable[..., Any]) -> Any:
        return linked(_compiled(signature, {**_NO_WRAPPERS, **_NO_COUNTS}, function))

    return decorate


def _compiled(signature: Any, options: dict[str, bool], function: Callable[..., Any]) -> Any:
    options = {**_OPTIONS, **options}
    if numba.config.DISABLE_JIT:
        return function
    if cache_directory() is not None:
        # Ignore a damaged or full cache; an error in the kernel itself is raised again below.
        with contextlib.suppress(Exception):
            dispatcher = numba.njit(**options)(function)
            dispatcher._cache = KernelCache(function)
            dispatcher.compile(signature)
            dispatcher.disable_compile()
            return dispatcher
    return numba.njit(signature, **options)(function)


def inline(function: Callable[..., Any]) -> Any:
    """Compile a function together with each kernel that calls it.

    Python cannot call it, which saves a sixth of the time to compile all kernels.  It is compiled
    once for each type, where numba would compile it for each literal number in a call.
    """
    return _inlined(function, {})


def lean(function: Callable[..., Any]) -> Any:
    """Compile a function as :func:`inline` does, if it neither makes arrays nor returns any.

    It then counts no references to arrays and their rows.  In a small function, this would take
    longer than the computation.
    """
    return _inlined(function, _NO_COUNTS)


def flat(function: Callable[..., Any]) -> Any:
    """Compile a function as :func:`lean` does, and inline it in the machine code of its callers.

    This is for frequent calls with many arrays, since each array takes seven words to pass.
    """
    return _inlined(function, {**_NO_COUNTS, "forceinline": True})


def fused(function: Callable[..., Any]) -> Any:
    """Compile a function as :func:`flat` does, and allow fused multiply-add instructions.

    In the body of the caller, the compiler knows that arrays on the stack do not overlap, and
    vectorises loops over them.
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
    """Make a kernel callable from other kernels without compiling it again.

    Numba compiles a function together with everything that it calls, which would take minutes for
    nested kernels.  Instead, the address is found by name when a compiled kernel is loaded.

    Parameters
    ----------
    function : kernel
        Result of :func:`kernel`.

    Returns
    -------
    callable
        Function for other kernels, not for Python.
    """
    if not hasattr(function, "overloads"):
        # NUMBA_DISABLE_JIT is set.
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
    """Return the entry point of a kernel, which does not check the types of its arguments.

    Numba checks each argument to select a compiled version, but a kernel has only one.  For ten
    arguments, this takes half as long as all solutions of an arm.  Arrays must have the type,
    number of axes and contiguity of the signature; violations are not detected.

    Parameters
    ----------
    function : kernel
        Result of :func:`kernel`.

    Returns
    -------
    callable
        Entry point with positional arguments only.
    """
    if not hasattr(function, "overloads"):
        return function
    (compiled,) = function.overloads.values()
    return compiled.entry_point


def _scratch(dtype: Any, plain: Any) -> Any:
    """Return a function with which kernels create small arrays of one type on the stack."""

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


# Small arrays of constant shape on the stack, such as ``scratch(3, 3)``.  They cost nothing, while
# np.empty takes as long as fifty multiplications.  They are invalid after the function returns; in
# a loop, each iteration gets the same array.
scratch = _scratch(f8, numpy.float64)
scratch_integers = _scratch(i8, numpy.int64)


def _borrowed() -> Any:
    """Return a function that borrows an array of the caller without counting references."""

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


# The same array without reference counts: they take two locked instructions for each row used.
borrowed = _borrowed()
