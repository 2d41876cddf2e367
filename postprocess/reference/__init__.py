"""Reference solutions: the spectral model, and what is stored of it."""
