"""tests/SAFETY.md: every test, command and file that it names exists."""
import re
import subprocess

import pytest
from conftest import ROOT

PAGE = (ROOT / "tests/SAFETY.md").read_text(encoding="utf-8")
NAMES = sorted(set(re.findall(r"`(tests/[\w./]+(?:::\w+)?)`", PAGE)))
COMMANDS = sorted(set(re.findall(r"(?:^|`)make ([a-z-]+(?: [a-z-]+)*)", PAGE, re.M)))
LINKS = sorted(set(re.findall(r"\]\(([^)#]+)\)", PAGE)))


def test_the_page_names_evidence():
    assert len(NAMES) > 20 and len(COMMANDS) > 8 and len(LINKS) > 5


@pytest.mark.parametrize("name", NAMES)
def test_a_named_test_exists(name):
    path, _, function = name.partition("::")
    assert (ROOT / path).exists()
    assert not function or re.search(rf"^static void {function}\(void\)", (ROOT / path).read_text(encoding="utf-8"), re.M)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_named_command_exists(command):
    listed = subprocess.run(["make", "help"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    targets = {line.split()[0] for line in listed.splitlines() if line.strip()}
    assert set(command.split()) <= targets


@pytest.mark.parametrize("suite", sorted(set(re.findall(r"SUITE=\"?([a-z ]+)", PAGE))))
def test_a_named_suite_exists(suite):
    suites = re.search(r"^SUITES\s*:= (.*)$", (ROOT / "tools/make/test.mk").read_text(encoding="utf-8"), re.M)[1].split()
    assert set(suite.split()) <= set(suites)


@pytest.mark.parametrize("link", LINKS)
def test_a_link_leads_somewhere(link):
    assert (ROOT / "tests" / link).exists()
