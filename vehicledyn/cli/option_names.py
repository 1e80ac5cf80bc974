"""The options under which the command line offers the arguments of analyses."""

from __future__ import annotations

from typing import Any

_OPTIONS = {
    "inputs": "--input",
    "outputs": "--output",
    "channels": "--channel",
    "shifts": "--shift",
    "amplitudes": "--amplitude",
    "tolerances": "--tolerance",
    "drives": "--drive",
    "first": "--from",
    "last": "--to",
    "certificates": "--tls",
    "cases": "--set",
    "save_to": "--output",
    "to": "--to",
}
"""Options of other names than their arguments."""

_POSITIONAL = {
    **dict.fromkeys(("car", "model", "scenario", "source"), "SCENARIO"),
    **dict.fromkeys(("description", "file", "path"), "FILE"),
    **{name: name.upper() for name in ("rail", "reference", "result", "study", "wheel")},
}
"""Words of the usage for arguments that have no option."""


class OptionNaming:
    """Arguments as options are written."""

    def argument(self, name: str) -> str:
        """Return the option that gives an argument, or its word in the usage."""
        if name in _POSITIONAL:
            return _POSITIONAL[name]
        return _OPTIONS.get(name, f"--{name.replace('_', '-')}")

    def given(self, name: str, value: Any) -> str:
        """Return the option with its value."""
        text = f"{value:g}" if isinstance(value, float) else str(value)
        return f"{self.argument(name)} {text}"

    def setting(self, key: str) -> str:
        """Return the option that changes a value of a scenario."""
        return f"--set {key}"
