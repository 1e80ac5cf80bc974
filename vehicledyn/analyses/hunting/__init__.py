"""Hunting studies: critical speeds and limit cycles."""
