"""What the tools share: errors for people, whole files, aligned tables."""
import os
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

EXIT_BAD_INPUT = 2


class ToolError(Exception):
    """Bad input; the message is one line that names the file or key and the reason."""


def run(main):
    """Run a tool's main(); bad input becomes one line on stderr and exit status 2."""
    try:
        status = main()
    except ToolError as error:
        print(f"{Path(sys.argv[0]).name}: {error}", file=sys.stderr)
        status = EXIT_BAD_INPUT
    sys.exit(status)


def read_text(path):
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ToolError(f"{path}: not a UTF-8 text file") from None


def write_whole(path, content):
    """Write a text or bytes file so that it is either the old one or the whole new one."""
    path = Path(path)
    data = content if isinstance(content, bytes) else content.encode("utf-8")
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except OSError as error:
        if temporary is not None and os.path.exists(temporary):
            os.unlink(temporary)
        raise ToolError(f"{path}: {error.strerror}") from None


def with_block(path, text, mark, block):
    """The text of a Markdown file with the block between <!-- mark --> and <!-- /mark -->."""
    start, end = f"<!-- {mark} -->", f"<!-- /{mark} -->"
    if text.count(start) != 1 or text.count(end) != 1 or text.index(start) > text.index(end):
        raise ToolError(f"{path}: must hold {start} and, after it, {end}, once each")
    before, rest = text.split(start)
    return f"{before}{start}\n{block}\n{end}{rest.split(end)[1]}"


def markdown_table(headings, rows):
    lines = ["| " + " | ".join(headings) + " |", "|" + "--:|" * len(headings)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def shown_path(path):
    """The path as a person would type it: relative to the working directory where that is shorter."""
    relative = os.path.relpath(path)
    return str(path) if relative.startswith("..") else relative


def print_aligned(rows):
    """Print rows of cells; numbers (given as strings) and text align by column: text left, numbers right."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        cells = [_aligned(cell, width) for cell, width in zip(row, widths)]
        print("  ".join(cells).rstrip())


def _aligned(cell, width):
    return cell.rjust(width) if _is_number(cell) else cell.ljust(width)


def _is_number(cell):
    try:
        float(cell)
    except ValueError:
        return False
    return True
