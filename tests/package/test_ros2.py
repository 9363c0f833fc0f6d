"""The planner for Nav2: its class natively, and its plugin against stand-ins of the interfaces that it uses."""
import re
import xml.etree.ElementTree as ElementTree

from conftest import PROGRAMS, ROOT, WARNINGS, command

ROS2 = ROOT / "tools/packaging/ros2"
SOURCES = [ROS2 / "src/energy_planner.cpp", ROS2 / "src/nav2_planner.cpp"]


def test_it_plans_forecasts_and_says_why_not(installed, tmp_path):
    command("g++", "-std=c++17", "-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", *WARNINGS,
            "-I", ROS2 / "include", "-isystem", PROGRAMS / "nav2_stand_ins", "-I", installed / "include", *SOURCES,
            PROGRAMS / "energy_planner.cpp", installed / "lib/libjoulepath.a", "-lm", "-o", tmp_path / "test")
    command(tmp_path / "test")


def test_manifest_and_sources_name_the_same(version):
    package = ElementTree.parse(ROS2 / "package.xml").getroot()
    assert package.findtext("version") == version
    depends = {each.text for each in package.findall("depend")}
    plugin = ElementTree.parse(ROS2 / "joulepath_nav2.xml").getroot().find("class")
    source = SOURCES[1].read_text()
    assert f"PLUGINLIB_EXPORT_CLASS({plugin.get('type')}, {plugin.get('base_class_type')})" in source
    includes = "".join(path.read_text() for path in [*SOURCES, *(ROS2 / "include").rglob("*.hpp")])
    used = set(re.findall(r'#include "(\w+)/', includes)) - {"joulepath_nav2"}
    assert used <= depends
    cmake = (ROS2 / "CMakeLists.txt").read_text()
    assert all(re.search(rf"\b{name}\b", cmake) for name in depends)
