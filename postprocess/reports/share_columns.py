"""Columns of tables on where an error lives."""

from postprocess.compare.shares import ZONES
from postprocess.reports.sentences import zone_in_words


def share_columns(noun: str) -> dict[str, str]:
    """Columns of shares, see `postprocess.compare.shares`, of what `noun` says, and what stands above them."""
    return {
        f"{kind}_share_{zone}": f"{title}, {zone_in_words(zone)}"
        for zone in ZONES
        for kind, title in (("error", f"squared {noun}"), ("area", "area"))
    }
