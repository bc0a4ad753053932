"""NTBPTcwPT: Guo et al. 2015, "Path tracking control strategy of automatic parking system"."""
