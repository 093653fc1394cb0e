"""What rigidsym costs and how exact it is, beside SymPy: `python benchmarks/run.py`."""
