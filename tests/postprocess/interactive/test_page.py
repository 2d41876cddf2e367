"""`run.view()`: the page of a run in a notebook and in a file."""

from html import unescape
from pathlib import Path

from postprocess import open_run
from postprocess.view import view_page


def test_a_run_shows_its_page(mountain_run: Path, tmp_path: Path) -> None:
    run = open_run(mountain_run)
    page = run.view(fields=["thickness"])
    written = view_page(run, tmp_path / "page.html", fields=["thickness"]).read_text(encoding="utf-8")
    assert page.html == written
    assert run.view(fields="thickness").html == written
    assert page.save(tmp_path / "saved.html").read_text(encoding="utf-8") == written
    assert (
        repr(page)
        == f"<Page of {mountain_run.name}, {len(written) / 1e6:.1f} MB; a notebook shows it, and save(path) writes it>"
    )
    framed = page._repr_html_()
    assert framed.startswith('<iframe srcdoc="')
    assert unescape(framed.split('"')[1]) == written


def test_two_runs_beside_each_other(mountain_run: Path) -> None:
    run = open_run(mountain_run)
    assert run.view(run, fields=["thickness"]).html != run.view(fields=["thickness"]).html
