"""``python -m orchestrator`` is ``apa``."""

import sys

from orchestrator.cli import main

sys.exit(main())
