"""Systems written in YAML alone: read, validate, expand, build, write back."""

from vehicledyn.files.system import files as files
