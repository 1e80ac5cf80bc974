"""The commands, one module a family: each calls one public function and writes what it returns."""
