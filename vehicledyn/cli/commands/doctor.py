"""What this installation consists of, for a report of a problem."""

from __future__ import annotations

import os
import platform
import sys
from dataclasses import asdict, dataclass
from importlib import metadata
from typing import Any

from vehicledyn.base.version import VERSION
from vehicledyn.catalogue import counts

_PACKAGES = (
    "casadi",
    "h5py",
    "jinja2",
    "matplotlib",
    "numpy",
    "pandas",
    "platformdirs",
    "pydantic",
    "ruamel.yaml",
    "scipy",
    "typer",
)


@dataclass(frozen=True)
class Examination:
    """Versions, compiler, cache and catalogues of an installation.

    ``compiler`` is None where CasADi's interpreter is used instead; ``compiler_remark`` says why.
    ``cache_remark`` says why the cache is not used although it may be writable.
    """

    version: str
    python: str
    platform: str
    packages: dict[str, str]
    compiler: str | None
    compiler_remark: str
    cache_folder: str
    cache_writable: bool
    cache_remark: str
    cached_kernels: int
    catalogues: dict[str, int]

    def as_text(self) -> str:
        """Return one line for each fact."""
        writable = "writable" if self.cache_writable else "NOT writable: nothing will be kept"
        writable = self.cache_remark or writable
        facts = {
            "vehicledyn": self.version,
            "python": f"{self.python}, {self.platform}",
            **self.packages,
            "C compiler": self.compiler or f"{self.compiler_remark}; CasADi interprets, slower",
            "cache": f"{self.cache_folder} ({writable}), {self.cached_kernels} kernels",
            "catalogues": ", ".join(f"{count} {name}" for name, count in self.catalogues.items()),
        }
        width = max(map(len, facts))
        return "\n".join(f"{name:{width}}  {fact}" for name, fact in facts.items())

    def as_dict(self) -> dict[str, Any]:
        """Return the facts as plain data."""
        return asdict(self)


def examine() -> Examination:
    """Return what this installation consists of; nothing heavy is loaded."""
    from vehicledyn.codegen.toolchain.cache import cache_folder, distrust
    from vehicledyn.codegen.toolchain.compiler import library_suffix

    compiler, remark = _compiler()
    folder = cache_folder()
    nearest = next(path for path in (folder, *folder.parents) if path.exists())
    return Examination(
        version=VERSION,
        python=platform.python_version(),
        platform=f"{sys.platform} {platform.machine()}",
        packages={name: _version(name) for name in _PACKAGES},
        compiler=compiler,
        compiler_remark=remark,
        cache_folder=str(folder),
        cache_writable=nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK),
        cache_remark=distrust(),
        cached_kernels=len(list(folder.glob(f"*{library_suffix()}"))),
        catalogues=counts(),
    )


def _compiler() -> tuple[str | None, str]:
    from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler

    try:
        compiler = find_compiler()
    except CompilationError as error:
        return None, str(error)
    return f"{compiler.description} ({' '.join(compiler.command)})", ""


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"
