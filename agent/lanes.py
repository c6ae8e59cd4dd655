"""Numbers side by side: within a kernel, one value that holds ``WIDTH`` numbers, one in each lane.

A loop whose steps wait for each other leaves most of a processor idle. ``WIDTH`` such loops side by side, a
lane each, take little more time than one, as long as they take the same branches: what one lane does alone
is chosen with ``where``. Compiled, the lanes are one vector of the processor, or several; in Python an array
(``WIDTH``,), on which the same functions work, so that a kernel's source is its own slow version.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.base import BaseContext
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, Signature, infer_global, signature
from numba.extending import models, register_model
from numpy.typing import NDArray

Lanes = NDArray[np.float64]
"""One number a lane, (``WIDTH``,)."""
Mask = NDArray[np.bool_]
"""One truth a lane, (``WIDTH``,)."""
Rows = NDArray[np.float64]
"""Lanes in each row, contiguous, (k, ``WIDTH``)."""

WIDTH = 16
"""Lanes: two registers of AVX-512, four of AVX2. Eight take a quarter more time on both, as steps that wait
for each other then have less beside them."""


def splat(number: float) -> Lanes:
    """Return lanes that all hold one number."""
    return np.full(WIDTH, number)


def no_lane() -> Mask:
    """Return a mask that is true in no lane."""
    return np.zeros(WIDTH, dtype=np.bool_)


def all_lanes() -> Mask:
    """Return a mask that is true in all lanes."""
    return np.ones(WIDTH, dtype=np.bool_)


def load(rows: Rows, row: int) -> Lanes:
    """Return a row as lanes."""
    return np.array(rows[row])


def store(rows: Rows, row: int, lanes: Lanes) -> None:
    """Write lanes into a row."""
    rows[row] = lanes


def where(mask: Mask, one: Lanes | float, other: Lanes | float) -> Lanes:
    """Return ``one`` in the lanes where the mask is true, ``other`` in the others."""
    return np.asarray(np.where(mask, one, other))


def fused(one: Lanes | float, other: Lanes | float, addend: Lanes | float) -> Lanes:
    """Return ``one`` times ``other`` plus ``addend``, rounded once where the processor can."""
    return np.asarray(one * other + addend)


def choose(mask: Mask, one: Mask, other: Mask) -> Mask:
    """Return what ``where`` does, of masks."""
    return np.where(mask, one, other)


def any_of(mask: Mask) -> bool:
    """Return whether the mask is true in a lane."""
    return bool(mask.any())


def smaller(one: Lanes | float, other: Lanes | float) -> Lanes:
    """Return the smaller number in each lane."""
    return np.asarray(np.minimum(one, other))


def larger(one: Lanes | float, other: Lanes | float) -> Lanes:
    """Return the larger number in each lane."""
    return np.asarray(np.maximum(one, other))


def least_of(lanes: Lanes) -> float:
    """Return the least number of all lanes; none may be NaN."""
    return float(lanes.min())


def most_of(lanes: Lanes) -> float:
    """Return the largest number of all lanes; none may be NaN."""
    return float(lanes.max())


def exp(exponent: Lanes) -> Lanes:
    """Return the exponential of numbers within +-700, to two units of the last place."""
    return np.asarray(np.exp(exponent))


def log(number: Lanes) -> Lanes:
    """Return the natural logarithm of numbers from 1e-300 to 1e300, to two units of the last place."""
    return np.asarray(np.log(number))


# What follows describes the same to numba: the types, then each operation as instructions of LLVM.

_NUMBER, _BITS, _PLACE = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_LANES, _LANES_OF_BITS = ir.VectorType(_NUMBER, WIDTH), ir.VectorType(_BITS, WIDTH)
_MASK = ir.VectorType(ir.IntType(1), WIDTH)

EXP_TERMS = 12
"""Of Taylor's series of exp up to ln(2)/2: the next is below the last bit."""
LOG_TERMS = 9
"""Of the series of log in ((x - 1)/(x + 1))^2, sqrt(1/2) < x < sqrt(2), likewise."""
LN2, REST_OF_LN2 = 6.93147180369123816490e-01, 1.90821492927058770002e-10
"""ln 2 in two parts, the first with trailing zeros, so that its multiples are exact (FreeBSD's msun)."""
ROUNDS, ROUNDS_BITS = 1.5 * 2.0**52, 0x4338 << 48
"""A number added to it becomes an integer, whose bits are then the last ones of the sum; its own bits."""
MANTISSA, SQRT_HALF_BITS = 52, 0x3FE6A09E667F3BCD
"""Bits of a mantissa, above which the exponent stands; all bits of sqrt(1/2)."""


