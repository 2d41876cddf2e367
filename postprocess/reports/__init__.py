"""Reports: what studies and comparisons found, in sentences, figures and tables."""
