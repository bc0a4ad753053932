"""Pages a browser shows without a network: the replay of a run, two runs compared, a set of runs tested."""
