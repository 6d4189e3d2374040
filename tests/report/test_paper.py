"""The page on paper: title block, margins, PDF by a browser; the print itself where one is."""

import re
import shutil
import subprocess
import sys
import tomllib
from dataclasses import replace
from html import unescape
from itertools import combinations, pairwise, product
from pathlib import Path

import pytest
import rating_cases as cases
from page_reader import ATTACK, Reader

import gearopt
from gearopt.errors import GearoptError
from gearopt.report.drawing.sheet import Drawing, Row
from gearopt.report.pages import pdf
from gearopt.report.pages.result import page, sections

KEYS = ("company", "customer", "number", "revision", "date", "engineer", "approved", "note")
PAIR = Path("problems/catalogue_pair.toml")
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="the browser is a script of the shell")
PRINTING = pytest.mark.skipif(
    not (any(map(shutil.which, pdf.NAMES)) and shutil.which("pdftotext")),
    reason="needs a browser, and pdftotext of poppler",
)


def headed(**texts):
    result = cases.shigley()
    return replace(result, asked={**result.asked, "report": texts})


def test_the_title_block_has_every_text_of_the_file_and_none_of_its_own():
    texts = {key: f"{key} of mine" for key in KEYS}
    shown = Reader(page(headed(**texts), "")).text
    assert [t for t in shown if t.endswith(" of mine")] == list(texts.values())
    assert not {"Company", "Date"} & set(Reader(page(headed(note="n"), "")).text)
    assert "class=block" not in page(cases.shigley(), "").replace('"', "")


def test_hostile_texts_do_not_run():
    """Neither as tags nor in the style sheet, where header and footer of the sheets stand."""
    attack = ATTACK + "</style>\"'}\\ * {"
    html = page(headed(**dict.fromkeys(KEYS, attack)), "")
    plain = page(cases.shigley(), "")
    read = Reader(html)
    assert read.text.count(attack) == len(KEYS)
    for tag in ("script", "style", "b"):
        assert html.count(f"<{tag}") == plain.count(f"<{tag}")
    style = html.partition("</style>")[0]
    boxes = re.findall(r"@(?:top|bottom)-\w+ \{ content: (.*?) \}", style)
    assert len(boxes) == 4 and boxes[3] == '"Page " counter(page) " of " counter(pages)'
    for box in boxes[:3]:
        assert re.fullmatch(r'"([A-Za-z0-9]|\\[0-9a-f]+ )*"', box)


def test_what_is_not_printed_is_said_with_its_marks():
    """Two factors of pinion and wheel, or of the mesh, in two stages, as the page marks them."""
    html = page(cases.train(), "")
    (said,) = re.findall(r'<p class="on-paper">(.*?)</p>', html)
    marks = len(re.findall(r"<td[^>]*>[\d.]+\nunverified</td>", html))
    assert f"{marks} of the values not printed are marked unverified." in said
    assert "Factors" in said and "appendix = true" in said and "I and J" in said
    assert "<p class=on-paper>" not in page(headed(appendix=True), "").replace('"', "")


def test_the_scale_on_paper_is_a_usual_one():
    """A body of 200 mm is 200/1.5 mm long at 1:1.5; a pixel of CSS is 25.4/96 mm."""
    body = Drawing("", 600.0, 300.0, "", frame=((0.0, 0.0), (200.0, 100.0)))
    row = Row([body], to_scale=True)
    assert row.scale == "1:1.5" and row.printed * 600.0 * 25.4 / 96.0 == pytest.approx(200.0 / 1.5)
    assert Row([body]).scale == ""


def test_an_edited_result_without_a_table_has_no_block():
    result = replace(cases.shigley(), asked={"report": ["no table"]})
    assert "class=block" not in page(result, "").replace('"', "")


def test_every_kind_takes_the_table_and_dates_as_toml_has_them():
    tables = tomllib.loads(PAIR.read_text(encoding="utf-8"))
    dated = {**tables, **tomllib.loads('[report]\ndate = 2026-03-01\nnumber = "7"')}
    result = gearopt.rate(dated)
    assert result.asked["report"] == {"date": "2026-03-01", "number": "7"}
    assert result.design == gearopt.rate(tables).design
    for wrong, instead in (({"author": "x"}, "engineer"), ({"paper": "a4"}, "A4")):
        with pytest.raises(GearoptError, match=instead):
            gearopt.load({**tables, "report": wrong})


