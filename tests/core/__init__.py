"""The compiled core, from Python: its contract, bad input, oracles and properties."""
