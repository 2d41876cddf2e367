"""Meshes of polygons in the plane, whose walls clip cells as coasts do on the sphere."""
