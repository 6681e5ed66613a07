"""What the repository promises about itself: rooms, names, words, one place for each thing."""
