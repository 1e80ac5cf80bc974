"""The accuracy of runs with a fixed step: watched in windows, judged at the end, put in words."""
