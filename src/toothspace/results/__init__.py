"""Datasets, summary numbers, ledger, files."""
