"""Which candidates are causes: refits, decisions, other laws, and what stays undecided."""
