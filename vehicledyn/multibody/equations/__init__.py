"""From a system to its Equations value: terms, outputs, events, impacts."""
