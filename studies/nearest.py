"""Which name may have been meant."""

import difflib
from collections.abc import Iterable


def nearest(found: str, names: Iterable[str]) -> str:
    """ "; did you mean '…'?", or nothing where there is none."""
    near = difflib.get_close_matches(found, list(names), n=1, cutoff=0.0)
    return f"; did you mean '{near[0]}'?" if near else ""
