"""What may be missing, scored without refitting: candidates, the baseline, efficient scores."""
