"""The page that runs the models: driven by hand, changed by sliders, all in one HTML file."""
