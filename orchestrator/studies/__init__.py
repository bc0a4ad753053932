"""Studies of many runs: sweep, falsification, identification, benchmark, parking studies, papers, live page."""
