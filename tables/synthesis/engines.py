"""The engines that are synthesised, and the blocks of each."""

from dataclasses import dataclass
from typing import Final

# Parameters of engine.sv as `hvp_engine_size` has them, in this order.
PARAMETERS: Final = (
    *("MatrixBits", "VectorBits", "CoefficientBits", "Package", "Partitions", "Lanes"),
    *("NodeBits", "PackageBits", "QueueBits", "PhaseClocks", "DivisionClocks", "StaticBits"),
    "Preconditioner",
)


@dataclass(frozen=True)
class Engine:
    """A size of engine.sv."""

    name: str
    values: tuple[int, ...]
    placed: bool  # and routed, block by block

    @property
    def parameters(self) -> dict[str, int]:
        """By name."""
        return dict(zip(PARAMETERS, self.values, strict=True))


# The thesis' engine holds 500 nodes and as many packages a partition, with plain CG and with
# Jacobi's preconditioner; the others are those of the tests (tests/vp/engine/CMakeLists.txt), with
# plain CG.
ENGINES: Final = (
    Engine("thesis", (12, 16, 16, 8, 5, 2, 9, 9, 4, 20, 68, 4, 0), placed=True),
    Engine("jacobi", (12, 16, 16, 8, 5, 2, 9, 9, 4, 20, 68, 4, 1), placed=False),
    Engine("narrow", (9, 13, 10, 4, 3, 1, 7, 10, 1, 23, 71, 4, 0), placed=False),
    Engine("wide", (16, 20, 18, 9, 7, 2, 8, 9, 3, 19, 86, 4, 0), placed=False),
    Engine("least", (8, 12, 8, 3, 1, 1, 6, 11, 2, 19, 66, 4, 0), placed=False),
    Engine("many", (12, 16, 16, 8, 16, 2, 8, 8, 1, 20, 68, 4, 0), placed=False),
    Engine("long", (14, 18, 24, 10, 4, 2, 9, 8, 3, 33, 98, 4, 0), placed=True),
)


@dataclass(frozen=True)
class Block:
    """A module of the engine with what it has inside, taken out of it."""

    name: str
    module: str
    path: str  # of its first instance

    def count(self, engine: Engine) -> int:
        """How many of them the engine has."""
        if self.name == "partition":
            return engine.parameters["Partitions"]
        return 3 * engine.parameters["Lanes"] if self.name == "lane" else 1


_SEQUENCER: Final = "engine.sequence_of_passes"
_VECTORS: Final = "engine.vectors"
WHOLE: Final = Block("engine", "engine", "engine")
BLOCKS: Final = (
    Block("partition", "spmxv_partition", "engine.matrix.g_partition[0].spmxv"),
    Block("lane", "vector_component", f"{_VECTORS}.g_lane[0].g_component[0].component"),
    Block("row collector", "row_collector", f"{_VECTORS}.collector"),
    Block("sums", "vector_sums", f"{_VECTORS}.sums"),
    Block("vector unit", "vector_unit", _VECTORS),
    Block("divider", "coefficient_divider", f"{_SEQUENCER}.coefficients.divider"),
    Block("scaler", "scaler", f"{_SEQUENCER}.coefficients.scaling"),
    Block("stop test", "stop_test", f"{_SEQUENCER}.stopping"),
    Block("sequencer", "sequencer", _SEQUENCER),
    Block("editor", "matrix_editor", "engine.matrix.editor"),
    Block("settings", "engine_settings", "engine.settings"),
)
