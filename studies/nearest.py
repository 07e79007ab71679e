"""Which name may have been meant."""

import difflib
from collections.abc import Iterable


def nearest(found: str, names: Iterable[str]) -> str:
    """ "; did you mean '…'?", or nothing where none is near."""
    near = difflib.get_close_matches(found, list(names), n=1, cutoff=0.5)
    return f"; did you mean '{near[0]}'?" if near else ""
