"""Regions of the sphere: boxes, polygons, fields and the real ocean, with their coastlines."""
