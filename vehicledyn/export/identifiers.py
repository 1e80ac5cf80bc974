"""Names as identifiers of C, Python and MATLAB."""

from __future__ import annotations

import keyword
import re
from collections.abc import Sequence

_C_KEYWORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline
    int long register restrict return short signed sizeof static struct switch typedef union
    unsigned void volatile while
"""
_MATLAB_KEYWORDS = """
    break case catch classdef continue else elseif end for function global if otherwise parfor
    persistent return spmd switch try while
"""
_KEYWORDS = {*keyword.kwlist, *_C_KEYWORDS.split(), *_MATLAB_KEYWORDS.split()}


def safe_name(name: str) -> str:
    """Return a name as an identifier of C, Python and MATLAB."""
    plain = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_") or "n"
    if plain[0].isdigit():
        plain = f"n{plain}"
    return f"{plain}_" if plain in _KEYWORDS else plain


def safe_names(names: Sequence[str]) -> list[str]:
    """Return different identifiers for different names, in their order."""
    taken: set[str] = set()
    result = []
    for name in names:
        plain = safe_name(name)
        while plain in taken:
            plain = f"{plain}_"
        taken.add(plain)
        result.append(plain)
    return result
