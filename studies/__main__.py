"""`python -m studies COMMAND …`: what `./hvp study`, `sweep`, `compare` and `report` run."""

import sys

from studies.cli import main

sys.exit(main(sys.argv[1:]))
