"""The domain of Python with an index of names by their last part.

A name that is written without its module is searched among all objects, for each mention of it;
with some 15,000 objects and 57,000 mentions that took half of the time of a build.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

from sphinx.application import Sphinx
from sphinx.domains.python import ObjectEntry, PythonDomain


class IndexedPythonDomain(PythonDomain):
    """Finds what :class:`PythonDomain` finds, among the objects that end as the name does."""

    _by_end: dict[str, dict[str, ObjectEntry]] | None = None
    _indexed = 0
    _chosen: dict[str, ObjectEntry] | None = None

    @property
    def objects(self) -> dict[str, ObjectEntry]:
        """Objects by full name; those that can match while a name is searched for."""
        return super().objects if self._chosen is None else self._chosen

    def find_obj(self, *args: Any, **kwargs: Any) -> list[tuple[str, ObjectEntry]]:
        """Return names and objects; arguments as of the parent: env, module, class, name, ..."""
        name: str = args[3]
        self._chosen = self._ending_in(name.removesuffix("()").rpartition(".")[2])
        try:
            return super().find_obj(*args, **kwargs)
        finally:
            self._chosen = None

    def _ending_in(self, end: str) -> dict[str, ObjectEntry]:
        if self._by_end is None or self._indexed != len(self.objects):
            self._by_end, self._indexed = defaultdict(dict), len(self.objects)
            for name, entry in self.objects.items():
                self._by_end[name.rpartition(".")[2]][name] = entry
        return self._by_end.get(end, {})


def setup(app: Sphinx) -> dict[str, Any]:
    """Use it in place of the domain that comes with Sphinx."""
    app.add_domain(IndexedPythonDomain, override=True)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
