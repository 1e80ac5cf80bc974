"""Equations of the Magic Formula for tyre property files, versions 5.2, PAC2002, 6.1 and 6.2."""
