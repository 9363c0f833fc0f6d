#!/usr/bin/env python3
"""A picture of the page: the planner's scene, with a wall drawn across the way of the robot. picture.py OUTPUT.png"""
import sys

from browser import Browser
from conftest import open_page
from test_page import on_screen


def main():
    browser = Browser()
    open_page(browser)
    browser.resize(1280, 960)
    browser.click("#tab-planner")
    browser.choose("#speed", "10")
    browser.wait("page.scene.view.state === 5")
    cell = browser.ask("page.scene.cell")
    browser.drag(on_screen(browser, 62.5 * cell, 14.5 * cell), on_screen(browser, 62.5 * cell, 26.5 * cell))
    browser.wait("page.scene.view.replans === 1 && page.scene.view.state === 5 && page.scene.view.driven_m > 9", 60)
    browser.click("#pause")
    browser.ask("document.activeElement.blur(), scrollTo(0, 0)")
    browser.shoot(sys.argv[1])
    browser.close()


if __name__ == "__main__":
    main()
