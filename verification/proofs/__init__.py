"""Bounds that are theorems: ``prove``, certificates, and their checker."""
