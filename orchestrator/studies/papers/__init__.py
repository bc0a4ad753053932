"""The papers' numbers beside ours: one module a paper, one shape of result."""
