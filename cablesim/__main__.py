"""`python -m cablesim` is the command `cablesim`."""

import sys

from cablesim.cli import main

sys.exit(main())
