"""What a command meets outside itself: full disks, signals, closed pipes, folders that vanish."""
