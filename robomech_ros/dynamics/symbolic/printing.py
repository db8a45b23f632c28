"""Symbolic expressions as text, LaTeX or Python source, in the book's abbreviations."""

from __future__ import annotations

import keyword
from collections.abc import Sequence

import sympy
from sympy.printing.numpy import NumPyPrinter

from robomech_ros.dynamics.symbolic.closed_forms import SymbolicModel
from robomech_ros.errors import BadValueError

_NAMES = {
    "forward_kinematics": ("T", "T"),
    "jacobian": ("J", "J"),
    "mass_matrix": ("I", "I"),
    "coriolis_matrix": ("C", "C"),
    "gravity_torque": ("gamma", r"\gamma"),
    "torque": ("tau", r"\tau"),
    "friction_torque": ("delta", r"\delta"),
}


def abbreviated(expression: sympy.Expr) -> tuple[sympy.Expr, dict[sympy.Symbol, sympy.Expr]]:
    """Write cosines and sines of joint angles as c_2, s_23, and of twists as lambda_i, mu_i.

    Parameters
    ----------
    expression : sympy.Expr or sympy.Matrix
        As :class:`SymbolicModel` gives it.

    Returns
    -------
    expression
        Shorter.
    legend : dict
        What each abbreviation stands for; ``c_2_m3`` is of a difference, ``c_22`` of a double.
    """
    functions = sorted(expression.atoms(sympy.cos, sympy.sin), key=str)
    # From the tenth joint on c_12 could be of one joint or of two.
    many = any(len(str(one).split("_")[1]) > 1 for f in functions for one in f.free_symbols)
    legend = {_short(one, "_" if many else ""): one for one in functions}
    replaced = expression.xreplace({one: short for short, one in legend.items()})
    return replaced, legend


def expression_text(model: SymbolicModel, what: str) -> str:
    """Print one of the expressions, an entry a line, with a legend.

    Parameters
    ----------
    model : SymbolicModel
    what : str
        One of ``EXPRESSIONS``.
    """
    expression = model.expression(what)
    matrix, legend = abbreviated(expression)
    used = expression.free_symbols
    name = _NAMES[what][0]
    lines = [
        f"{name}[{', '.join(str(k) for k in place)}] = {entry}"
        for place, entry in _entries(matrix, symmetric=what == "mass_matrix")
    ]
    lines += [f"# {short} = {meant}" for short, meant in legend.items()]
    values = model.parameters.values.items()
    lines += [f"# {symbol} = {value:.10g}" for symbol, value in values if symbol in used]
    return "\n".join(lines)


def expression_latex(model: SymbolicModel, what: str) -> str:
    """Print one of the expressions as an ``align*`` environment of LaTeX.

    Parameters
    ----------
    model, what
        As for :func:`expression_text`.
    """
    matrix, legend = abbreviated(model.expression(what))
    names = {short: _latex_name(short) for short in legend}
    name = _NAMES[what][1]
    lines = []
    for place, entry in _entries(matrix, symmetric=what == "mass_matrix"):
        subscript = "".join(str(k) for k in place)
        lines.append(f"{name}_{{{subscript}}} &= {sympy.latex(entry, symbol_names=names)}")
    body = " \\\\\n".join(lines)
    return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"


def expression_source(model: SymbolicModel, what: str, name: str | None = None) -> str:
    """Print one of the expressions as a Python function of numpy, common terms computed once.

    Parameters
    ----------
    model, what
        As for :func:`expression_text`.
    name : str, optional
        Of the function; default that of the expression.

    Returns
    -------
    str
        Source that needs nothing but numpy.  The joint variables are theta_i and b_i of the table.
    """
    matrix = model.expression(what)
    name = what if name is None else _identifier(name)
    parameters = model.parameters
    used = matrix.free_symbols
    arguments = [*parameters.variables]
    if used & {*parameters.rates, *parameters.accelerations}:
        arguments += parameters.rates
    if used & {*parameters.accelerations}:
        arguments += parameters.accelerations
    common, (reduced,) = sympy.cse(matrix, symbols=sympy.numbered_symbols("x"))
    printer = NumPyPrinter({"fully_qualified_modules": True})
    lines = ["import numpy", "", "", f"def {name}({', '.join(map(str, arguments))}):"]
    lines += [f"    {s} = {v!r}" for s, v in parameters.values.items() if s in used]
    lines += [f"    {symbol} = {printer.doprint(value)}" for symbol, value in common]
    rows = [
        "        [" + ", ".join(printer.doprint(one) for one in reduced.row(i)) + "],"
        for i in range(reduced.rows)
    ]
    return "\n".join([*lines, "    return numpy.array([", *rows, "    ])", ""])


def _entries(
    matrix: sympy.Matrix, *, symmetric: bool
) -> Sequence[tuple[tuple[int, ...], sympy.Expr]]:
    """List entries counted from 1; of a symmetric matrix the upper triangle."""
    rows, columns = matrix.shape
    if columns == 1:
        return [((i + 1,), matrix[i, 0]) for i in range(rows)]
    return [
        ((i + 1, j + 1), matrix[i, j])
        for i in range(rows)
        for j in range(i if symmetric else 0, columns)
    ]


def _short(function: sympy.Expr, separator: str) -> sympy.Symbol:
    angle = function.args[0]
    cosine = isinstance(function, sympy.cos)
    if str(angle).startswith("alpha_"):
        return sympy.Symbol(f"{'lambda' if cosine else 'mu'}_{str(angle)[6:]}", real=True)
    return sympy.Symbol(f"{'c' if cosine else 's'}_{_numbers(angle, separator)}", real=True)


def _numbers(angle: sympy.Expr, separator: str) -> str:
    """Write the joints of a sum of angles: 23 for theta_2 + theta_3, 2_m3 for a difference."""
    terms = sorted(
        (int(str(one).split("_")[1]), int(n)) for one, n in angle.as_coefficients_dict().items()
    )
    parts = [("m" if n < 0 else "") + str(joint) for joint, n in terms for _ in range(abs(n))]
    return ("_" if any(n < 0 for _, n in terms) else separator).join(parts)


def _latex_name(short: sympy.Symbol) -> str:
    head, numbers = str(short).split("_", 1)
    letter = {"lambda": r"\lambda", "mu": r"\mu"}.get(head, head)
    shown = numbers.replace("m", "-").replace("_", ",")
    return f"{letter}_{{{shown}}}"


def _identifier(name: str) -> str:
    if not isinstance(name, str) or not name.isidentifier() or keyword.iskeyword(name):
        raise BadValueError("name", name, "a name of Python's")
    return name


FORMS = {"text": expression_text, "latex": expression_latex, "python": expression_source}
