"""What every table of a study's file is: known keys of known types, and nothing else."""

from pydantic import BaseModel, ConfigDict


class FileTable(BaseModel):
    """A table of TOML, read once and not changed."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, populate_by_name=True)
