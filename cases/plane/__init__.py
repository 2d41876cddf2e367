"""Test cases on planes."""
