"""common.py: files that are whole or as they were, whatever stands at their path."""
import argparse
import os
import threading

import pytest

from tools.common import ToolError, read_text, real_number, whole_number, write_whole


def test_a_new_file_and_its_folders(tmp_path):
    write_whole(tmp_path / "one/two/new.txt", "Δ")
    assert (tmp_path / "one/two/new.txt").read_text(encoding="utf-8") == "Δ"
    assert os.listdir(tmp_path / "one/two") == ["new.txt"]


@pytest.mark.parametrize("target", ["there.txt", "not_yet.txt"])
def test_a_link_stays_and_its_target_is_written(tmp_path, target):
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder/there.txt").write_text("old")
    link = tmp_path / "link"
    link.symlink_to(f"folder/{target}")
    write_whole(link, "new")
    assert link.is_symlink()
    assert (tmp_path / "folder" / target).read_text() == "new"
    assert sorted(os.listdir(tmp_path)) == ["folder", "link"]


def test_a_pipe_stays_and_takes_the_bytes(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    heard = []
    reader = threading.Thread(target=lambda: heard.append(pipe.read_bytes()))
    reader.start()
    write_whole(pipe, b"all")
    reader.join()
    assert heard == [b"all"]
    assert pipe.is_fifo()


def test_a_full_device_is_told_and_stays():
    with pytest.raises(ToolError, match="^/dev/full: No space left on device$"):
        write_whole("/dev/full", "text")


@pytest.mark.parametrize("make", [lambda path: path.mkdir(), lambda path: path.symlink_to(path)], ids=["folder", "loop"])
def test_what_cannot_be_written_is_told_and_stays(tmp_path, make):
    path = tmp_path / "place"
    make(path)
    with pytest.raises(ToolError, match=f"^{path}: "):
        write_whole(path, "text")
    assert os.listdir(tmp_path) == ["place"]
    assert path.is_symlink() or path.is_dir()


@pytest.mark.parametrize("failure", [KeyboardInterrupt, OSError(28, "No space left on device")])
def test_what_breaks_off_leaves_the_old_file_alone(tmp_path, monkeypatch, failure):
    path = tmp_path / "file.txt"
    path.write_text("old")

    def broken(*_):
        raise failure
    monkeypatch.setattr(os, "chmod", broken)
    with pytest.raises((KeyboardInterrupt, ToolError)):
        write_whole(path, "new")
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["file.txt"]


def test_each_writer_has_a_temporary_file_of_its_own(tmp_path, monkeypatch):
    """A second one writes while the first has not renamed its file."""
    path, rename = tmp_path / "file.txt", os.replace

    def second_writer(*names):
        monkeypatch.setattr(os, "replace", rename)
        write_whole(path, "second")
        rename(*names)
    monkeypatch.setattr(os, "replace", second_writer)
    write_whole(path, "first")
    assert path.read_text() == "first"
    assert os.listdir(tmp_path) == ["file.txt"]


@pytest.mark.parametrize("kind, text, value", [
    (whole_number(0, 9), "7", 7), (real_number(0.5, 9), "7.5", 7.5), (real_number(0.5, 9), "0.5", 0.5)])
def test_numbers_of_options(kind, text, value):
    assert kind(text) == value


@pytest.mark.parametrize("kind, name", [(whole_number(1, 9), "a whole number"), (real_number(1, 9), "a number")])
@pytest.mark.parametrize("text", ["", "x", "0", "10", "nan", "inf", "1e400", "9" * 5000])
def test_what_is_no_number_of_an_option(kind, name, text):
    with pytest.raises(argparse.ArgumentTypeError, match=f": must be {name} from 1 to 9$"):
        kind(text)


def test_a_whole_number_has_no_point():
    with pytest.raises(argparse.ArgumentTypeError):
        whole_number(1, 9)("1.5")


def test_a_byte_order_mark_is_no_text(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("\ufeffx_m\n", encoding="utf-8")
    assert read_text(path) == "x_m\n"
