"""Systems built in Python on their way to other processes."""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path
from typing import Any

from vehicledyn.base.plugins import MODULE_PREFIX
from vehicledyn.base.version import FOLDER
from vehicledyn.files.scenario.python_models import PythonModel
from vehicledyn.symbolic.pickled import UNPICKLABLE, modules_of, packed, unpacked


class PortableModel:
    """A model built in Python; pickled, it is read again when it is first used.

    Until then the process that receives it can load the plugins whose classes it needs.
    """

    def __init__(self, model: PythonModel) -> None:
        self._model: PythonModel | None = model
        self._content = b""

    @property
    def model(self) -> PythonModel:
        """The model."""
        if self._model is None:
            self._model = unpacked(self._content)
        return self._model

    def obstacle(self) -> str:
        """Return what keeps the model in this process, empty if nothing does."""
        try:
            content = self._packed()
        except UNPICKLABLE as error:
            return " ".join(str(error).split())
        modules = sorted(name for name in modules_of(content) if not _is_everywhere(name))
        return f"other processes cannot import its classes of {', '.join(modules)}" * bool(modules)

    def _packed(self) -> bytes:
        if not self._content:
            self._content = packed(self.model)
        return self._content

    def __getstate__(self) -> dict[str, Any]:
        """Return the bytes alone."""
        return {"_model": None, "_content": self._packed()}


def _is_everywhere(module: str) -> bool:
    """Return whether any process of this installation finds a module."""
    root = module.partition(".")[0]
    if root == "__main__":  # every process has one of its own
        return False
    if root in (FOLDER.name, *sys.stdlib_module_names) or root.startswith(MODULE_PREFIX):
        return True
    file = getattr(sys.modules.get(root), "__file__", None)
    folders = {Path(sysconfig.get_path(name)).resolve() for name in ("purelib", "platlib")}
    return file is not None and not folders.isdisjoint(Path(file).resolve().parents)
