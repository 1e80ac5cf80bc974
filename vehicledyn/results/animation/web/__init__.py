"""The page of animations: its text, look, program and the library that draws."""
