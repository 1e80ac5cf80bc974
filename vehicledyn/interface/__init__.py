"""The functions that ``import vehicledyn`` offers: from models to values in memory."""

import logging

# Without a handler of the user's own nothing that is logged is printed.
logging.getLogger("vehicledyn").addHandler(logging.NullHandler())
