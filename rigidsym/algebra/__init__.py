"""Exact arithmetic: polynomial rings with relations and a time derivative."""
