"""What takes long to make is made once for all workers of pytest, each of which has session fixtures of its own."""
import fcntl
import os


def once(tmp_path_factory, name, make):
    """The folder that make(folder) has filled."""
    root = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        root = root.parent
    folder, made = root / name, root / f"{name}.made"
    with (root / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not made.exists():
            folder.mkdir()
            make(folder)
            made.touch()
    return folder
