"""The equations: tendency, plain kernels, terms and the model that holds them."""
