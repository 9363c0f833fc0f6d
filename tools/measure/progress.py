"""Long work in parallel, with a bar where somebody looks."""
import contextlib
import multiprocessing

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn


@contextlib.contextmanager
def workers(count):
    """In it, track(function, items, description) gives the results in the items' order as they come."""
    console = Console(stderr=True)
    bar = Progress(TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(),
                   console=console, disable=not console.is_terminal, transient=True)
    with multiprocessing.Pool(count) as pool, bar:
        yield lambda function, items, description: bar.track(pool.imap(function, items), len(items), description=description)
