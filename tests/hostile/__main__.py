"""Attack the program: ``python tests/hostile [--number N] [--kind KIND] [--processes P]``.

Every case follows from its kind and number alone, so that a failure is repeated by
``python tests/hostile --kind KIND --first NUMBER --number 1 --keep FOLDER``.
"""

import argparse
import sys
import time

import campaign


def main():
    parser = argparse.ArgumentParser(description="Run the program on hostile inputs.")
    parser.add_argument("--number", type=int, default=1000, help="cases, over all kinds")
    parser.add_argument("--first", type=int, default=0, help="number of the first case of a kind")
    parser.add_argument("--kind", action="append", choices=list(campaign.KINDS), help="of input")
    parser.add_argument("--processes", type=int, default=2, help="cases at once")
    parser.add_argument("--keep", help="folder for the inputs of cases that fail")
    options = parser.parse_args()
    started = time.monotonic()
    table = campaign.attack(
        options.number,
        first=options.first,
        kinds=options.kind,
        processes=options.processes,
        keep=options.keep,
        tell=lambda text: print(text, flush=True),  # noqa: T201
    )
    print(table.as_text(time.monotonic() - started))  # noqa: T201
    return 1 if table.failures else 0


if __name__ == "__main__":
    sys.exit(main())
