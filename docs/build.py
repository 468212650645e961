"""Build the documentation: every Markdown page to HTML, the API reference, links checked."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
import shutil
import sys
from collections.abc import Iterator
from html import escape
from pathlib import Path
from types import FunctionType, ModuleType

from markdown_it import MarkdownIt

DOCS = Path(__file__).resolve().parent
REPOSITORY = DOCS.parent
BUILD = DOCS / "_build"
LINK = re.compile(r"\]\((?!https?:|mailto:|#)([^)#\s]+)(?:#[^)]*)?\)")
CODE = re.compile(r"```.*?```|`[^`]*`", re.DOTALL)

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body {{ font: 16px/1.55 system-ui, sans-serif; max-width: 52rem; margin: 2rem auto;
       padding: 0 1rem }}
table {{ border-collapse: collapse }} td, th {{ border: 1px solid #ccc; padding: .25rem .6rem }}
pre {{ background: #f5f5f5; padding: .8rem; overflow-x: auto }} img {{ max-width: 100% }}
</style></head><body><p><a href="{root}index.html">toothspace</a></p>
{body}
</body></html>
"""


def pages() -> Iterator[Path]:
    """All Markdown pages of the documentation."""
    for path in sorted(DOCS.rglob("*.md")):
        if BUILD not in path.parents:
            yield path


def broken_links(path: Path, text: str) -> list[str]:
    """Relative links of a page that lead nowhere."""
    targets = LINK.findall(CODE.sub("", text))
    return [target for target in targets if not (path.parent / target).exists()]


def write_page(relative: Path, title: str, body: str) -> None:
    """Write one HTML page into the build folder."""
    out = BUILD / relative.with_suffix(".html")
    out.parent.mkdir(parents=True, exist_ok=True)
    root = "../" * (len(relative.parts) - 1)
    out.write_text(PAGE.format(title=escape(title), root=root, body=body), encoding="utf-8")


def render(path: Path) -> list[str]:
    """Render one Markdown page; return its broken links."""
    text = path.read_text(encoding="utf-8")
    body = MarkdownIt("commonmark", {"html": True}).enable("table").render(text)
    body = re.sub(r'href="(?!https?:)([^"#]+)\.md', r'href="\1.html', body)
    title = text.lstrip("# ").splitlines()[0] if text else path.stem
    write_page(path.relative_to(DOCS), title, body)
    return broken_links(path, text)


def copy_pictures() -> None:
    """Copy pictures next to the pages that show them."""
    for path in DOCS.rglob("*"):
        if path.suffix in {".png", ".svg"} and BUILD not in path.parents:
            target = BUILD / path.relative_to(DOCS)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)


def package_modules() -> Iterator[ModuleType]:
    """Every module of the package."""
    package = importlib.import_module("toothspace")
    yield package
    for found in pkgutil.walk_packages(package.__path__, "toothspace."):
        if not found.name.endswith("__main__"):
            yield importlib.import_module(found.name)


def describe(module: ModuleType) -> str:
    """API reference of one module: its docstring and those of its public members."""
    parts = [f"<h1>{module.__name__}</h1><pre>{escape(inspect.getdoc(module) or '')}</pre>"]
    for name, member in vars(module).items():
        function = getattr(member, "py_func", member)
        own = getattr(function, "__module__", None) == module.__name__
        if name.startswith("_") or not own or not isinstance(function, FunctionType | type):
            continue
        doc = inspect.getdoc(member) or ""
        parts.append(f"<h2 id='{name}'>{name}</h2><pre>{escape(signature(function))}")
        parts.append(f"\n\n{escape(doc)}</pre>")
    return "".join(parts)


def signature(function: FunctionType | type) -> str:
    """Signature of a function or class as text."""
    try:
        return f"{function.__name__}{inspect.signature(function)}"
    except (TypeError, ValueError):
        return function.__name__


def build_reference() -> None:
    """Write one page for every module and an index of them."""
    names = []
    for module in package_modules():
        names.append(module.__name__)
        write_page(Path("api") / f"{module.__name__}.x", module.__name__, describe(module))
    links = "".join(f"<li><a href='{name}.html'>{name}</a></li>" for name in names)
    write_page(Path("api") / "index.x", "API reference", f"<h1>API reference</h1><ul>{links}</ul>")


def main() -> int:
    """Build everything; the exit code is 1 if a link is broken."""
    shutil.rmtree(BUILD, ignore_errors=True)
    broken = {path: render(path) for path in pages()}
    copy_pictures()
    build_reference()
    for path, targets in broken.items():
        for target in targets:
            print(f"{path.relative_to(REPOSITORY)}: broken link {target}", file=sys.stderr)
    print(f"{len(broken)} pages in {BUILD.relative_to(REPOSITORY)}")
    return int(any(broken.values()))


if __name__ == "__main__":
    sys.exit(main())
