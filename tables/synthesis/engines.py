"""The engines that are synthesised, and the blocks of each."""

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Final

# Parameters of engine.sv as `hvp_engine_size` has them, in this order.
PARAMETERS: Final = (
    *("MatrixBits", "VectorBits", "CoefficientBits", "Package", "Partitions", "Lanes"),
    *("NodeBits", "PackageBits", "QueueBits", "PhaseClocks", "DivisionClocks", "StaticBits"),
    *("Preconditioner", "RowsInParallel", "DirectionBanks", "DirectionMemory"),
)
HERE: Final = Path(__file__).parent


@dataclass(frozen=True)
class Engine:
    """A size of engine.sv: a line of engines.csv."""

    name: str
    parameters: dict[str, int]
    calibrates: bool  # the model of the logic is fitted on it, too
    placed: bool  # and routed, block by block


def _engines() -> tuple[Engine, ...]:
    with (HERE / "engines.csv").open(newline="") as stream:
        return tuple(
            Engine(
                row["engine"],
                {name: int(row[name]) for name in PARAMETERS},
                row["calibrates"] == "1",
                row["placed"] == "1",
            )
            for row in csv.DictReader(stream)
        )


ENGINES: Final = _engines()


PLACED: Final = (
    *("partition", "lane", "row collector", "sums", "divider", "scaler", "stop test", "editor"),
)
# Of P^-1, by the number of the preconditioner.
MAKERS: Final = ("inverse_maker", "block_inverse_maker")


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
        if self.module in MAKERS:
            return int(engine.parameters["Preconditioner"] == MAKERS.index(self.module) + 1)
        return 3 * engine.parameters["Lanes"] if self.name == "lane" else 1

    def is_placed(self, engine: Engine) -> bool:
        """And routed: a whole engine would take hours."""
        return engine.placed and self.name in PLACED


_SEQUENCER: Final = "engine.sequence_of_passes"
_VECTORS: Final = "engine.vectors"
WHOLE: Final = Block("engine", "engine", "engine")
BLOCKS: Final = (
    Block("partition", "spmxv_partition", "engine.matrix.g_partition[0].spmxv"),
    Block("lane", "vector_component", f"{_VECTORS}.g_lane[0].g_component[0].component"),
    Block("row collector", "row_collector", f"{_VECTORS}.collector"),
    Block("sums", "vector_sums", f"{_VECTORS}.sums"),
    Block("divider", "coefficient_divider", f"{_SEQUENCER}.coefficients.divider"),
    Block("scaler", "scaler", f"{_SEQUENCER}.coefficients.scaling"),
    Block("stop test", "stop_test", f"{_SEQUENCER}.stopping"),
    Block("sequencer", "sequencer", _SEQUENCER),
    Block("editor", "matrix_editor", "engine.matrix.editor"),
    Block("inverse maker", "inverse_maker", "engine.matrix.g_preconditioner.maker"),
    Block("inverse maker", "block_inverse_maker", "engine.matrix.g_blocks.maker"),
    Block("settings", "engine_settings", "engine.settings"),
)


def blocks_of(engine: Engine) -> tuple[Block, ...]:
    """Those that it has, the whole engine last."""
    return (*(block for block in BLOCKS if block.count(engine) > 0), WHOLE)
