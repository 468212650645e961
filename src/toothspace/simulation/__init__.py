"""Lateral films coupled with chambers."""
