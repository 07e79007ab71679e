# SPDX-License-Identifier: Apache-2.0
"""A symmetric matrix of 3 x 3 blocks in the words of the board."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hvp_board._driver import ffi

Words = NDArray[np.int32]
BLOCK = 3


def words(values: ArrayLike, what: str) -> Words:
    """As the C library takes them. ValueError where a value is no whole number of 32 bits."""
    array = np.asarray(values)
    if array.dtype.kind not in "iub":
        raise ValueError(f"{what}: expected whole numbers, the words of the board")
    limits = np.iinfo(np.int32)
    if array.size > 0 and (array.min() < limits.min or array.max() > limits.max):
        raise ValueError(f"{what}: expected numbers of 32 bits")
    return np.ascontiguousarray(array, dtype=np.int32)


class BlockSparse(Protocol):
    """What scipy.sparse.bsr_array has: block rows, ascending columns, blocks of 3 x 3."""

    @property
    def indptr(self) -> Any: ...
    @property
    def indices(self) -> Any: ...
    @property
    def data(self) -> Any: ...


class Matrix:
    """Both triangles, every diagonal block, columns ascending within a row (struct hvp_matrix)."""

    def __init__(self, row_begin: ArrayLike, column: ArrayLike, value: ArrayLike) -> None:
        """Of [nodes + 1], [blocks] and [blocks, 3, 3] whole numbers."""
        self.row_begin = words(row_begin, "row_begin")
        self.column = words(column, "column")
        self.value = words(value, "value")
        if self.row_begin.ndim != 1 or self.row_begin.size < 1:
            raise ValueError("row_begin: expected one number more than there are nodes")
        if self.column.ndim != 1 or self.value.shape != (self.column.size, BLOCK, BLOCK):
            raise ValueError("value: expected a block of 3 x 3 for each column")
        # What the driver reads it would read beyond the arrays.
        if self.row_begin[-1] != self.column.size:
            raise ValueError(f"row_begin: expected {self.column.size} as the last one")

    @classmethod
    def of(cls, matrix: BlockSparse) -> Matrix:
        """A scipy.sparse.bsr_array of whole numbers."""
        return cls(matrix.indptr, matrix.indices, matrix.data)

    @property
    def nodes(self) -> int:
        return self.row_begin.size - 1

    def to_c(self) -> Any:
        matrix = ffi.new("struct hvp_matrix*")
        matrix.nodes = self.nodes
        matrix.blocks = self.column.size
        matrix.row_begin = ffi.from_buffer("int32_t[]", self.row_begin)
        matrix.column = ffi.from_buffer("int32_t[]", self.column)
        matrix.value = ffi.from_buffer("int32_t[]", self.value.reshape(-1))
        return matrix
