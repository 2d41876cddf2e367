"""Runs and meshes as pages for a browser: the globe, a map, planes, the values of every cell."""

from postprocess.view.html_page import page_of, require_page, view_page, write_page

__all__ = ["page_of", "require_page", "view_page", "write_page"]
