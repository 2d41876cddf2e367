"""Norms, figures and reports made from runs and meshes."""