@pytest.fixture
def browser(tmp_path, monkeypatch):
    """browser(script): the only one there is, a script of the shell; where its words are kept."""

    def install(script):
        room = tmp_path / "bin"
        room.mkdir()
        program = room / "chromium"
        program.write_text(f'#!/bin/sh\necho "$@" > {tmp_path}/words\n{script}\n', encoding="utf-8")
        program.chmod(0o755)
        monkeypatch.setenv("PATH", str(room))
        return tmp_path / "words"

    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(pdf, "PLACES", ())
    for name in pdf.FOLDERS:
        monkeypatch.delenv(name, raising=False)
    return install


def test_without_a_browser_nothing_begins_and_it_is_said_how_to_print(browser, tmp_path, here):
    target = tmp_path / "r.pdf"
    for verb, file in (("rate", PAIR), ("solve", PAIR), ("pareto", PAIR), ("compare", PAIR)):
        said = here(verb, file, "--pdf", target)
        assert said.returncode == 2 and said.stdout == "" and not target.exists()
        assert len(said.stderr.splitlines()) == 1 and "--html" in said.stderr
    with pytest.raises(GearoptError, match="Chromium, Chrome or Edge"):
        cases.shigley().to_pdf(target)


@POSIX
def test_a_browser_prints_without_a_network_on_the_paper_of_the_units(browser, tmp_path, here):
    words = browser(
        'for w; do case "$w" in --print-to-pdf=*) printf %%PDF-1.4 > "${w#*=}";; '
        f'file://*) /bin/cat "${{w#file://}}" > {tmp_path}/seen;; esac; done'
    )
    target, html = tmp_path / "r.pdf", tmp_path / "r.html"
    for units, paper in (("metric", "A4"), ("inch", "Letter")):
        said = here("rate", PAIR, "--pdf", target, "--html", html, "--units", units)
        assert said.returncode == 0 and said.stderr == "", said.stderr
        assert target.read_bytes() == b"%PDF-1.4"
        assert f"@page {{ size: {paper} }}" in (tmp_path / "seen").read_text(encoding="utf-8")
        assert f"PDF: {target}" in said.stdout and "<h1>" in html.read_text(encoding="utf-8")
        assert {"--headless", "--no-pdf-header-footer"} <= {*words.read_text().split()}
        assert "--host-resolver-rules=MAP * ~NOTFOUND" in words.read_text()
    target.unlink()
    cases.shigley().to_pdf(target)
    assert target.read_bytes() == b"%PDF-1.4"


@POSIX
@pytest.mark.parametrize(("script", "why"), [("exit 7", "code 7"), ("/bin/sleep 5", "within")])
def test_a_browser_that_fails_loses_no_answer(script, why, browser, tmp_path, here, monkeypatch):
    browser(f"exec {script}" if "sleep" in script else script)
    monkeypatch.setattr(pdf, "SECONDS", 0.05)
    said = here("rate", PAIR, "--pdf", tmp_path / "r.pdf")
    assert said.returncode == 2 and why in said.stderr and "safe" in said.stdout
    assert "<h1>" in (tmp_path / "r.html").read_text(encoding="utf-8")
    assert not (tmp_path / "r.pdf").exists()


def test_page_and_pdf_are_two_files_and_spare_problem_files(browser, tmp_path, here):
    for words in (["--html", "a.pdf", "--pdf", "a.pdf"], ["--pdf", "a.toml"], ["--pdf", PAIR]):
        said = here("rate", PAIR, *words)
        assert said.returncode == 2 and "--pdf" in said.stderr and "name a" in said.stderr


def words_of(target):
    """Pages of a PDF, each as its words with their boxes (x, y, x, y) and the width of paper."""
    run = ["pdftotext", "-bbox", target, "-"]
    told = subprocess.run(run, capture_output=True, text=True, check=True).stdout
    word = re.compile(r'<word xMin="(.*?)" yMin="(.*?)" xMax="(.*?)" yMax="(.*?)">(.*?)</word>')
    for width, text in re.findall(r'<page width="(.*?)".*?>(.*?)</page>', told, re.S):
        yield float(width), [(*map(float, hit[:4]), unescape(hit[4])) for hit in word.findall(text)]