Emit = Callable[..., ir.Value]


class LanesType(types.Type):  # type: ignore[misc]  # numba has no types
    """The type of ``Lanes`` in numba."""


class MaskType(types.Type):  # type: ignore[misc]  # likewise
    """The type of ``Mask`` in numba."""


LANES, MASK = LanesType("Lanes"), MaskType("Mask")
ROWS = types.Array(types.float64, 2, "C")
ALIGNED = 8
"""Bytes to which an array of doubles is aligned at least."""


def _model(vector: object) -> type:
    class OfVector(models.PrimitiveModel):  # type: ignore[misc]  # likewise
        def __init__(self, manager: object, kind: object) -> None:
            super().__init__(manager, kind, vector)

    return OfVector


register_model(LanesType)(_model(_LANES))
register_model(MaskType)(_model(_MASK))


def _define(function: object, result: object, arguments: Sequence[object], emit: Emit) -> None:
    """Let kernels call a function.

    Args:
        function: Or an operator.
        result: Its type.
        arguments: Their types. A number in place of lanes is that number in each of them.
        emit: Writes the instructions; takes the builder and the arguments, of rows their first element.
    """
    numbers = [(each, types.float64) if each is LANES else (each,) for each in arguments]
    known = {each for each in product(*numbers) if LANES in each or MASK in each or LANES not in arguments}

    class Template(AbstractTemplate):  # type: ignore[misc]  # likewise
        def generic(self, args: Sequence[object], _: object) -> object:
            given = tuple(map(_taken, args, arguments)) if len(args) == len(arguments) else None
            return signature(result, *given) if given in known else None

    def lower(
        context: BaseContext, builder: ir.IRBuilder, of: Signature, args: Sequence[ir.Value]
    ) -> ir.Value:
        ready = [
            context.make_array(ROWS)(context, builder, each).data
            if wanted == ROWS
            else _splat(builder, each)
            if wanted is LANES and given != LANES
            else each
            for each, given, wanted in zip(args, of.args, arguments, strict=True)
        ]
        written = emit(builder, *ready)
        return context.get_dummy_value() if result is types.void else written

    infer_global(function)(Template)
    for each in known:
        lower_builtin(function, *each)(lower)


def _taken(given: object, wanted: object) -> object:
    """Return the type as which an argument is taken."""
    if wanted is LANES and isinstance(given, types.Number):
        return types.float64
    return types.intp if wanted is types.intp and isinstance(given, types.Integer) else given


