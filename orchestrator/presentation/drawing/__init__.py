"""What stands around the car, and the still picture of a run."""

import logging

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it warns of a home that cannot be written, and needs none
