"""Version and place of the program, for whatever names them in files and messages."""

from __future__ import annotations

from pathlib import Path

PACKAGE = "vehicledyn"
VERSION = "0.1.0"
FOLDER = Path(__file__).parents[1]
"""Folder of the package."""
