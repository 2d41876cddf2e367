"""Nothing that users are shown changes unseen; `make_shown.py` beside this file makes what is stored anew."""

import json
import re
from typing import Any

import pytest

pytest.importorskip("ducc0")

from described import differences
from make_shown import SHOWN_FILE, shown

pytestmark = pytest.mark.slow

STORED: dict[str, Any] = json.loads(SHOWN_FILE.read_text())
NUMBER = re.compile(r"[-+]?\d+\.\d+(?:e[-+]?\d+)?")


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return shown(tmp_path_factory.mktemp("shown"))


def test_everything_is_there(found: dict[str, Any]) -> None:
    assert list(found) == list(STORED)


@pytest.mark.parametrize("name", STORED)
def test_what_is_shown_is_as_stored(found: dict[str, Any], name: str) -> None:
    assert differences(_split(found[name]), _split(STORED[name])) == []


def _split(value: Any) -> Any:
    """Lines of text as words and numbers apart, so that numbers may differ in their last digits."""
    if isinstance(value, str):
        numbers = [float(number) for number in NUMBER.findall(value)]
        return [NUMBER.sub("#", re.sub(r"[ ─━]+", " ", value)), numbers] if numbers else value
    if isinstance(value, dict):
        return {name: _split(each) for name, each in value.items()}
    return [_split(each) for each in value] if isinstance(value, list) else value
