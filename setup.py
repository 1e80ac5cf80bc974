"""Puts the library into the wheel; everything else is in pyproject.toml."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

LIBRARY = {
    "scenarios": ("*.yaml", "*.asc"),
    "systems": ("*.yaml", "*.npz"),
    "profiles": ("*.csv",),
}


class BuildWithLibrary(build_py):
    """Copies scenarios, systems and profiles beside the modules that find them.

    An editable install finds them where they are, so nothing is copied for it.
    """

    def run(self) -> None:
        """Build the modules, then copy the library."""
        super().run()
        if self.editable_mode:
            return
        for folder, patterns in LIBRARY.items():
            target = Path(self.build_lib, "vehicledyn", "library", folder)
            shutil.rmtree(target, ignore_errors=True)
            for file in sorted(f for pattern in patterns for f in Path(folder).rglob(pattern)):
                place = target / file.relative_to(folder)
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, place)


setup(cmdclass={"build_py": BuildWithLibrary})
