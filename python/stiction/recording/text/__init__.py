"""Text files of numbers, read in blocks: their lines, their cells, their rows."""
