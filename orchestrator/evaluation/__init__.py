"""The evaluation of recorded runs: ground truth, metrics, requirements, outcomes, comparison."""
