"""One self-contained HTML file per result."""

from __future__ import annotations

from toothspace.report.html import report_html, write_report

__all__ = ["report_html", "write_report"]
