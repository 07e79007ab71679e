"""Who should solve a scenario's frames: the board, or the host, in which way."""
