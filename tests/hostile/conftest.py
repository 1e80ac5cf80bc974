"""Everything is imported before the first fork, so that a case costs milliseconds."""

import warm

warm.up()
