"""Human-simulated intelligent control: key points, characteristic states, production rules (the HSIC paper)."""
