"""What generated files say of their origin; reading the version imports nothing else."""

__version__ = "0.1.0"
OWNERSHIP = "This file may be used without restriction."  # in every file
