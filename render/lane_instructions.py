"""Two instructions on 16-bit vector lanes that numba has no name for; LLVM widens them to whole vectors."""

from typing import Any, no_type_check

from llvmlite import ir
from numba.extending import intrinsic


@no_type_check
def _count_bits(typingctx, word):
    """Number of set bits (LLVM's ctpop, which has vector forms)."""

    def emit(context, builder, signature, args):
        return builder.ctpop(args[0])

    return word(word), emit


@no_type_check
def _upper_product(typingctx, a, b):
    """Upper 16 bits of the 32-bit product of two 16-bit numbers (one vector instruction)."""

    def emit(context, builder, signature, args):
        wide = ir.IntType(32)
        product = builder.mul(builder.sext(args[0], wide), builder.sext(args[1], wide))
        return builder.trunc(builder.lshr(product, ir.Constant(wide, 16)), ir.IntType(16))

    return a(a, b), emit


popcount: Any = intrinsic(_count_bits)
multiply_high: Any = intrinsic(_upper_product)
