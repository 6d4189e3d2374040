"""A page as PDF: a browser of this machine prints it, without a window and without a network."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from gearopt.errors import GearoptError

SECONDS = 60.0  # that a browser may take; plots to rotate take it some five
PATIENCE = 10_000  # ms of the page's own time for its scripts
NAMES = (  # of programs on the PATH
    *("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"),
    *("microsoft-edge", "microsoft-edge-stable", "msedge", "brave-browser"),
)
PLACES = (  # of programs that stand beside the PATH
    "/opt/google/chrome/chrome",
    "/snap/bin/chromium",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Brave Browser.app/Contents/MacOS/Brave Browser",
)
FOLDERS = ("PROGRAMFILES", "PROGRAMFILES(X86)", "LOCALAPPDATA")  # of programs on Windows
WITHIN = ("Google/Chrome/Application/chrome.exe", "Microsoft/Edge/Application/msedge.exe")
BY_HAND = "open the page of --html in any browser and print it there (Ctrl+P, Save as PDF)"
LACKING = (
    "needs Chromium, Chrome or Edge, and none of them is installed here or on the PATH; "
    f"leave --pdf out, {BY_HAND}"
)
QUIET = (
    *("--headless", "--disable-gpu", "--no-first-run", "--no-pdf-header-footer"),
    *("--disable-extensions", "--disable-background-networking", "--disable-sync"),
    "--host-resolver-rules=MAP * ~NOTFOUND",  # no address is looked up
)


def browser() -> str:
    """The browser that prints; GearoptError says what to do without one."""
    if (known := next(_browsers(), None)) is None:
        raise GearoptError(LACKING)
    return known


def _browsers() -> Iterator[str]:
    yield from filter(None, map(shutil.which, NAMES))
    homes = [Path(os.environ[name]) for name in FOLDERS if name in os.environ]
    places = [*map(Path, PLACES), *(home / place for home in homes for place in WITHIN)]
    yield from (str(place) for place in places if place.is_file())


def printed(page: str, paper: str) -> bytes:
    """The PDF of a page on this paper; GearoptError where the browser does not make it."""
    program = browser()
    sized = page.replace("</head>", f"<style>@page {{ size: {paper} }}</style></head>", 1)
    with TemporaryDirectory(prefix="gearopt-", ignore_cleanup_errors=True) as room:
        source, target = Path(room, "page.html"), Path(room, "page.pdf")
        source.write_text(sized, encoding="utf-8")
        words = [program, *QUIET, f"--virtual-time-budget={PATIENCE}"]
        if hasattr(os, "geteuid") and os.geteuid() == 0:  # it refuses to serve root otherwise
            words.append("--no-sandbox")
        words += [f"--user-data-dir={Path(room, 'user')}", f"--print-to-pdf={target}"]
        why = _run([*words, source.as_uri()])
        if not why and target.is_file() and (data := target.read_bytes()).startswith(b"%PDF"):
            return data
    raise GearoptError(f"{program} printed nothing{why}; {BY_HAND}")


def _run(words: list[str]) -> str:
    """Let a browser print; the reason where it does not."""
    try:
        done = subprocess.run(words, capture_output=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return f" within {SECONDS:g} s"
    except OSError as refused:
        return f" ({refused.strerror})"
    return f" (it ended with code {done.returncode})" if done.returncode else ""
