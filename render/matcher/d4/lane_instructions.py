"""Vectors of 16-bit lanes inside compiled functions: one value holds a number for every disparity of a pixel.

Numba has no such type, and LLVM's vectoriser neither keeps a pixel's lanes in registers from one step to the next nor
uses the widest vectors. Written out, they become the vector instructions of whatever processor is there, whole or in
parts; the results are the same everywhere. All arithmetic wraps at 16 bits.
"""

from collections.abc import Callable
from typing import Any, no_type_check

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from render.matcher.d4.lane_types import PART, WORD, Lanes, Marks, places

_INDEX = ir.IntType(64)


@no_type_check
def _constant(n, numbers):
    return ir.Constant(ir.VectorType(WORD, n), list(numbers))


@no_type_check
def _order(sources):
    """Which element of two vectors comes at each place of a shuffled one."""
    return ir.Constant(ir.VectorType(ir.IntType(32), len(sources)), sources)


@no_type_check
def _spread(builder, word, n):
    """A vector with the same number in all lanes."""
    vector = ir.VectorType(WORD, n)
    first = builder.insert_element(ir.Constant(vector, ir.Undefined), word, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(first, first, _order([0] * n))


@no_type_check
def _call(builder, name, args, result):
    """One of LLVM's intrinsic functions on a single vector."""
    function = builder.module.declare_intrinsic(name, (), ir.FunctionType(result, [args[0].type]))
    return builder.call(function, args)


@no_type_check
def _pointer(context, builder, kind, array, first, n):
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [first]), ir.VectorType(WORD, n).as_pointer())


@no_type_check
def _lane_numbers(typingctx, n):
    """0, 1, 2 ... n - 1; `n` is a constant."""
    count = n.literal_value

    def emit(context, builder, signature, args):
        return _constant(count, sorted(range(count), key=places(count).__getitem__))

    return Lanes(count)(n), emit


@no_type_check
def _spread_word(typingctx, word, like):
    """`word` in all lanes, as many as `like` has."""

    def emit(context, builder, signature, args):
        return _spread(builder, args[0], like.n)

    return Lanes(like.n)(types.int16, like), emit


@no_type_check
def _load(typingctx, array, first, like):
    """Lanes in the order of their places from array[first] on, as many as `like` has."""

    def emit(context, builder, signature, args):
        return builder.load(_pointer(context, builder, array, args[0], args[1], like.n), align=2)

    return Lanes(like.n)(array, types.uint64, like), emit


