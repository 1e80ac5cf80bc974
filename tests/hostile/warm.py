"""Imports whatever the program may import, once, before children are forked."""

import importlib
import os
import pkgutil


def up():
    """Import all modules of the program and the packages that they load lazily."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    os.environ["MPLBACKEND"] = "agg"
    import vehicledyn

    for found in pkgutil.walk_packages(vehicledyn.__path__, "vehicledyn."):
        if not found.name.endswith("__main__"):
            importlib.import_module(found.name)
    for name in (
        "matplotlib.pyplot", "pandas", "scipy.interpolate", "scipy.optimize", "scipy.signal",
        "scipy.stats", "scipy.linalg", "jinja2", "ruamel.yaml", "typer",
        "matplotlib.backends.backend_agg", "matplotlib.backends.backend_svg",
    ):  # fmt: skip
        importlib.import_module(name)
