"""What is asked of a model and what comes back: output channels, the netCDF store, decay tests, plots."""
