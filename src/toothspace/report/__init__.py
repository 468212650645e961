"""One self-contained HTML file per result."""

from __future__ import annotations

from toothspace.report.html import ENDINGS, report_html, write_report

__all__ = ["ENDINGS", "report_html", "write_report"]
