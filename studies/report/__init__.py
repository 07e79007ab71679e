"""Reports that open in a browser: one file each, with everything that they need in it."""