def covers(one, other):
    """The part of the smaller word that lies under the other."""
    wide = min(one[2], other[2]) - max(one[0], other[0])
    high = min(one[3], other[3]) - max(one[1], other[1])
    least = min((w[2] - w[0]) * (w[3] - w[1]) for w in (one, other))
    return wide * high / least if min(wide, high, least) > 0.0 else 0.0


def _solved(name):
    """A result with all that a page shows of it."""
    path = Path(f"problems/{name}.toml")
    if name == "two_stages_rated":
        return gearopt.rate(path)
    more = {} if name == "unit_15_kw_pair" else {"top": 10, "prices": 1.0}
    return gearopt.solve(path, **more)


@pytest.mark.slow
@PRINTING
@pytest.mark.parametrize(
    "name",
    [
        *("two_stages_rated", "unit_15_kw", "unit_in_box", "elevator_by_both"),
        *("planetary_gearhead", "pair_from_duty", "unit_15_kw_pair"),
    ],
)
def test_a_report_is_of_three_sheets_at_most(name, tmp_path):
    """All but the appendix is there; no word beyond the margins or under another one."""
    plain = _solved(name)
    for paper, across in (("A4", 595.0), ("Letter", 612.0)):
        head = {"number": "4711", "paper": paper}
        result = replace(plain, asked={**plain.asked, "report": head})
        result.to_pdf(tmp_path / "r.pdf")
        sheets = list(words_of(tmp_path / "r.pdf"))
        assert 1 <= len(sheets) <= 3
        for k, (width, words) in enumerate(sheets, 1):
            assert abs(width - across) < 1.0
            texts = [word[4] for word in words]
            assert "4711" in texts and f"Page {k} of {len(sheets)}" in " ".join(texts)
            assert all(40.0 < word[0] and word[2] < width - 40.0 for word in words)
            twice = [(a, b) for a, b in combinations(words, 2) if covers(a, b) > 0.5]
            alike = ((a[4] in b[4] or b[4] in a[4]) for a, b in twice)
            assert all(alike)  # a halo is the word again, or letters of it
        _check_tables(result, joined(sheets))


def joined(sheets):
    return "".join(word[4] for _, words in sheets for word in words)


@pytest.mark.slow
@PRINTING
def test_the_appendix_is_printed_when_asked(tmp_path):
    plain = _solved("two_stages_rated")
    result = replace(plain, asked={**plain.asked, "report": {"appendix": True}})
    result.to_pdf(tmp_path / "r.pdf")
    printed = joined(words_of(tmp_path / "r.pdf"))
    _check_tables(result, printed, whole=True)
    assert printed.count("unverified") > 6 and "Notprinted" not in printed


@pytest.mark.slow
@PRINTING
@pytest.mark.parametrize("name", ["two_stages_rated", "elevator_by_both"])
def test_the_scale_is_that_of_the_sheet(name, tmp_path):
    """The numbers of shafts stand over their axes, whose distances the design gives."""
    result = _solved(name)
    result.to_pdf(tmp_path / "r.pdf")
    words = next(w for _, w in words_of(tmp_path / "r.pdf") if any(v[4] == "Scale" for v in w))
    (scale,) = [b[4] for a, b in pairwise(words) if a[4] == "Scale"]
    level = [[v for v in words if v[4] == str(k) and v[3] - v[1] < 8.0] for k in (1, 2, 3)]
    middles = [[(0.5 * (v[0] + v[2]), v[1]) for v in each] for each in level]
    a1, a2 = (stage["centre_distance_mm"] for stage in result.design["stages"])
    size = 72.0 / 25.4 / float(scale.removeprefix("1:"))
    rows = product(*middles)
    seen = [(p[0], q[0], r[0]) for p, q, r in rows if max(abs(p[1] - w[1]) for w in (q, r)) < 1.0]
    assert any(abs(q - p - a1 * size) < 0.3 and abs(r - q - a2 * size) < 0.3 for p, q, r in seen)


def _check_tables(result, printed, whole=False):
    """Every head and label of the tables of printed sections is there."""
    for section in sections(result):
        for table in section.tables:
            heads, rows = table.on_page
            left_out = not whole and (section.appendix or table.appendix)
            for text in (
                () if table.folded or left_out else (*heads, *(row[0].text for row in rows))
            ):
                for word in text.split():
                    assert word in printed, (table.name, text)
