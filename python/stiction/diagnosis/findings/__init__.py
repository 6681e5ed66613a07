"""What is reported: records in words, verdict, advice, pictures."""
