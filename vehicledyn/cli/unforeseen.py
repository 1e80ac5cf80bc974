"""What to say of an error that nothing more special has caught: a numerical failure, or a bug."""

from __future__ import annotations

import re

from vehicledyn.cli.exit_codes import BUG, INPUT, NUMERICAL

_NO_NUMBERS = re.compile(r"\b(nans?|infs?|infinity|math domain|(non-?|in)?finite)\b", re.IGNORECASE)
"""In the words with which NumPy, SciPy and Python refuse what is no finite number."""

_WHERE = "set VEHICLEDYN_TRACEBACK=1 to see where"


def describe_failure(error: Exception) -> tuple[str, int]:
    """Return what to tell the user of an error, and the exit code.

    Arithmetic that leaves the range of numbers is the fault of numbers given far too large, too
    small or contradictory, unless these are usual ones.
    """
    from vehicledyn.base.plugins import loaded_plugins, plugin_line

    words = " ".join(f"{type(error).__name__}: {error}".split())
    own = plugin_line(error)
    if own:
        return f"{own}: the plugin failed: {words}", INPUT
    if isinstance(error, RecursionError):
        return f"what is given is nested too deeply ({words})", INPUT
    if isinstance(error, UnicodeError):
        return f"a text holds signs that cannot be written ({words}); change it", INPUT
    if _is_numerical(error):
        text = (
            f"the computation failed on numbers ({words}): one of those given is far too large or "
            f"too small, or they contradict each other; if they are usual ones, {_WHERE}, and "
            "please report it"
        )
        return text, NUMERICAL
    hint = f"{_WHERE[0].upper()}{_WHERE[1:]}, and please report it."
    plugins = " or of a plugin" if loaded_plugins() else ""
    return f"this is a bug of vehicledyn{plugins}: {words}. {hint}", BUG


def _is_numerical(error: Exception) -> bool:
    from numpy.linalg import LinAlgError

    if isinstance(error, ArithmeticError | LinAlgError):
        return True
    return isinstance(error, ValueError) and bool(_NO_NUMBERS.search(str(error)))
