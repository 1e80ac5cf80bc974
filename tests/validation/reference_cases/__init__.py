"""The program against its references: each module computes one group of comparisons.

Tests and the report in reports/ both take their figures from here.
"""
