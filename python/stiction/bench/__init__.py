"""Sessions whose truth is hidden, and scores of anybody's answers to them."""