def _splat(builder: ir.IRBuilder, number: ir.Value) -> ir.Value:
    first = builder.insert_element(ir.Constant(_LANES, ir.Undefined), number, ir.Constant(_PLACE, 0))
    places = ir.Constant(ir.VectorType(_PLACE, WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(first, ir.Constant(_LANES, ir.Undefined), places)


def _all(number: float) -> ir.Constant:
    return ir.Constant(_LANES, [float(number)] * WIDTH)


def _all_bits(number: int) -> ir.Constant:
    return ir.Constant(_LANES_OF_BITS, [number] * WIDTH)


def _intrinsic(builder: ir.IRBuilder, name: str, result: ir.Type, *args: ir.Value) -> ir.Value:
    kind = ir.FunctionType(result, [each.type for each in args])
    return builder.call(
        cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{WIDTH}f64"), args
    )


def _product_and_sum(builder: ir.IRBuilder, one: ir.Value, other: ir.Value, addend: ir.Value) -> ir.Value:
    """One times other plus addend; not ``fma``, which is a call for each lane where a processor has none."""
    return _intrinsic(builder, "fmuladd", _LANES, one, other, addend)


def _exp(builder: ir.IRBuilder, x: ir.Value) -> ir.Value:
    """2^n exp(r), with n = x / ln 2 rounded: n goes into the exponent's bits."""
    sum_ = _product_and_sum(builder, x, _all(1 / math.log(2)), _all(ROUNDS))
    n = builder.fsub(sum_, _all(ROUNDS))
    r = _product_and_sum(builder, n, _all(-LN2), x)
    r = _product_and_sum(builder, n, _all(-REST_OF_LN2), r)
    total = _all(1 / math.factorial(EXP_TERMS))
    for term in range(EXP_TERMS - 1, -1, -1):
        total = _product_and_sum(builder, total, r, _all(1 / math.factorial(term)))
    times = builder.shl(builder.bitcast(sum_, _LANES_OF_BITS), _all_bits(MANTISSA))
    return builder.bitcast(builder.add(builder.bitcast(total, _LANES_OF_BITS), times), _LANES)


def _log(builder: ir.IRBuilder, x: ir.Value) -> ir.Value:
    """N ln 2 + log(m) with x = 2^n m, m from sqrt(1/2) to sqrt(2): 2 artanh((m - 1) / (m + 1))."""
    bits = builder.bitcast(x, _LANES_OF_BITS)
    above = builder.sub(bits, _all_bits(SQRT_HALF_BITS))
    m = builder.bitcast(builder.sub(bits, builder.and_(above, _all_bits(-1 << MANTISSA))), _LANES)
    n = builder.add(builder.ashr(above, _all_bits(MANTISSA)), _all_bits(ROUNDS_BITS))
    n = builder.fsub(builder.bitcast(n, _LANES), _all(ROUNDS))
    s = builder.fdiv(builder.fsub(m, _all(1)), builder.fadd(m, _all(1)))
    square = builder.fmul(s, s)
    total = _all(2 / (2 * LOG_TERMS + 1))
    for term in range(LOG_TERMS - 1, 0, -1):
        total = _product_and_sum(builder, total, square, _all(2 / (2 * term + 1)))
    result = _product_and_sum(builder, builder.fmul(total, square), s, builder.fmul(s, _all(2)))
    result = _product_and_sum(builder, n, _all(REST_OF_LN2), result)
    return _product_and_sum(builder, n, _all(LN2), result)


def _any(builder: ir.IRBuilder, mask: ir.Value) -> ir.Value:
    whole = ir.IntType(WIDTH)
    return builder.icmp_unsigned("!=", builder.bitcast(mask, whole), ir.Constant(whole, 0))


_ARITHMETIC = {"add": "fadd", "sub": "fsub", "mul": "fmul", "truediv": "fdiv"}
_COMPARISONS = {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!="}
for _name, _op in _ARITHMETIC.items():
    _define(getattr(operator, _name), LANES, (LANES, LANES), lambda b, x, y, op=_op: getattr(b, op)(x, y))
for _name, _op in _COMPARISONS.items():
    _define(getattr(operator, _name), MASK, (LANES, LANES), lambda b, x, y, op=_op: b.fcmp_ordered(op, x, y))
_define(operator.neg, LANES, (LANES,), lambda b, x: b.fneg(x))
_define(operator.and_, MASK, (MASK, MASK), lambda b, x, y: b.and_(x, y))
_define(operator.or_, MASK, (MASK, MASK), lambda b, x, y: b.or_(x, y))
_define(operator.invert, MASK, (MASK,), lambda b, x: b.not_(x))
_define(splat, LANES, (types.float64,), _splat)
_define(no_lane, MASK, (), lambda _: ir.Constant(_MASK, [0] * WIDTH))
_define(all_lanes, MASK, (), lambda _: ir.Constant(_MASK, [1] * WIDTH))
_define(where, LANES, (MASK, LANES, LANES), lambda b, m, x, y: b.select(m, x, y))
_define(choose, MASK, (MASK, MASK, MASK), lambda b, m, x, y: b.select(m, x, y))
_define(any_of, types.boolean, (MASK,), _any)
_define(fused, LANES, (LANES, LANES, LANES), _product_and_sum)
_define(smaller, LANES, (LANES, LANES), lambda b, x, y: b.select(b.fcmp_ordered("<", x, y), x, y))
_define(larger, LANES, (LANES, LANES), lambda b, x, y: b.select(b.fcmp_ordered(">", x, y), x, y))
_define(least_of, types.float64, (LANES,), lambda b, x: _intrinsic(b, "vector.reduce.fmin", _NUMBER, x))
_define(most_of, types.float64, (LANES,), lambda b, x: _intrinsic(b, "vector.reduce.fmax", _NUMBER, x))
_define(exp, LANES, (LANES,), _exp)
_define(log, LANES, (LANES,), _log)


def _row(builder: ir.IRBuilder, first: ir.Value, row: ir.Value) -> ir.Value:
    place = builder.gep(first, [builder.mul(row, ir.Constant(row.type, WIDTH))])
    return builder.bitcast(place, _LANES.as_pointer())


_define(load, LANES, (ROWS, types.intp), lambda b, x, row: b.load(_row(b, x, row), align=ALIGNED))
_define(
    store, types.void, (ROWS, types.intp, LANES), lambda b, x, row, y: b.store(y, _row(b, x, row), ALIGNED)
)
