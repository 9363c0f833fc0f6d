"""The page as it is built, in a browser without a window; and the same C for this machine."""
import ctypes
import os
import sys
from pathlib import Path

import pytest
from browser import Browser

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("JP_BUILD", ROOT / "build"))
INDEX = BUILD / "page/index.html"

# The package as a wheel installs it, not its sources.
sys.path.insert(0, str(BUILD.resolve() / "python/site"))


@pytest.fixture(scope="session")
def browser():
    browser = Browser()
    yield browser
    browser.close()


def open_page(browser):
    browser.errors.clear()
    browser.resize(1280, 900)
    browser.open("about:blank")
    browser.open(INDEX)
    browser.wait("!!window.page && page.time > 0")


@pytest.fixture
def page(browser):
    """Opened anew; no test may leave an error behind."""
    open_page(browser)
    yield browser
    assert browser.errors == []


class Native:
    """The module of the page for this machine, called as the page calls it: numbers with a point are doubles."""

    def __init__(self, path):
        self.library = ctypes.CDLL(str(path))

    def call(self, name, *arguments):
        function = getattr(self.library, name)
        function.restype = ctypes.c_int
        return function(*(ctypes.c_double(value) if isinstance(value, float) else value for value in arguments))

    def text(self, name, *arguments):
        function = getattr(self.library, name)
        function.restype = ctypes.c_char_p
        return function(*arguments).decode()

    def doubles(self, name, count):
        function = getattr(self.library, name)
        function.restype = ctypes.POINTER(ctypes.c_double)
        return function()[:count]

    def bytes_at(self, name):
        function = getattr(self.library, name)
        function.restype = ctypes.c_void_p
        return function()

    def view(self, scene):
        names = self.text(f"{scene}_view_names").split()
        return dict(zip(names, self.doubles(f"{scene}_view", len(names))))


class Wasm:
    """The same in the page."""

    def __init__(self, browser):
        self.browser = browser

    def call(self, name, *arguments):
        return self.browser.ask(f"Number(page.core.exports.{name}({', '.join(map(repr, arguments))}))")

    def doubles(self, name, count):
        return self.browser.ask(f"[...page.core.doubles(page.core.exports.{name}(), {count})]")

    def view(self, scene):
        """Bit by bit: numbers as the 16 digits of their bytes."""
        return self.browser.ask(f"""(() => {{ const view = page.core.view("{scene}"); const cell = new DataView(new ArrayBuffer(8));
            return Object.fromEntries(Object.entries(view).map(([name, value]) => {{ cell.setFloat64(0, value);
                return [name, cell.getBigUint64(0).toString(16).padStart(16, "0")]; }})); }})()""")


@pytest.fixture(scope="module")
def wasm():
    """The module alone: its page stands still."""
    browser = Browser()
    open_page(browser)
    browser.click("#pause")
    yield Wasm(browser)
    browser.close()


@pytest.fixture(scope="session")
def native():
    """The same C for this machine."""
    return Native(BUILD / "page-native/libpage.so")
