"""One self-contained HTML file per result."""

from __future__ import annotations

from toothspace.report.comparison import Comparison, compare
from toothspace.report.html import ENDINGS, report_html, write_report

__all__ = ["ENDINGS", "Comparison", "compare", "report_html", "write_report"]
