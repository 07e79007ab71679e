"""docs/study-reference.md: every key of a study's file, from its declaration."""

from typing import Any

from pydantic import BaseModel

from studies.search_tables import Bound, Objective, SearchTable
from studies.study_file import Axis, Choice, Constraint, Design, Fixed, Picture, Study

_TABLES: tuple[tuple[str, type[BaseModel]], ...] = (
    ("The study", Study),
    ("`[[set]]`", Fixed),
    ("`[[axis]]`", Axis),
    ("`[[axis.choice]]`", Choice),
    ("`[design]`", Design),
    ("`[[constraint]]`", Constraint),
    ("`[[plot]]`", Picture),
    ("`[search]`", SearchTable),
    ("`[[search.objective]]`", Objective),
    ("`[[search.constraint]]`", Bound),
)


def reference_page() -> str:
    """docs/study-reference.md."""
    lines = [
        "# Study reference",
        "",
        "Written from the declarations in `studies/study_file.py` and `studies/search_tables.py` "
        "by `./hvp study --reference`; do not edit. What studies are for stands in "
        "[studies.md](studies.md).",
    ]
    for heading, table in _TABLES:
        lines += ["", f"## {heading}", "", " ".join((table.__doc__ or "").split()), ""]
        lines += ["| key | default | what it is |", "|---|---|---|"]
        properties = table.model_json_schema(by_alias=True)["properties"]
        required = table.model_json_schema(by_alias=True).get("required", [])
        for name, field in table.model_fields.items():
            key = field.alias or name
            schema = properties[key]
            default = "required" if key in required else _default(field.default)
            choices = schema.get("enum")
            text = str(field.description)
            if choices:
                text = f"{', '.join(f'`{choice}`' for choice in choices)}: {text}"
            lines.append(f"| `{key}` | {default} | {text} |")
    return "\n".join(lines) + "\n"


def _default(value: Any) -> str:
    if value is None or value in ("", []):
        return ""
    if isinstance(value, BaseModel):
        return ""
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"
