"""Result files: layout, writing, reading, output checks."""
