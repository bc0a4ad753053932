"""What a study is: its file, its design, and what is kept of each run."""
