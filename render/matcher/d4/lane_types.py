"""Types of vectors inside compiled functions: a 16-bit number, or a truth value, for every disparity of a pixel.

Lanes are dealt out like cards: with n = 32 p of them, lane d has place 32 (d mod p) + d // p. A step to the next lane
then is a step to the same place of the next part, but for one part in p.
"""

from typing import no_type_check

from llvmlite import ir
from numba import types
from numba.core.datamodel import models
from numba.extending import register_model

WORD = ir.IntType(16)
"""Of a lane."""
PART = 32
"""16-bit numbers in the widest vectors that processors have."""


def places(n: int) -> list[int]:
    """Place of each of `n` lanes."""
    parts = n // PART
    return [PART * (lane % parts) + lane // parts for lane in range(n)]


@no_type_check
class Lanes(types.Type):
    """`n` signed 16-bit numbers, `n` a multiple of 32."""

    def __init__(self, n):
        self.n = n
        super().__init__(f"Lanes({n})")


@no_type_check
class Marks(types.Type):
    """`n` truth values, one a lane."""

    def __init__(self, n):
        self.n = n
        super().__init__(f"Marks({n})")


@no_type_check
@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.VectorType(WORD, kind.n))


@no_type_check
@register_model(Marks)
class _MarksModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.VectorType(ir.IntType(1), kind.n))