@no_type_check
def _load_dealt(typingctx, array, row, pitch, first, like):
    """Numbers first, first + 1 ... of a row that has been dealt out to the parts.

    Number i is array[row + i mod p * pitch + i // p], p the number of parts.
    """
    parts = like.n // PART

    def emit(context, builder, signature, args):
        deck, joined = ir.Constant(_INDEX, parts), _constant(like.n, [0] * like.n)
        for part in range(parts):
            number = builder.add(args[3], ir.Constant(_INDEX, part))
            at = builder.add(args[1], builder.mul(builder.urem(number, deck), args[2]))
            at = builder.add(at, builder.udiv(number, deck))
            loaded = builder.load(_pointer(context, builder, array, args[0], at, PART), align=2)
            repeated = builder.shuffle_vector(loaded, loaded, _order([i % PART for i in range(like.n)]))
            keep = _order([like.n + i if i // PART == part else i for i in range(like.n)])
            joined = builder.shuffle_vector(joined, repeated, keep)
        return joined

    index = types.uint64
    return Lanes(like.n)(array, index, index, index, like), emit


@no_type_check
def _store(typingctx, array, first, lanes):
    """Write lanes in the order of their places from array[first] on."""

    def emit(context, builder, signature, args):
        builder.store(args[2], _pointer(context, builder, array, args[0], args[1], lanes.n), align=2)
        return context.get_dummy_value()

    return types.void(array, types.uint64, lanes), emit


@no_type_check
def _of_two(name: str) -> Callable[..., Any]:
    """An instruction of the builder on two vectors, or on a vector and a number for all lanes."""

    def typed(typingctx, a, b):
        def emit(context, builder, signature, args):
            second = args[1] if b == a else _spread(builder, args[1], a.n)
            return getattr(builder, name)(args[0], second)

        return a(a, b if b == a else types.int16), emit

    typed.__name__ = name
    return typed


@no_type_check
def _comparison(sign: str) -> Callable[..., Any]:
    def typed(typingctx, a, b):
        def emit(context, builder, signature, args):
            second = args[1] if b == a else _spread(builder, args[1], a.n)
            return builder.icmp_signed(sign, args[0], second)

        return Marks(a.n)(a, b if b == a else types.int16), emit

    return typed


@no_type_check
def _is_among(typingctx, a, count):
    """Whether a lane holds one of 0, 1 ... count - 1."""

    def emit(context, builder, signature, args):
        return builder.icmp_unsigned("<", args[0], _spread(builder, args[1], a.n))

    return Marks(a.n)(a, types.int16), emit


@no_type_check
def _minimum(typingctx, a, b):
    """Lower number of each lane."""

    def emit(context, builder, signature, args):
        return builder.select(builder.icmp_signed("<", args[0], args[1]), args[0], args[1])

    return a(a, b), emit


@no_type_check
def _choose(typingctx, marks, a, b):
    """`a` where marked, else `b`, each a vector or a number for all lanes."""
    kinds = [kind if isinstance(kind, Lanes) else types.int16 for kind in (a, b)]

    def emit(context, builder, signature, args):
        pairs = zip(args[1:], kinds, strict=True)
        options = [arg if isinstance(kind, Lanes) else _spread(builder, arg, marks.n) for arg, kind in pairs]
        return builder.select(args[0], *options)

    return Lanes(marks.n)(marks, *kinds), emit


@no_type_check
def _count_bits(typingctx, a):
    """Number of set bits of each lane."""

    def emit(context, builder, signature, args):
        return _call(builder, f"llvm.ctpop.v{a.n}i16", args, args[0].type)

    return a(a), emit


@no_type_check
def _upper_product(typingctx, a, b):
    """Upper 16 bits of the 32-bit product of two lanes, or of a lane and a number."""

    def emit(context, builder, signature, args):
        wide = ir.VectorType(ir.IntType(32), a.n)
        second = args[1] if b == a else _spread(builder, args[1], a.n)
        product = builder.mul(builder.sext(args[0], wide), builder.sext(second, wide))
        return builder.trunc(builder.lshr(product, ir.Constant(wide, [16] * a.n)), ir.VectorType(WORD, a.n))

    return a(a, b if b == a else types.int16), emit


@no_type_check
def _shifted(by: int) -> Callable[..., Any]:
    def typed(typingctx, a, fill):
        def emit(context, builder, signature, args):
            order, place = [a.n] * a.n, places(a.n)
            for lane in range(max(0, -by), min(a.n, a.n - by)):
                order[place[lane]] = place[lane + by]
            return builder.shuffle_vector(args[0], _spread(builder, args[1], a.n), _order(order))

        return a(a, types.int16), emit

    return typed


@no_type_check
def _lowest(typingctx, a):
    """Lowest number of all lanes."""

    def emit(context, builder, signature, args):
        return _call(builder, f"llvm.vector.reduce.smin.v{a.n}i16", args, WORD)

    return types.int16(a), emit


@no_type_check
def _first_lane(typingctx, a):
    """Number in lane 0."""

    def emit(context, builder, signature, args):
        return builder.extract_element(args[0], ir.Constant(ir.IntType(32), 0))

    return types.int16(a), emit


@no_type_check
def _first_marked(typingctx, marks):
    """The lowest lane that is marked; where none is, a number that is no lane."""
    parts = marks.n // PART

    def emit(context, builder, signature, args):
        bits, none, first = builder.bitcast(args[0], ir.IntType(marks.n)), ir.Constant(ir.IntType(1), 0), None
        for part in range(parts):
            of_part = builder.lshr(bits, ir.Constant(bits.type, PART * part))
            round_ = builder.cttz(builder.trunc(of_part, ir.IntType(PART)) if parts > 1 else of_part, none)
            lane = builder.add(builder.mul(round_, ir.Constant(round_.type, parts)), ir.Constant(round_.type, part))
            first = lane if part == 0 else builder.select(builder.icmp_unsigned("<", lane, first), lane, first)
        return builder.trunc(first, WORD)

    return types.int16(marks), emit


lane_numbers: Any = intrinsic(prefer_literal=True)(_lane_numbers)
spread: Any = intrinsic(_spread_word)
load: Any = intrinsic(_load)
load_dealt: Any = intrinsic(_load_dealt)
store: Any = intrinsic(_store)
plus: Any = intrinsic(_of_two("add"))
minus: Any = intrinsic(_of_two("sub"))
differing: Any = intrinsic(_of_two("xor"))
times_two_to: Any = intrinsic(_of_two("shl"))
is_equal: Any = intrinsic(_comparison("=="))
is_below: Any = intrinsic(_comparison("<"))
is_at_most: Any = intrinsic(_comparison("<="))
is_among: Any = intrinsic(_is_among)
minimum: Any = intrinsic(_minimum)
choose: Any = intrinsic(_choose)
popcount: Any = intrinsic(_count_bits)
multiply_high: Any = intrinsic(_upper_product)
from_below: Any = intrinsic(_shifted(-1))
"""Lane d gets what lane d - 1 had, lane 0 a given number."""
from_above: Any = intrinsic(_shifted(1))
"""Lane d gets what lane d + 1 had, the last lane a given number."""
lowest: Any = intrinsic(_lowest)
first_lane: Any = intrinsic(_first_lane)
first_marked: Any = intrinsic(_first_marked)
