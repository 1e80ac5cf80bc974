"""Pages of the modules, one for each package, filled from docstrings by autodoc."""

from __future__ import annotations

import ast
from pathlib import Path


def pages(package: Path) -> dict[str, tuple[str, str]]:
    """Return a page for each package that holds modules.

    Parameters
    ----------
    package
        Folder of the outermost package.
    """
    made = {}
    for folder in sorted({path.parent for path in package.rglob("*.py")}):
        name = ".".join(folder.relative_to(package.parent).parts)
        modules = [p for p in sorted(folder.glob("*.py")) if not p.stem.startswith("__")]
        if modules:
            made[f"api_{name.replace('.', '_')}"] = (_page(name, modules), _first_line(folder))
    return made


def _page(name: str, modules: list[Path]) -> str:
    parts = [f"# {name}", _directive("automodule", name, members=False)]
    for path in modules:
        parts += [f"## {path.stem}", _directive("automodule", f"{name}.{path.stem}", members=True)]
    return "\n\n".join(parts) + "\n"


def _directive(kind: str, name: str, *, members: bool) -> str:
    chosen = "" if members else "   :no-members:\n"
    return f"```{{eval-rst}}\n.. {kind}:: {name}\n{chosen}```"


def _first_line(folder: Path) -> str:
    tree = ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))
    return (ast.get_docstring(tree) or "").partition("\n")[0]
