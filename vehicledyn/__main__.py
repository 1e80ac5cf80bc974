"""Run the command line as ``python -m vehicledyn``."""

from vehicledyn.cli import main

if __name__ == "__main__":
    main()
