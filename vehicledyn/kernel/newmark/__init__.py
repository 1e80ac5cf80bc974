"""Steps of Newmark's family in machine code, for one case or one in each lane."""
