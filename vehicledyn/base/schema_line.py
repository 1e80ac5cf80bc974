"""The line that shows editors which schema a YAML file follows."""

from __future__ import annotations

from typing import Literal

FileKind = Literal["scenario", "system", "study"]


def schema_name(kind: FileKind) -> str:
    """Return the usual name of the schema file of some kind of files."""
    return f"{kind}.schema.json"


def schema_line(schema: str) -> str:
    r"""Return the first line of a file that follows a schema, by the schema's place.

    Editors with the YAML language server complete and check the file while it is typed.

    >>> schema_line("system.schema.json")
    '# yaml-language-server: $schema=system.schema.json\n'
    """
    return f"# yaml-language-server: $schema={schema}\n"
