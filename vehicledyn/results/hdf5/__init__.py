"""HDF5 files as bytes on a disk: opening, checksums, damage, finishing in place."""
