"""The page of a report: findings first, tables last, and nothing wider than it."""

import io
import shutil
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from PIL import Image

from postprocess.reports.study_report import SHARE_COLUMNS
from postprocess.studies.page import at_page_size, table_of, write_page
from postprocess.studies.study_folder import StudyRow


@pytest.fixture
def page(tmp_path: Path) -> Path:
    columns = SHARE_COLUMNS | {"failure": "failure"}
    rows: list[StudyRow] = [
        dict.fromkeys(columns, 0.123456) | {"family": "refined-circle", "scheme": "consistent", "failure": "word " * 40}
    ]
    sections = {"Shares": table_of(rows, columns), "Nothing": table_of([], columns)}
    figures = {"chart": Figure((13.0, 2.0))}
    verdict = {"Which is best": ["This <one>.", "By far."], "Unanswered": []}
    return write_page(tmp_path, "T" * 300, "text", ["trisk"], sections, figures, verdict, {"chart": "What is seen."})


def test_findings_come_first_and_tables_last(page: Path) -> None:
    text = page.read_text()
    parts = [
        "<p>This &lt;one&gt;.</p> <p>By far.</p>",
        "<p>text</p>",
        "<img",
        "<figcaption>What is seen.",
        "<h2>Shares",
    ]
    places = [text.index(part) for part in parts]
    assert places == sorted(places)
    assert "Unanswered" not in text
    assert "<h2>Nothing" not in text


def test_wide_tables_come_in_parts_that_say_what_their_rows_are_of(page: Path) -> None:
    tables = page.read_text().split("<table>")[1:]
    assert len(tables) > 2
    assert all("<th>family</th><th>scheme</th>" in table for table in tables)


def test_nothing_is_wider_than_the_page(page: Path) -> None:
    playwright = pytest.importorskip("playwright.sync_api", reason="a browser is driven by playwright")
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("there is no chromium to look at the page with")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        window = browser.new_page(viewport={"width": 1000, "height": 800})
        window.goto(page.as_uri())
        wide = "[...document.querySelectorAll('table, img, p')].map(each => each.getBoundingClientRect().right)"
        assert window.evaluate("document.scrollingElement.scrollWidth <= innerWidth")
        assert max(window.evaluate(wide)) <= 1000
        browser.close()


def test_pictures_come_in_the_size_of_the_page() -> None:
    picture = io.BytesIO()
    Figure((9.6, 3.0)).savefig(picture, dpi=150)
    assert Image.open(io.BytesIO(at_page_size(picture.getvalue(), 150))).size == (960, 300)
