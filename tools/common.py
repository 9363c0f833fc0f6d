"""What the tools share: errors for people, command lines, whole files, aligned tables."""
import argparse
import os
import stat
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

EXIT_MISSED = 1
EXIT_BAD_INPUT = 2


def build_directory():
    return Path(os.environ.get("JP_BUILD", ROOT / "build"))


class ToolError(Exception):
    """Bad input; the message is one line that names the file or key and the reason."""


class Verdict(ToolError):
    """The input is right, but what comes of it misses an accuracy that is promised; the message ends with a remedy."""


def run(main):
    """Run a tool's main(); bad input becomes one line on stderr and exit status 2, a verdict one line and status 1."""
    try:
        status = main()
    except Verdict as verdict:
        print(f"{Path(sys.argv[0]).name}: {verdict}", file=sys.stderr)
        status = EXIT_MISSED
    except ToolError as error:
        print(f"{Path(sys.argv[0]).name}: {error}", file=sys.stderr)
        status = EXIT_BAD_INPUT
    sys.exit(status)


class ArgumentParser(argparse.ArgumentParser):
    """A wrong command line is one line too."""

    def error(self, message):
        raise ToolError(f"{message.removeprefix('argument ')}; --help lists the options")


def whole_number(low, high):
    """What an option takes."""
    return _number(int, "a whole number", low, high)


def real_number(low, high):
    """What an option takes."""
    return _number(float, "a number", low, high)


def _number(kind, name, low, high):
    def number(text):
        try:
            value = kind(text)
        except ValueError:
            value = None
        if value is None or not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text}: must be {name} from {low} to {high}")
        return value
    return number


def read_text(path):
    """Of a UTF-8 file; a byte-order mark is no part of it."""
    try:
        return Path(path).read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ToolError(f"{path}: not a UTF-8 text file") from None


def write_whole(path, content):
    """Write a text or bytes file so that it is either the old one or the whole new one. A symbolic link stays, and what
    it names is written; so does a device or a pipe, which is written to."""
    data = content if isinstance(content, bytes) else content.encode("utf-8")
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if is_regular_or_new(path):
            replace_file(Path(os.path.realpath(path)), data)
        else:
            path.write_bytes(data)
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror}") from None


def is_regular_or_new(path):
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except FileNotFoundError:
        return True


def replace_file(path, data):
    """The temporary file has a name of its own, so that two programs may write the same file."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


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
