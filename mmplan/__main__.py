"""`python -m mmplan` does what the command `mmplan` does."""

import sys

from mmplan.cli import main

if __name__ == "__main__":
    sys.exit(main())
