"""What a diagnosis is made from: rows by their use, noise, surrogates, the gain held out."""
