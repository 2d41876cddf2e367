"""Some damaged mesh files; `python tests/reliability/mutate_meshes.py 2000` makes as many as one likes."""

import pytest
from mutate_meshes import OF_BYTES, OF_CONTENT, run


@pytest.mark.slow
def test_damaged_meshes_are_refused_or_harmless() -> None:
    count = 12 * len((*OF_CONTENT, *OF_BYTES))
    table = run(count, seed=1)
    outcomes = [(kind, words) for kind, counts in table.items() for words in counts.elements()]
    assert len(outcomes) == count
    assert not [outcome for outcome in outcomes if outcome[1].startswith("WRONG")]
    refused = sum(words.startswith("refused") for _, words in outcomes)
    assert count // 2 < refused < count
