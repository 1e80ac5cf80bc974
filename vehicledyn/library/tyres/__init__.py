"""Tyre property files of the library, written from published data; each names its source."""
