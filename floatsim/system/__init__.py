"""Numbering, sparsity, state and assembly. Loops over batches, never asks a type."""
