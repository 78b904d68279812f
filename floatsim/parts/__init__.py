"""What a model is made of: one physical thing, one file (description, kernels, batch)."""
