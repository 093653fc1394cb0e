"""The command line."""

import gc

from rigidsym.system.processes import NEW_OBJECTS

gc.set_threshold(NEW_OBJECTS)  # before the other imports, which make few cycles
