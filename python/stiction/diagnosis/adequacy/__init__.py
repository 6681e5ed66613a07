"""What a model leaves: over every coordinate, in single moments, in single recordings."""
