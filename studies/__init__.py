"""Questions that take more than one run of hvp: sweeps, screening, accuracy, reports."""
